"""Poses as position (3) and quaternion (w, x, y, z): rotations and points of many of them at once."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def rotation_of(quaternions: ArrayLike) -> Array:
    """Rotation matrices (..., 3, 3) of unit quaternions (..., 4)."""
    q = np.asarray(quaternions, float)
    alone = q.ndim == 1
    # One quaternion alone, as most are, is reckoned in plain numbers: the same sums in a tenth of the time.
    w, x, y, z = q.tolist() if alone else (q[..., i] for i in range(4))
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.array(rows) if alone else np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def point_in_world(pose: ArrayLike, point: ArrayLike) -> Array:
    """A point of the body's frame (3,) in the world, for poses (..., 7)."""
    pose = np.asarray(pose, float)
    return np.einsum("...ij,...j->...i", rotation_of(pose[..., 3:]), np.asarray(point, float)) + pose[..., :3]


def point_in_body(pose: ArrayLike, point: ArrayLike) -> Array:
    """A point of the world (3,) in the body's frame, for poses (..., 7)."""
    pose = np.asarray(pose, float)
    return np.einsum("...ji,...j->...i", rotation_of(pose[..., 3:]), np.asarray(point, float) - pose[..., :3])


def angle_between(a: ArrayLike, b: ArrayLike) -> Array:
    """Angle between unit vectors (..., 3) [rad]."""
    return np.arccos(np.clip(np.sum(np.asarray(a, float) * np.asarray(b, float), axis=-1), -1.0, 1.0))


def turn_between(a: Array, b: Array) -> Array:
    """Angle of the rotation that leads from `a` to `b` (..., 3, 3) [rad]."""
    trace = np.einsum("...ij,...ij->...", a, b)
    return np.arccos(np.clip((trace - 1.0) / 2.0, -1.0, 1.0))


def degrees(angle: float) -> float:
    """[rad] to degrees, rounded to what a person reads."""
    return round(math.degrees(angle), 2)
