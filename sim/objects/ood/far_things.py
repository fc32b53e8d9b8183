"""Tools and other things of categories that neither the knowledge base nor the benchmark has."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

from kb.percept import Part
from sim.footprint import rotation
from sim.objects.form import (
    Colour,
    Form,
    Point,
    box,
    capsule,
    cylinder,
    denser,
    frustum,
    quaternion_about,
    sphere,
)
from sim.objects.ood.parts import UP, X
from sim.objects.tools import STEEL, _bar  # pyright: ignore[reportPrivateUsage]
from sim.placed import Geom

Colours = Callable[[], Colour]
METAL = (0.72, 0.72, 0.70, 1.0)
BRISTLES = (0.10, 0.09, 0.09, 1.0)
KEYS = (0.62, 0.63, 0.65, 1.0)
PAGES = (0.93, 0.91, 0.84, 1.0)
SPRING = (0.66, 0.67, 0.70, 1.0)
EYES = (0.05, 0.05, 0.05, 1.0)


def egg(scale: float, colour: Colours) -> Form:
    """An egg on its side: 5.8 cm long, 4.4 cm thick."""
    half, radius = 0.029 * scale, 0.022 * scale
    shell = Geom("ellipsoid", (half, radius, radius), (0.0, 0.0, radius), rgba=colour(), mass=1.0, region="body")
    part = Part(region="body", centre=(0.0, 0.0, radius), axis=X, width=2 * radius, length=2 * half)
    return Form((shell,), (part,), (2 * half, 2 * radius, 2 * radius))


def light_bulb(scale: float, colour: Colours) -> Form:
    """A light bulb of 6 x 11 cm that lies on its globe and on the end of its metal base of 2.7 cm."""
    s, rgba = scale, colour()
    globe, base, reach = 0.030 * s, 0.0135 * s, 0.0785 * s
    # The axis sinks from the globe's centre to the base's end so far that both touch the table.
    lean = math.asin(globe / math.hypot(reach, base)) - math.atan2(base, reach)
    turn = quaternion_about("y", math.pi / 2 + lean)
    axis = rotation(turn)[:, 2].tolist()
    start: Point = (-0.025 * s, 0.0, globe)
    middle = reach - 0.013 * s
    neck: Point = (start[0] + middle * axis[0], 0.0, start[2] + middle * axis[2])
    throat = frustum((0.026 * s, 0.014 * s), (0.0145 * s, 0.053 * s), rgba)
    screw = cylinder(base, -0.013 * s, 0.013 * s, METAL, "neck")
    geoms = (
        sphere(start, globe, rgba),
        replace(throat, position=start, quaternion=turn),
        denser(replace(screw, position=neck, quaternion=turn), 3.0),
    )
    parts = (
        Part(region="neck", centre=neck, axis=(axis[0], 0.0, axis[2]), width=2 * base, length=0.026 * s),
        Part(region="body", centre=start, axis=UP, width=2 * globe, length=2 * globe, radius=globe),
    )
    return Form(geoms, parts, (0.11 * s, 0.06 * s, 0.06 * s))


def hammer(scale: float, colour: Colours) -> Form:
    """A hammer, lying: 30 cm long, a steel head of 11 x 3 cm, a wooden handle 3 cm wide."""
    s = scale
    handle = box((-0.0125 * s, 0.0, 0.015 * s), (0.1375 * s, 0.015 * s, 0.011 * s), colour(), "handle")
    head = box((0.1375 * s, 0.0, 0.015 * s), (0.0125 * s, 0.055 * s, 0.015 * s), STEEL)
    parts = (
        Part(region="handle", centre=(-0.02 * s, 0.0, 0.015 * s), axis=X, width=0.030 * s, length=0.24 * s),
        Part(
            region="body", centre=(0.1375 * s, 0.0, 0.015 * s), axis=(0.0, 1.0, 0.0), width=0.025 * s, length=0.11 * s
        ),
    )
    return Form((handle, denser(head, 4.0)), parts, (0.30 * s, 0.11 * s, 0.03 * s))


def kitchen_knife(scale: float, colour: Colours) -> Form:
    """A kitchen knife, lying flat: 30 cm long, a blade 3 cm wide, a handle of 2.2 x 1.8 cm."""
    s = scale
    handle = box((-0.090 * s, 0.0, 0.009 * s), (0.060 * s, 0.011 * s, 0.009 * s), colour(), "handle")
    blade = box((0.055 * s, 0.004 * s, 0.0015 * s), (0.085 * s, 0.011 * s, 0.0015 * s), STEEL)
    tip = box((0.145 * s, 0.004 * s, 0.0015 * s), (0.005 * s, 0.005 * s, 0.0015 * s), STEEL)
    heel = box((-0.028 * s, 0.0, 0.005 * s), (0.006 * s, 0.015 * s, 0.005 * s), STEEL)
    parts = (
        Part(region="handle", centre=(-0.09 * s, 0.0, 0.009 * s), axis=X, width=0.022 * s, length=0.12 * s),
        Part(region="body", centre=(0.06 * s, 0.0, 0.0015 * s), axis=X, width=0.03 * s, length=0.18 * s),
    )
    geoms = (handle, denser(blade, 4.0), denser(tip, 4.0), denser(heel, 4.0))
    return Form(geoms, parts, (0.30 * s, 0.03 * s, 0.018 * s))


def hairbrush(scale: float, colour: Colours) -> Form:
    """A hairbrush on its back: 22 cm long, a head of 7 cm with bristles up to 4 cm, a handle of 2 cm."""
    s, rgba = scale, colour()
    handle = _bar(-0.11 * s, 0.012 * s, 0.020 * s, rgba, "handle")
    head = box((0.061 * s, 0.0, 0.008 * s), (0.049 * s, 0.035 * s, 0.008 * s), rgba)
    bristles = denser(box((0.061 * s, 0.0, 0.028 * s), (0.043 * s, 0.027 * s, 0.012 * s), BRISTLES), 0.2)
    parts = (
        Part(region="handle", centre=(-0.05 * s, 0.0, 0.010 * s), axis=X, width=0.020 * s, length=0.12 * s),
        Part(region="body", centre=(0.061 * s, 0.0, 0.02 * s), axis=X, width=0.07 * s, length=0.098 * s),
    )
    return Form((*handle, head, bristles), parts, (0.22 * s, 0.07 * s, 0.04 * s))


def tv_remote(scale: float, colour: Colours) -> Form:
    """A remote control, lying: 17 x 4.5 x 2 cm, grey keys on top."""
    s, rgba = scale, colour()
    geoms = (
        box((0.0, 0.0, 0.009 * s), (0.085 * s, 0.0225 * s, 0.009 * s), rgba, "edge"),
        box((0.02 * s, 0.0, 0.019 * s), (0.045 * s, 0.014 * s, 0.001 * s), KEYS),
    )
    part = Part(region="edge", centre=(0.0, 0.0, 0.01 * s), axis=X, width=0.045 * s, length=0.17 * s)
    return Form(geoms, (part,), (0.17 * s, 0.045 * s, 0.02 * s))


def paperback(scale: float, colour: Colours) -> Form:
    """A paperback that stands upright: 11 cm deep, 2.5 cm thick, 18 cm high; pages between the covers."""
    s, cover = scale, colour()
    sheet = 0.002 * s
    sides = [
        box((0.0, side * (0.0125 * s - sheet / 2), 0.09 * s), (0.055 * s, sheet / 2, 0.09 * s), cover, "edge")
        for side in (1.0, -1.0)
    ]
    spine = box((-0.055 * s + sheet / 2, 0.0, 0.09 * s), (sheet / 2, 0.0105 * s, 0.09 * s), cover, "edge")
    pages = box((0.0005 * s, 0.0, 0.0895 * s), (0.0525 * s, 0.0105 * s, 0.0885 * s), PAGES, "edge")
    part = Part(region="edge", centre=(0.0, 0.0, 0.09 * s), axis=X, width=0.025 * s, length=0.11 * s)
    return Form((*sides, spine, pages), (part,), (0.11 * s, 0.025 * s, 0.18 * s))


def clothes_peg(scale: float, colour: Colours) -> Form:
    """A clothes peg on its edge: 7 cm long, 1 cm wide, 1.2 cm high, a wire spring round its middle."""
    s, rgba = scale, colour()
    geoms = (
        box((0.0, 0.0, 0.006 * s), (0.035 * s, 0.0045 * s, 0.006 * s), rgba),
        box((-0.006 * s, 0.0, 0.006 * s), (0.004 * s, 0.005 * s, 0.004 * s), SPRING),
    )
    part = Part(region="body", centre=(0.0, 0.0, 0.006 * s), axis=X, width=0.010 * s, length=0.07 * s)
    return Form(geoms, (part,), (0.07 * s, 0.01 * s, 0.012 * s))


def plush_toy(scale: float, colour: Colours) -> Form:
    """A plush animal that sits: 7 x 6 x 9 cm, a round body, a head with ears."""
    s, rgba = scale, colour()
    body = Geom("ellipsoid", (0.030 * s, 0.028 * s, 0.030 * s), (-0.005 * s, 0.0, 0.030 * s), rgba=rgba, mass=1.05e-4)
    head = Geom("ellipsoid", (0.022 * s, 0.024 * s, 0.020 * s), (0.0, 0.0, 0.066 * s), rgba=rgba, mass=4.4e-5)
    feet = [
        capsule((0.010 * s, side * 0.018 * s, 0.011 * s), (0.024 * s, side * 0.019 * s, 0.011 * s), 0.011 * s, rgba)
        for side in (1.0, -1.0)
    ]
    ears = [sphere((0.0, side * 0.018 * s, 0.082 * s), 0.008 * s, rgba) for side in (1.0, -1.0)]
    nose = sphere((0.0215 * s, 0.0, 0.064 * s), 0.004 * s, EYES)
    seat = cylinder(0.018 * s, 0.0, 0.004 * s, rgba)
    geoms = tuple(replace(geom, region="body") for geom in (body, head, *feet, *ears, nose, seat))
    part = Part(region="body", centre=(-0.005 * s, 0.0, 0.03 * s), axis=UP, width=0.056 * s, length=0.06 * s)
    return Form(geoms, (part,), (0.07 * s, 0.06 * s, 0.09 * s))
