"""The bin of the clearing tasks: 30 x 25 x 10 cm inside, on its own stand beside the table (benchmark.md section 2)."""

from __future__ import annotations

from collections.abc import Callable

from kb.percept import Part
from sim.objects.form import Colour, Form, box

INSIDE = (0.30, 0.25, 0.10)
"""Free extents along x, y, z [m]."""
CENTRE = (0.45, 0.55)
"""Where its centre stands [m]."""
FLOOR_Z = 0.0
"""Height of the inside's floor: level with the table's top [m]."""
SHEET = 0.005
"""Thickness of walls and floor [m]."""
STAND = 0.70
"""Height of the stand below the floor sheet [m]."""


def standing_bin(scale: float, colour: Callable[[], Colour]) -> Form:
    """The bin with its stand; the scale is ignored because the set-up does not vary."""
    rgba = colour()
    x, y, z = INSIDE
    base = STAND + SHEET
    grey = (0.35, 0.35, 0.37, 1.0)
    geoms = (
        box((0.0, 0.0, STAND / 2), (0.08, 0.08, STAND / 2), grey),
        box((0.0, 0.0, STAND + SHEET / 2), (x / 2 + SHEET, y / 2 + SHEET, SHEET / 2), rgba),
        box((x / 2 + SHEET / 2, 0.0, base + z / 2), (SHEET / 2, y / 2 + SHEET, z / 2), rgba, "rim"),
        box((-x / 2 - SHEET / 2, 0.0, base + z / 2), (SHEET / 2, y / 2 + SHEET, z / 2), rgba, "rim"),
        box((0.0, y / 2 + SHEET / 2, base + z / 2), (x / 2, SHEET / 2, z / 2), rgba, "rim"),
        box((0.0, -y / 2 - SHEET / 2, base + z / 2), (x / 2, SHEET / 2, z / 2), rgba, "rim"),
    )
    part = Part(region="rim", centre=(0.0, 0.0, base + z), axis=(0.0, 0.0, 1.0), width=SHEET, length=z)
    return Form(geoms, (part,), (x + 2 * SHEET, y + 2 * SHEET, base + z))


def inside() -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Lower and upper corner of the space inside, world frame [m]."""
    (x, y), (w, d, h) = CENTRE, INSIDE
    return (x - w / 2, y - d / 2, FLOOR_Z), (x + w / 2, y + d / 2, FLOOR_Z + h)
