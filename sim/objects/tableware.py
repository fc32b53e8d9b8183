"""Bowl, vase, wine glass and bottle: bodies of revolution that stand on a foot."""

from __future__ import annotations

import math
from collections.abc import Callable

from kb.percept import Part
from sim.objects.form import Colour, Form, cylinder, frustum, wall
from sim.placed import Cavity

UP = (0.0, 0.0, 1.0)
BOWL_WALL, GLASS_WALL = 0.004, 0.003
"""Thickness of walls [m] (ledger G36; a wine glass is thinner)."""


def bowl(scale: float, colour: Callable[[], Colour]) -> Form:
    """The ceramic bowl of Table I: 12 cm across, 6 cm high, a conical wall that steepens towards the rim."""
    s, rgba = scale, colour()
    geoms = [cylinder(0.033 * s, 0.0, 0.006 * s, rgba)]
    geoms += wall((0.033 * s, 0.006 * s), (0.049 * s, 0.028 * s), BOWL_WALL, 16, rgba)
    geoms += wall((0.049 * s, 0.027 * s), (0.0578 * s, 0.060 * s), BOWL_WALL, 16, rgba, "rim")
    rim = Part(
        region="rim", centre=(0.0, 0.0, 0.060 * s), axis=UP, width=BOWL_WALL, length=0.033 * s, radius=0.0578 * s
    )
    cavity = Cavity(floor=0.008 * s, top=0.060 * s, radius_floor=0.030 * s, radius_top=0.0555 * s)
    body = Part(region="body", centre=(0.0, 0.0, 0.030 * s), axis=UP, width=0.12 * s, length=0.06 * s, radius=0.06 * s)
    return Form(tuple(geoms), (rim, body), (0.12 * s, 0.12 * s, 0.06 * s), cavity)


def vase(scale: float, colour: Callable[[], Colour]) -> Form:
    """The glass vase of Table I: 8 x 8 x 15 cm, belly below, a neck of 3.8 cm (ledger G35), a flared lip."""
    s, rgba = scale, colour()
    geoms = (
        frustum((0.029 * s, 0.0), (0.038 * s, 0.022 * s), rgba),
        cylinder(0.040 * s, 0.020 * s, 0.068 * s, rgba),
        frustum((0.039 * s, 0.068 * s), (0.019 * s, 0.100 * s), rgba),
        cylinder(0.019 * s, 0.098 * s, 0.138 * s, rgba, "neck"),
        frustum((0.019 * s, 0.138 * s), (0.026 * s, 0.150 * s), rgba, "rim"),
    )
    parts = (
        Part(region="neck", centre=(0.0, 0.0, 0.119 * s), axis=UP, width=0.038 * s, length=0.038 * s, radius=0.019 * s),
        Part(region="body", centre=(0.0, 0.0, 0.044 * s), axis=UP, width=0.08 * s, length=0.048 * s, radius=0.04 * s),
    )
    return Form(geoms, parts, (0.08 * s, 0.08 * s, 0.15 * s))


def wine_glass(scale: float, colour: Callable[[], Colour]) -> Form:
    """The wine glass of Table I: 7 x 7 x 20 cm, a stem of 1 cm, an open bowl."""
    s, rgba = scale, colour()
    geoms = [cylinder(0.034 * s, 0.0, 0.004 * s, rgba), cylinder(0.005 * s, 0.004 * s, 0.096 * s, rgba, "stem")]
    geoms += [cylinder(0.018 * s, 0.095 * s, 0.102 * s, rgba)]
    geoms += wall((0.019 * s, 0.100 * s), (0.0335 * s, 0.135 * s), GLASS_WALL, 12, rgba)
    geoms += wall((0.0335 * s, 0.133 * s), (0.029 * s, 0.200 * s), GLASS_WALL, 12, rgba, "rim")
    parts = (
        Part(region="stem", centre=(0.0, 0.0, 0.050 * s), axis=UP, width=0.01 * s, length=0.091 * s, radius=0.005 * s),
        Part(region="rim", centre=(0.0, 0.0, 0.2 * s), axis=UP, width=GLASS_WALL, length=0.067 * s, radius=0.029 * s),
        Part(region="body", centre=(0.0, 0.0, 0.15 * s), axis=UP, width=0.07 * s, length=0.1 * s, radius=0.035 * s),
    )
    cavity = Cavity(floor=0.103 * s, top=0.200 * s, radius_floor=0.017 * s, radius_top=0.0275 * s)
    return Form(tuple(geoms), parts, (0.07 * s, 0.07 * s, 0.20 * s), cavity)


def bottle(scale: float, colour: Callable[[], Colour]) -> Form:
    """The plastic bottle of Table I: 7 x 7 x 22 cm, a straight body, a shoulder, a neck and a cap of another colour."""
    s, rgba, cap = scale, colour(), colour()
    geoms = (
        cylinder(0.035 * s, 0.0, 0.150 * s, rgba),
        frustum((0.035 * s, 0.150 * s), (0.015 * s, 0.182 * s), rgba),
        cylinder(0.014 * s, 0.180 * s, 0.200 * s, rgba, "neck"),
        cylinder(0.0165 * s, 0.200 * s, 0.220 * s, (*cap[:3], 1.0), "neck"),
    )
    parts = (
        Part(region="body", centre=(0.0, 0.0, 0.075 * s), axis=UP, width=0.07 * s, length=0.15 * s, radius=0.035 * s),
        Part(region="neck", centre=(0.0, 0.0, 0.2 * s), axis=UP, width=0.033 * s, length=0.04 * s, radius=0.0165 * s),
    )
    return Form(geoms, parts, (0.07 * s, 0.07 * s, 0.22 * s))


def wall_tilt() -> float:
    """Angle [rad] between the bowl's upper wall and the vertical: a rim grasp arrives along it."""
    return math.atan2(0.0578 - 0.049, 0.060 - 0.027)
