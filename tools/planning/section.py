"""Local width of an object between two fingers, measured on its observed surface points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tools.planning.candidate import PAD_HALF_WIDTH, Array

MIN_POINTS = 6
"""Fewer observed points than this say nothing about a width."""


@dataclass(frozen=True)
class Section:
    """What the points between the fingers span along the closing axis."""

    shift: float
    """From the origin to the middle of the span, along the closing axis [m]."""
    width: float
    """[m]."""
    points: int


def section(
    points_w: Array, origin_w: Array, closing_w: Array, *, half: float, low: float, high: float
) -> Section | None:
    """Spans the observed points in the slab that the fingers would close on.

    Args:
        points_w: Observed surface, shape (N, 3) [m].
        origin_w: A point in the middle of the slab, shape (3,) [m].
        closing_w: Horizontal unit closing axis, shape (3,).
        half: Half the thickness of the slab across the closing axis [m]; never less than a finger's half-width.
        low: Lowest height that counts [m].
        high: Highest height that counts [m].

    Returns:
        The span, or None where fewer than `MIN_POINTS` points lie in the slab.
    """
    if len(points_w) == 0:
        return None
    across_w = np.array([-closing_w[1], closing_w[0], 0.0])
    offset = points_w - origin_w
    inside = np.abs(offset @ across_w) <= max(half, PAD_HALF_WIDTH)
    inside &= (points_w[:, 2] >= low) & (points_w[:, 2] <= high)
    if int(inside.sum()) < MIN_POINTS:
        return None
    along = offset[inside] @ closing_w
    least, most = float(along.min()), float(along.max())
    return Section(shift=(least + most) / 2, width=most - least, points=int(inside.sum()))
