"""New instances of known categories (near out of distribution, benchmark.md section 6)."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np

from kb.percept import Part
from sim.objects.form import Colour, Form, Point, box, capsule, cylinder, denser, frustum, lying_cylinder, prism, wall
from sim.objects.ood.parts import UP, X, loop_handle, narrow, oval, rim, round_body
from sim.objects.solids import _ball, _block  # pyright: ignore[reportPrivateUsage]
from sim.objects.tools import STEEL, _bar  # pyright: ignore[reportPrivateUsage]
from sim.placed import Cavity, Geom

Colours = Callable[[], Colour]
STICKERS: tuple[Colour, ...] = (
    (0.90, 0.90, 0.88, 1.0),
    (0.75, 0.10, 0.12, 1.0),
    (0.92, 0.80, 0.12, 1.0),
    (0.10, 0.30, 0.70, 1.0),
    (0.10, 0.55, 0.25, 1.0),
)
"""Colours of the puzzle cube's other faces."""
FOOT = 0.003
"""Walls of mugs start this far above the table: they stand on their floor [m]."""


def latte_mug(scale: float, colour: Colours) -> Form:
    """A tall latte mug, 8.5 x 8.5 x 12 cm without its long loop."""
    return _mug(scale, colour(), radius=0.0425, height=0.12, sheet=0.005, tall=0.078, thick=0.013)


def enamel_mug(scale: float, colour: Colours) -> Form:
    """An enamel mug of sheet metal, 8 x 8 x 8 cm without its flat loop."""
    return _mug(scale, colour(), radius=0.04, height=0.08, sheet=0.002, tall=0.052, thick=0.015)


def _mug(s: float, rgba: Colour, *, radius: float, height: float, sheet: float, tall: float, thick: float) -> Form:
    middle = radius * s - sheet / 2
    geoms = [cylinder(radius * s - 0.6 * sheet, 0.0, 0.006, rgba)]
    geoms += wall((middle, FOOT), (middle, height * s), sheet, 16, rgba)
    reach = 0.026 * s
    loop, handle = loop_handle(middle, radius * s + reach, 0.52 * height * s, tall * s, thick * s, 0.009 * s, rgba)
    parts = (handle, rim(middle, height * s, sheet, height * s), round_body(radius * s, 0.0, height * s))
    inside = radius * s - sheet
    cavity = Cavity(floor=0.006, top=height * s, radius_floor=inside, radius_top=inside)
    return Form((*geoms, *loop), parts, (2 * radius * s + reach, 2 * radius * s, height * s), cavity)


def small_apple(scale: float, colour: Colours) -> Form:
    """A small apple, 6.6 cm across."""
    return _ball(0.033 * scale, colour())


def pet_bottle(scale: float, colour: Colours) -> Form:
    """A slim PET bottle, 6 x 6 x 20 cm, with a coloured cap and no waist."""
    s, rgba, cap = scale, colour(), colour()
    geoms = (
        cylinder(0.030 * s, 0.0, 0.135 * s, rgba),
        frustum((0.030 * s, 0.135 * s), (0.0125 * s, 0.172 * s), rgba),
        cylinder(0.0125 * s, 0.170 * s, 0.184 * s, rgba, "neck"),
        cylinder(0.0145 * s, 0.184 * s, 0.200 * s, (*cap[:3], 1.0), "neck"),
    )
    parts = (round_body(0.030 * s, 0.0, 0.135 * s), narrow("neck", 0.0145 * s, 0.172 * s, 0.2 * s))
    return Form(geoms, parts, (0.06 * s, 0.06 * s, 0.20 * s))


def shampoo_bottle(scale: float, colour: Colours) -> Form:
    """An oval shampoo bottle, 8.6 x 4.5 x 19 cm."""
    s, rgba, cap = scale, colour(), colour()
    geoms = (
        prism(oval(0.086 * s, 0.045 * s), 0.0, 0.150 * s, rgba),
        frustum((0.0215 * s, 0.150 * s), (0.014 * s, 0.165 * s), rgba),
        cylinder(0.015 * s, 0.164 * s, 0.190 * s, (*cap[:3], 1.0), "neck"),
    )
    body = Part(region="body", centre=(0.0, 0.0, 0.075 * s), axis=UP, width=0.045 * s, length=0.15 * s)
    return Form(geoms, (body, narrow("neck", 0.015 * s, 0.164 * s, 0.19 * s)), (0.086 * s, 0.045 * s, 0.19 * s))


