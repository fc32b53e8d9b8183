"""Shapes outside the catalogue, made of primitives: what perception must call unknown."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from kb.percept import Part
from sim.objects.form import Colour, Form, Point, box, cylinder, frustum, prism, wall
from sim.placed import Geom

UP = (0.0, 0.0, 1.0)


def _form(geoms: list[Geom], size: Point, width: float) -> Form:
    part = Part(region="body", centre=(0.0, 0.0, size[2] / 2), axis=UP, width=width, length=size[2], radius=None)
    return Form(tuple(geoms), (part,), size)


def many_sided(rng: np.random.Generator, rgba: Colour) -> Form:
    """An upright prism with three, five or six sides."""
    sides = int(rng.choice([3, 5, 6]))
    radius, height = float(rng.uniform(0.025, 0.04)), float(rng.uniform(0.03, 0.12))
    angles = np.arange(sides) * (2 * math.pi / sides)
    corners = radius * np.column_stack([np.cos(angles), np.sin(angles)])
    extent = np.ptp(corners, axis=0)
    corners -= (corners.max(0) + corners.min(0)) / 2
    return _form([prism(corners, 0.0, height, rgba)], (float(extent[0]), float(extent[1]), height), float(extent.min()))


def l_shape(rng: np.random.Generator, rgba: Colour) -> Form:
    """An angle: an upright plate on a lying one."""
    wide, deep, high = (float(rng.uniform(*limits)) for limits in ((0.06, 0.10), (0.03, 0.05), (0.05, 0.09)))
    thick = float(rng.uniform(0.015, 0.025))
    foot = box((0.0, 0.0, thick / 2), (wide / 2, deep / 2, thick / 2), rgba)
    back = box((-wide / 2 + thick / 2, 0.0, (high + thick) / 2), (thick / 2, deep / 2, (high - thick) / 2), rgba)
    return _form([foot, back], (wide, deep, high), thick)


def cone(rng: np.random.Generator, rgba: Colour) -> Form:
    """A blunt cone."""
    radius, height = float(rng.uniform(0.03, 0.045)), float(rng.uniform(0.06, 0.13))
    return _form([frustum((radius, 0.0), (0.2 * radius, height), rgba)], (2 * radius, 2 * radius, height), radius)


def ring(rng: np.random.Generator, rgba: Colour) -> Form:
    """A lying ring with a square cross-section."""
    outer, bar = float(rng.uniform(0.04, 0.06)), float(rng.uniform(0.012, 0.02))
    high = float(rng.uniform(0.015, 0.03))
    middle = outer - bar / 2
    return _form(wall((middle, 0.0), (middle, high), bar, 16, rgba), (2 * outer, 2 * outer, high), bar)


def cross(rng: np.random.Generator, rgba: Colour) -> Form:
    """Two bars lying across each other."""
    long, wide, high = (float(rng.uniform(*limits)) for limits in ((0.09, 0.14), (0.018, 0.03), (0.02, 0.04)))
    bars = [
        box((0.0, 0.0, high / 2), (long / 2, wide / 2, high / 2), rgba),
        box((0.0, 0.0, high / 2), (wide / 2, long / 2, high / 2), rgba),
    ]
    return _form(bars, (long, long, high), wide)


def lid(rng: np.random.Generator, rgba: Colour) -> Form:
    """A flat lid with a knob."""
    radius, thick, knob = float(rng.uniform(0.045, 0.065)), float(rng.uniform(0.008, 0.014)), 0.012
    height = thick + float(rng.uniform(0.02, 0.03))
    geoms = [cylinder(radius, 0.0, thick, rgba), cylinder(knob, thick, height, rgba)]
    return _form(geoms, (2 * radius, 2 * radius, height), 2 * knob)


def stairs(rng: np.random.Generator, rgba: Colour) -> Form:
    """Two steps."""
    wide, deep, high = (float(rng.uniform(*limits)) for limits in ((0.06, 0.09), (0.04, 0.06), (0.05, 0.08)))
    low = box((0.0, 0.0, high / 4), (wide / 2, deep / 2, high / 4), rgba)
    upper = box((-wide / 4, 0.0, 0.75 * high), (wide / 4, deep / 2, high / 4), rgba)
    return _form([low, upper], (wide, deep, high), deep)


STRANGE: dict[str, Callable[[np.random.Generator, Colour], Form]] = {
    "prism": many_sided,
    "l_shape": l_shape,
    "cone": cone,
    "ring": ring,
    "cross": cross,
    "lid": lid,
    "stairs": stairs,
}
"""By name."""
FLAT_TOPPED = ("prism", "cross", "ring")
"""Those on which something can stand."""
