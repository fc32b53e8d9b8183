"""OCCLUDES: how much of an object another one hides from the front camera (ledger G51)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from kb.viewpoint import EYE
from tools.scene_relations.solid import Piece, Solid

Array = NDArray[np.float64]

HIDDEN_SHARE = 0.25
"""Share of the object that must be hidden."""
GRID = 7
"""Samples per axis within a piece."""


def hides(front: Solid, back: Solid) -> bool:
    """OCCLUDES: `front` hides at least `HIDDEN_SHARE` of `back` from the front camera."""
    return hidden_share(front, back) >= HIDDEN_SHARE


def hidden_share(front: Solid, back: Solid) -> float:
    """Share of the volume samples of `back` whose line to the front camera passes through `front`, in [0, 1]."""
    points = volume_samples(back)
    hidden = np.zeros(len(points), dtype=bool)
    for piece in front.pieces:
        hidden |= crosses(points, piece)
    return float(hidden.mean())


def volume_samples(solid: Solid) -> Array:
    """Evenly spread points of the largest piece, shape (N, 3)."""
    piece = max(solid.pieces, key=lambda p: (p.half[0] + p.reach()) * (p.half[1] + p.reach()))
    a, b = piece.half[0] + piece.reach(), piece.half[1] + piece.reach()
    low, high = piece.low - piece.ball, piece.high + piece.ball
    steps = (np.arange(GRID) + 0.5) / GRID * 2.0 - 1.0
    u, v, w = (axis.ravel() for axis in np.meshgrid(steps * a, steps * b, (low + high + steps * (high - low)) / 2.0))
    c, s = math.cos(piece.yaw), math.sin(piece.yaw)
    flat = np.column_stack([u, v]) @ np.array([[c, s], [-s, c]]) + np.asarray(piece.centre)
    points = np.column_stack([flat, w])
    return points[piece.distance(points) <= 1e-9]


def crosses(points: Array, piece: Piece) -> NDArray[np.bool_]:
    """Which segments from the front camera to the points (N, 3) pass through the piece, shape (N,).

    Within the piece's range of heights a segment is a straight line in the plane; it meets the footprint if its nearest
    point to it does. The ball's rounding at top and bottom is neglected except for balls proper.
    """
    eye = np.asarray(EYE)
    along = points - eye
    if piece.half == (0.0, 0.0) and piece.low == piece.high:  # a ball: distance of its centre to the segment
        centre = np.array([*piece.centre, piece.low])
        t = np.clip(((centre - eye) * along).sum(axis=1) / (along**2).sum(axis=1), 0.0, 1.0)
        return np.linalg.norm(eye + t[:, None] * along - centre, axis=1) <= piece.ball
    with np.errstate(divide="ignore"):
        first = (piece.low - piece.ball - eye[2]) / along[:, 2]
        second = (piece.high + piece.ball - eye[2]) / along[:, 2]
    t0 = np.clip(np.minimum(first, second), 0.0, 1.0)
    t1 = np.clip(np.maximum(first, second), 0.0, 1.0)
    reached = t1 > t0
    start = piece.local((eye + t0[:, None] * along)[:, :2])
    end = piece.local((eye + t1[:, None] * along)[:, :2])
    return reached & (_segment_to_rectangle(start, end, np.asarray(piece.half)) <= piece.reach())


def _segment_to_rectangle(start: Array, end: Array, half: Array) -> Array:
    """Distance of plane segments (N, 2) to the centred rectangle, shape (N,).

    The distance to a convex set is convex along the segment, so a golden-section search finds its least value; 24
    steps leave 1e-5 of the length.
    """
    ratio = (math.sqrt(5.0) - 1.0) / 2.0

    def distance(t: Array) -> Array:
        outside = np.maximum(np.abs(start + t[:, None] * (end - start)) - half, 0.0)
        return np.hypot(outside[:, 0], outside[:, 1])

    low, high = np.zeros(len(start)), np.ones(len(start))
    for _ in range(24):
        a, b = high - ratio * (high - low), low + ratio * (high - low)
        left = distance(a) <= distance(b)
        high = np.where(left, b, high)
        low = np.where(left, low, a)
    return np.minimum(
        np.minimum(distance((low + high) / 2.0), distance(np.zeros(len(start)))), distance(np.ones(len(start)))
    )
