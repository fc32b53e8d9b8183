"""Fruit, balls, blocks, phone and box: things without parts other than their body or edges."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

from kb.percept import Part
from kb.vocabulary import Region
from sim.objects.form import Colour, Form, Point, box, capsule, sphere

UP = (0.0, 0.0, 1.0)
X = (1.0, 0.0, 0.0)
Y = (0.0, 1.0, 0.0)


def apple(scale: float, colour: Callable[[], Colour]) -> Form:
    """The apple of Table I: 8 cm across."""
    return _ball(0.040 * scale, colour())


def tennis_ball(scale: float, colour: Callable[[], Colour]) -> Form:
    """The tennis ball of Table I: 6.5 cm across."""
    return _ball(0.0325 * scale, colour())


def _ball(radius: float, rgba: Colour) -> Form:
    part = Part(region="body", centre=(0.0, 0.0, radius), axis=UP, width=2 * radius, length=2 * radius, radius=radius)
    return Form((sphere((0.0, 0.0, radius), radius, rgba),), (part,), (2 * radius, 2 * radius, 2 * radius))


def banana(scale: float, colour: Callable[[], Colour]) -> Form:
    """The banana of Table I: 18 cm long and 4 cm thick, lying, bent in the table's plane (ledger G37)."""
    s, rgba = scale, colour()
    bend, half = 0.118 * s, math.radians(40.0)
    angles = [half * (2 * k / 6 - 1) for k in range(7)]
    thick = [0.012, 0.017, 0.0195, 0.02, 0.0195, 0.017, 0.012]
    back = bend * (1 + math.cos(half)) / 2
    points: list[Point] = [
        (bend * math.sin(a), bend * math.cos(a) - back, r * s) for a, r in zip(angles, thick, strict=True)
    ]
    radii = [min(a, b) * s + 0.0005 * s for a, b in pairwise(thick)]
    geoms = tuple(capsule((*a[:2], r), (*b[:2], r), r, rgba) for (a, b), r in zip(pairwise(points), radii, strict=True))
    part = Part(
        region="body", centre=(0.0, bend - back, 0.02 * s), axis=X, width=0.04 * s, length=0.18 * s, radius=0.02 * s
    )
    wide = bend * (1 - math.cos(half)) + 0.0205 * s + 0.0125 * s
    return Form(geoms, (part,), (2 * (bend * math.sin(half) + 0.0125 * s), wide, 0.04 * s))


def wood_cube(scale: float, colour: Callable[[], Colour]) -> Form:
    """The wood cube of Table I: 5 cm."""
    side = 0.05 * scale
    return _block((side, side, side), colour())


def toy_block(scale: float, colour: Callable[[], Colour]) -> Form:
    """The toy block of Table I: 4 cm."""
    side = 0.04 * scale
    return _block((side, side, side), colour())


def carton(scale: float, colour: Callable[[], Colour]) -> Form:
    """The occluding box of task IT-b: 12 x 10 x 12 cm (ledger G51)."""
    return _block((0.12 * scale, 0.10 * scale, 0.12 * scale), colour())


def smartphone(scale: float, colour: Callable[[], Colour]) -> Form:
    """The smartphone of Table I, lying: 7 wide, 15 long, 1 high (ledger G37)."""
    return _block((0.07 * scale, 0.15 * scale, 0.01 * scale), colour(), "edge")


def _block(size: Point, rgba: Colour, region: Region = "body") -> Form:
    """One box; its narrower horizontal extent is what the fingers span."""
    half = (size[0] / 2, size[1] / 2, size[2] / 2)
    part = Part(
        region=region,
        centre=(0.0, 0.0, half[2]),
        axis=X if size[0] >= size[1] else Y,
        width=min(size[0], size[1]),
        length=max(size[0], size[1]),
    )
    return Form((box((0.0, 0.0, half[2]), half, rgba, region),), (part,), size)
