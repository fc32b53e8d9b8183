"""Surface-to-surface distance of two objects, and the overlap of their footprints (ledger G5)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from tools.scene_relations.solid import Piece, Solid, largest

Array = NDArray[np.float64]

NEARLY = 1e-9
"""Gaps nearer to 0 than this are not told by shortcuts [m]."""
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


def meet(one: Piece, other: Piece) -> bool:
    """Whether two pieces touch or overlap: `piece_gap` is 0.

    Clear cases are told by cheaper means; what is within `NEARLY` of touching is left to `piece_gap`.
    """
    room = one.reach() + other.reach()
    if max(one.low - other.high, other.low - one.high) > one.ball + other.ball + NEARLY:
        return False
    x, y = other.centre[0] - one.centre[0], other.centre[1] - one.centre[1]
    if math.hypot(x, y) > math.hypot(*one.half) + math.hypot(*other.half) + room + NEARLY:
        return False
    if one.ball == other.ball == 0.0:
        gap = _separation(x, y, one, other)
        # Of the rounded corners of two rectangles only a separation along a side is certain.
        if gap > room + NEARLY:
            return False
        if gap < -NEARLY and max(one.low - other.high, other.low - one.high) < -NEARLY:
            return True
    return piece_gap(one, other) == 0.0


def _separation(x: float, y: float, one: Piece, other: Piece) -> float:
    """Largest gap of two rectangles, whose centres are (x, y) apart, along one of their four sides; negative: overlap."""
    turn = other.yaw - one.yaw
    cosine, sine = abs(math.cos(turn)), abs(math.sin(turn))
    worst = -math.inf
    for first, second in ((one, other), (other, one)):
        c, s = math.cos(first.yaw), math.sin(first.yaw)
        (a, b), (p, q) = first.half, second.half
        along, across = abs(c * x + s * y) - a - p * cosine - q * sine, abs(c * y - s * x) - b - p * sine - q * cosine
        worst = max(worst, along, across)
    return worst


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
