"""Cup and mug: a round wall on a floor, with a loop handle that the fingers fit through and around (ledger G35)."""

from __future__ import annotations

from collections.abc import Callable

from kb.percept import Part
from sim.objects.form import Colour, Form, box, cylinder, wall
from sim.placed import Cavity, Geom

WALL = 0.004
"""Thickness of the wall [m] (ledger G35)."""
HANDLE_THICK, HANDLE_REACH, HANDLE_TALL = 0.012, 0.025, 0.060
"""The handle's loop: across the bar, outwards from the wall, and upright [m] (ledger G35)."""
BAR = 0.010
"""Depth of the loop's upright bar, outwards [m]; its flat sides give the pads a patch that resists the cup's weight."""
FOOT = 0.003
"""The wall starts this far above the table, so that the cup stands on its floor alone [m] (physics.md, Speed)."""


def cup(scale: float, colour: Callable[[], Colour]) -> Form:
    """The ceramic cup of Table I: 8 x 8 x 9 cm without its handle."""
    return _with_handle(0.040 * scale, 0.090 * scale, 0.0475 * scale, scale, colour())


def mug(scale: float, colour: Callable[[], Colour]) -> Form:
    """A mug: 7.8 x 7.8 x 10.5 cm without its handle."""
    return _with_handle(0.039 * scale, 0.105 * scale, 0.0575 * scale, scale, colour())


def _with_handle(radius: float, height: float, handle_z: float, scale: float, rgba: Colour) -> Form:
    """A cup of outer `radius` and `height` whose handle's middle is at `handle_z` [m]."""
    middle = radius - WALL / 2
    geoms = [cylinder(radius - 0.6 * WALL, 0.0, 0.006, rgba)]
    geoms += wall((middle, FOOT), (middle, height), WALL, 16, rgba)
    geoms += _loop(radius, handle_z, scale, rgba)
    bar_x = radius + HANDLE_REACH * scale - BAR * scale / 2
    tall = HANDLE_TALL * scale
    parts = (
        Part(
            region="handle",
            centre=(bar_x, 0.0, handle_z),
            axis=(0.0, 0.0, 1.0),
            width=HANDLE_THICK * scale,
            length=tall,
            radius=bar_x,
            outward=(1.0, 0.0, 0.0),
        ),
        Part(region="rim", centre=(0.0, 0.0, height), axis=(0.0, 0.0, 1.0), width=WALL, length=height, radius=middle),
        Part(
            region="body",
            centre=(0.0, 0.0, height / 2),
            axis=(0.0, 0.0, 1.0),
            width=2 * radius,
            length=height,
            radius=radius,
        ),
    )
    size = (2 * radius + HANDLE_REACH * scale, 2 * radius, height)
    cavity = Cavity(floor=0.006, top=height, radius_floor=radius - WALL, radius_top=radius - WALL)
    return Form(tuple(geoms), parts, size, cavity)


def _loop(radius: float, middle: float, scale: float, rgba: Colour) -> list[Geom]:
    """The handle: an upright bar and two arms that join it to the wall, all flat-sided."""
    half_y = HANDLE_THICK * scale / 2
    reach, tall, bar = HANDLE_REACH * scale, HANDLE_TALL * scale, BAR * scale
    inner = radius - WALL / 2
    arm_half = (radius + reach - bar - inner) / 2
    arm_x = inner + arm_half
    arm_z = tall / 2 - bar / 2
    return [
        box((radius + reach - bar / 2, 0.0, middle), (bar / 2, half_y, tall / 2), rgba, "handle"),
        box((arm_x, 0.0, middle + arm_z), (arm_half, half_y, bar / 2), rgba, "handle"),
        box((arm_x, 0.0, middle - arm_z), (arm_half, half_y, bar / 2), rgba, "handle"),
    ]
