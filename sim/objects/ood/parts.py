"""Parts that several of the new objects have: a round body, a loop handle."""

from __future__ import annotations

import math

import numpy as np

from kb.percept import Part
from sim.objects.form import Colour, box
from sim.placed import Geom

UP = (0.0, 0.0, 1.0)
X = (1.0, 0.0, 0.0)


def round_body(radius: float, low: float, high: float) -> Part:
    """The body between two heights of a thing of revolution."""
    return Part(
        region="body",
        centre=(0.0, 0.0, (low + high) / 2),
        axis=UP,
        width=2 * radius,
        length=high - low,
        radius=radius,
    )


def rim(radius: float, height: float, wall: float, depth: float) -> Part:
    """The edge of a vessel whose wall has its middle at `radius`."""
    return Part(region="rim", centre=(0.0, 0.0, height), axis=UP, width=wall, length=depth, radius=radius)


def narrow(region: str, radius: float, low: float, high: float) -> Part:
    """A neck or a stem between two heights."""
    return Part(
        region="stem" if region == "stem" else "neck",
        centre=(0.0, 0.0, (low + high) / 2),
        axis=UP,
        width=2 * radius,
        length=high - low,
        radius=radius,
    )


def loop_handle(
    inner: float, outer: float, middle: float, tall: float, thick: float, bar: float, rgba: Colour
) -> tuple[list[Geom], Part]:
    """A loop towards +x: an upright bar and two arms that join it to the body.

    Args:
        inner: Distance from the body's axis at which the arms begin [m].
        outer: Distance at which the bar ends [m].
        middle: Height of its middle [m].
        tall: Its height [m].
        thick: Its extent across [m].
        bar: Depth of the upright bar, outwards [m].
        rgba: Colour.
    """
    half_y, arm_half = thick / 2, (outer - bar - inner) / 2
    arm_z = tall / 2 - bar / 2
    geoms = [box((outer - bar / 2, 0.0, middle), (bar / 2, half_y, tall / 2), rgba, "handle")]
    geoms += [
        box((inner + arm_half, 0.0, middle + side * arm_z), (arm_half, half_y, bar / 2), rgba, "handle")
        for side in (1.0, -1.0)
    ]
    part = Part(
        region="handle",
        centre=(outer - bar / 2, 0.0, middle),
        axis=UP,
        width=thick,
        length=tall,
        radius=outer - bar / 2,
        outward=X,
    )
    return geoms, part


def oval(long: float, short: float, corners: int = 24) -> np.ndarray:
    """An ellipse of the given diameters as a polygon (corners, 2) [m]."""
    angles = np.arange(corners) * (2 * math.pi / corners)
    return np.column_stack([long / 2 * np.cos(angles), short / 2 * np.sin(angles)])
