"""Footprints of perceived boxes as rectangles, and how far apart they are."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from kb.base import Vec3
from tools.planning.candidate import Array

ROUNDING = 1e-9
"""Far more than gaps are off by rounding [m]."""


def outline(centre: Sequence[float], size: Vec3, yaw: float) -> Array:
    """Corners of a box's footprint (4, 2) [m]."""
    cosine, sine = math.cos(yaw), math.sin(yaw)
    corners = 0.5 * np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * np.asarray(size[:2])
    return corners @ np.array([[cosine, sine], [-sine, cosine]]) + np.asarray(centre[:2])


def rectangle_gap(one: Array, other: Array) -> float:
    """Widest gap between two rectangles (4, 2) along a side of either [m]: never more than their distance."""
    both = np.array([one, other])
    edges = both[:, 1:3] - both[:, :2]
    x, y = edges[..., 0].ravel(), edges[..., 1].ravel()
    axes = np.array([-y, x]) / np.maximum(np.sqrt(x * x + y * y), 1e-9)
    along = both @ axes
    (low_a, low_b), (high_a, high_b) = along.min(axis=1), along.max(axis=1)
    return float(np.maximum(low_a - high_b, low_b - high_a).max())


def clear_case(one: Sequence[float], size: Vec3, other: Sequence[float], other_size: Vec3, gap: float) -> bool | None:
    """Whether `rectangle_gap` of two boxes is at least `gap`, however they are turned; None where the turn decides.

    One of the four directions that it looks along is within 45 degrees of the line between the centres, and no gap is
    wider than the distance of the circles inside.
    """
    apart = math.hypot(other[0] - one[0], other[1] - one[1])
    around = 0.5 * (math.hypot(size[0], size[1]) + math.hypot(other_size[0], other_size[1]))
    if apart * math.sqrt(0.5) - around > gap + ROUNDING:
        return True
    return False if apart - 0.5 * (min(size[:2]) + min(other_size[:2])) < gap - ROUNDING else None
