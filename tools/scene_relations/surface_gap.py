"""Surface-to-surface distance of two objects, and the overlap of their footprints (ledger G5)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from tools.scene_relations.solid import Piece, Solid, largest

Array = NDArray[np.float64]

GRID = 9
"""Footprint samples per side for overlap shares: a share's resolution is about 1 / 81."""


def surface_gap(one: Solid, other: Solid) -> float:
    """Smallest distance between the surfaces [m]; 0 if they touch or overlap. Symmetric."""
    return min(piece_gap(a, b) for a in one.pieces for b in other.pieces)


def piece_gap(one: Piece, other: Piece) -> float:
    """Distance of two pieces [m]: both are upright, so the horizontal and the vertical gap combine by Pythagoras."""
    flat = max(0.0, rectangle_gap(one, other) - one.radius - other.radius)
    tall = max(0.0, one.low - other.high, other.low - one.high)
    return max(0.0, math.hypot(flat, tall) - one.ball - other.ball)


def rectangle_gap(one: Piece, other: Piece) -> float:
    """Distance of the two unrounded rectangles in the plane [m]; 0 if they overlap."""
    if _overlap(one, other):
        return 0.0
    return min(_to_rectangle(one.corners(), other), _to_rectangle(other.corners(), one))


def overlap_share(one: Solid, other: Solid) -> float:
    """Share of the footprint of `one` that lies over the footprint of `other`, in [0, 1]."""
    points = footprint_samples(one)
    return float(other.contains_horizontally(points).mean())


def footprint_samples(solid: Solid) -> Array:
    """Evenly spread points of the footprint of the largest piece, shape (N, 2)."""
    piece = largest(solid)
    a, b = piece.half[0] + piece.reach(), piece.half[1] + piece.reach()
    steps = (np.arange(GRID) + 0.5) / GRID * 2.0 - 1.0
    u, v = np.meshgrid(steps * a, steps * b)
    local = np.column_stack([u.ravel(), v.ravel()])
    c, s = math.cos(piece.yaw), math.sin(piece.yaw)
    points = local @ np.array([[c, s], [-s, c]]) + np.asarray(piece.centre)
    return points[piece.horizontal_distance(points) <= 1e-9]


def _to_rectangle(points: Array, piece: Piece) -> float:
    outside = np.maximum(np.abs(piece.local(points)) - np.asarray(piece.half), 0.0)
    return float(np.hypot(outside[:, 0], outside[:, 1]).min())


def _overlap(one: Piece, other: Piece) -> bool:
    """Separating-axis test of two rectangles in the plane."""
    first, second = one.corners(), other.corners()
    for yaw in (one.yaw, other.yaw):
        for axis in ((math.cos(yaw), math.sin(yaw)), (-math.sin(yaw), math.cos(yaw))):
            p, q = first @ np.asarray(axis), second @ np.asarray(axis)
            if p.max() < q.min() or q.max() < p.min():
                return False
    return True