def baby_banana(scale: float, colour: Colours) -> Form:
    """A baby banana: 13 cm long, 3.2 cm thick, hardly bent, lying."""
    s, rgba = scale, colour()
    bend, half = 0.300 * s, math.asin(0.0545 / 0.300)
    angles = [half * (2 * k / 4 - 1) for k in range(5)]
    thick = [0.010, 0.0155, 0.0155, 0.0155, 0.010]
    back = bend * (1 + math.cos(half)) / 2
    points: list[Point] = [
        (bend * math.sin(a), bend * math.cos(a) - back, r * s) for a, r in zip(angles, thick, strict=True)
    ]
    radii = [min(a, b) * s + 0.0005 * s for a, b in pairwise(thick)]
    geoms = tuple(capsule((*a[:2], r), (*b[:2], r), r, rgba) for (a, b), r in zip(pairwise(points), radii, strict=True))
    part = Part(
        region="body", centre=(0.0, bend - back, 0.016 * s), axis=X, width=0.032 * s, length=0.13 * s, radius=0.016 * s
    )
    wide = bend * (1 - math.cos(half)) + 0.016 * s + 0.0105 * s
    return Form(geoms, (part,), (2 * (bend * math.sin(half) + 0.0105 * s), wide, 0.032 * s))


def salad_bowl(scale: float, colour: Colours) -> Form:
    """A wooden salad bowl: 15 cm across, 7 cm high, a rim of 6 mm."""
    return _bowl(scale, colour(), foot=0.042, radius=0.075, height=0.070, sheet=0.006)


def rice_bowl(scale: float, colour: Colours) -> Form:
    """A porcelain rice bowl: 11 cm across, 5.5 cm high, a rim of 3 mm."""
    return _bowl(scale, colour(), foot=0.026, radius=0.055, height=0.055, sheet=0.003)


def _bowl(s: float, rgba: Colour, *, foot: float, radius: float, height: float, sheet: float) -> Form:
    edge, belly = radius * s - sheet / 2, (0.45 * foot + 0.55 * radius) * s
    low, knee, top = 0.007 * s, 0.45 * height * s, height * s
    geoms = [cylinder(foot * s, 0.0, low, rgba)]
    geoms += wall((foot * s, low - 0.001), (belly, knee), sheet, 18, rgba)
    geoms += wall((belly, knee - 0.001), (edge, top), sheet, 18, rgba, "rim")
    cavity = Cavity(floor=low + 0.002, top=top, radius_floor=0.9 * foot * s, radius_top=edge - sheet / 2)
    parts = (rim(edge, top, sheet, top - knee), round_body(radius * s, 0.0, top))
    return Form(tuple(geoms), parts, (2 * radius * s, 2 * radius * s, top), cavity)


def puzzle_cube(scale: float, colour: Colours) -> Form:
    """A puzzle cube of 5.7 cm: each face has another colour."""
    h, faces = 0.0285 * scale, iter((colour(), *STICKERS))
    middle = np.array([0.0, 0.0, h])
    geoms: list[Geom] = []
    for axis in range(3):
        for side in (-1.0, 1.0):
            corners = np.array([[i, j] for i in (-h, h) for j in (-h, h)])
            face = np.insert(corners, axis, side * h, axis=1)
            vertices = np.vstack([face, np.zeros((1, 3))]) + middle
            geoms.append(Geom("mesh", vertices=vertices, rgba=next(faces), mass=8 * h**3 / 6, region="body"))
    part = Part(region="body", centre=(0.0, 0.0, h), axis=X, width=2 * h, length=2 * h)
    return Form(tuple(geoms), (part,), (2 * h, 2 * h, 2 * h))


