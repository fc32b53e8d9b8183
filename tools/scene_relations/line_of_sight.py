"""OCCLUDES: how much of an object another one hides from the front camera (ledger G51)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from kb.viewpoint import EYE
from tools.scene_relations.solid import Piece, Solid, largest

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
    if not _may_hide(front, back):
        return 0.0
    points = volume_samples(back)
    hidden = np.zeros(len(points), dtype=bool)
    for piece in front.pieces:
        hidden |= crosses(points, piece)
    return float(hidden.mean())


def _may_hide(front: Solid, back: Solid) -> bool:
    """A quick look: seen from the front camera, the two lie in overlapping sectors of the horizon."""
    (a, half_a), (b, half_b) = _sector(front), _sector(back)
    return abs(a - b) <= half_a + half_b


def _sector(solid: Solid) -> tuple[float, float]:
    """Bearing of the largest piece from the front camera and half its angular width, generously [rad]."""
    piece = largest(solid)
    x, y = EYE[0] - piece.centre[0], piece.centre[1] - EYE[1]
    reach = math.hypot(*piece.half) + piece.reach() + 0.03
    return math.atan2(y, x), math.asin(min(1.0, reach / math.hypot(x, y)))


def volume_samples(solid: Solid) -> Array:
    """Evenly spread points of the largest piece, shape (N, 3)."""
    piece = largest(solid)
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

    Within the piece's range of heights a segment is a straight line in the plane, which either meets the footprint or
    not.
    """
    eye = np.asarray(EYE)
    along = points - eye
    if piece.ball > 0.0:  # a ball: distance of its centre to the segment
        centre = np.array([*piece.centre, piece.low])
        t = np.clip(((centre - eye) * along).sum(axis=1) / (along**2).sum(axis=1), 0.0, 1.0)
        return np.linalg.norm(eye + t[:, None] * along - centre, axis=1) <= piece.ball
    t0, t1 = _within(eye[2], along[:, 2], piece.low, piece.high)
    start = piece.local((eye + t0[:, None] * along)[:, :2])
    end = piece.local((eye + t1[:, None] * along)[:, :2])
    return (t1 > t0) & _meets_footprint(start, end - start, piece)


def _within(origin: float | Array, along: Array, low: float, high: float) -> tuple[Array, Array]:
    """Parameters in [0, 1] between which origin + t along lies in [low, high]; the first exceeds the last if never."""
    safe = np.where(np.abs(along) < 1e-12, 1e-12, along)
    first, second = (low - origin) / safe, (high - origin) / safe
    return np.maximum(np.minimum(first, second), 0.0), np.minimum(np.maximum(first, second), 1.0)


def _meets_footprint(start: Array, along: Array, piece: Piece) -> NDArray[np.bool_]:
    """Which plane segments start + t along, t in [0, 1], in the piece's own axes (N, 2), meet its footprint."""
    if piece.half == (0.0, 0.0):
        length = np.maximum((along**2).sum(axis=1), 1e-18)
        t = np.clip(-(start * along).sum(axis=1) / length, 0.0, 1.0)
        return np.hypot(*(start + t[:, None] * along).T) <= piece.radius
    u0, u1 = _within(start[:, 0], along[:, 0], -piece.half[0], piece.half[0])
    v0, v1 = _within(start[:, 1], along[:, 1], -piece.half[1], piece.half[1])
    return np.minimum(u1, v1) >= np.maximum(u0, v0)