def duplo_brick(scale: float, colour: Colours) -> Form:
    """A building brick with eight studs: 6.4 x 3.2 x 2.4 cm."""
    s, rgba = scale, colour()
    geoms = [box((0.0, 0.0, 0.00975 * s), (0.032 * s, 0.016 * s, 0.00975 * s), rgba)]
    for k in range(4):
        for side in (-1.0, 1.0):
            stud = cylinder(0.0047 * s, 0.0195 * s, 0.024 * s, rgba)
            place = ((-0.024 + 0.016 * k) * s, side * 0.008 * s, stud.position[2])
            geoms.append(Geom("cylinder", stud.size, place, rgba=rgba, mass=stud.mass, region="body"))
    part = Part(region="body", centre=(0.0, 0.0, 0.012 * s), axis=X, width=0.032 * s, length=0.064 * s)
    return Form(tuple(geoms), (part,), (0.064 * s, 0.032 * s, 0.024 * s))


def bud_vase(scale: float, colour: Colours) -> Form:
    """A bud vase of glass: 6 x 6 x 18 cm, a drop with a long neck of 3.5 cm."""
    s, rgba = scale, colour()
    geoms = (
        frustum((0.024 * s, 0.0), (0.030 * s, 0.025 * s), rgba),
        cylinder(0.030 * s, 0.024 * s, 0.060 * s, rgba),
        frustum((0.030 * s, 0.060 * s), (0.0175 * s, 0.095 * s), rgba),
        cylinder(0.0175 * s, 0.094 * s, 0.170 * s, rgba, "neck"),
        frustum((0.0175 * s, 0.170 * s), (0.021 * s, 0.180 * s), rgba, "rim"),
    )
    parts = (narrow("neck", 0.0175 * s, 0.095 * s, 0.17 * s), round_body(0.03 * s, 0.0, 0.06 * s))
    return Form(geoms, parts, (0.06 * s, 0.06 * s, 0.18 * s))


def champagne_flute(scale: float, colour: Colours) -> Form:
    """A champagne flute: 5 x 5 x 23 cm, a stem of 1 cm, a narrow open bowl."""
    s, rgba, sheet = scale, colour(), 0.003
    geoms = [cylinder(0.025 * s, 0.0, 0.004 * s, rgba), cylinder(0.005 * s, 0.004 * s, 0.096 * s, rgba, "stem")]
    geoms += [cylinder(0.012 * s, 0.094 * s, 0.102 * s, rgba)]
    geoms += wall((0.013 * s, 0.100 * s), (0.0235 * s, 0.150 * s), sheet, 12, rgba)
    geoms += wall((0.0235 * s, 0.148 * s), (0.022 * s, 0.230 * s), sheet, 12, rgba, "rim")
    parts = (
        narrow("stem", 0.005 * s, 0.004 * s, 0.094 * s),
        rim(0.022 * s, 0.23 * s, sheet, 0.08 * s),
        round_body(0.025 * s, 0.1 * s, 0.23 * s),
    )
    cavity = Cavity(floor=0.103 * s, top=0.23 * s, radius_floor=0.011 * s, radius_top=0.02 * s)
    return Form(tuple(geoms), parts, (0.05 * s, 0.05 * s, 0.23 * s), cavity)


def stubby_screwdriver(scale: float, colour: Colours) -> Form:
    """A stubby screwdriver: 11 cm long, a handle of 3.4 cm."""
    s = scale
    handle = _bar(-0.055 * s, 0.015 * s, 0.034 * s, colour(), "handle")
    shaft = denser(lying_cylinder(0.015 * s, 0.055 * s, 0.0035 * s, 0.017 * s, STEEL, "body"), 6.0)
    parts = (
        Part(region="handle", centre=(-0.020 * s, 0.0, 0.017 * s), axis=X, width=0.034 * s, length=0.07 * s),
        Part(region="body", centre=(0.035 * s, 0.0, 0.017 * s), axis=X, width=0.007 * s, length=0.04 * s),
    )
    return Form((*handle, shaft), parts, (0.11 * s, 0.034 * s, 0.034 * s))


def compact_phone(scale: float, colour: Colours) -> Form:
    """A compact phone, lying: 6.4 wide, 13 long, 0.8 high [cm]."""
    return _block((0.064 * scale, 0.13 * scale, 0.008 * scale), colour(), "edge")


def foam_ball(scale: float, colour: Colours) -> Form:
    """A foam ball of 7 cm."""
    return _ball(0.035 * scale, colour())
