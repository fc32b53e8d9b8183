"""The smallest upright box around points: the pose and size that a percept reports."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_ANGLES = np.deg2rad(np.arange(0.0, 90.0, 1.0))


@dataclass(frozen=True)
class UprightBox:
    """A box with a vertical axis, world frame."""

    centre: Array
    """Centre (3,) [m]."""
    yaw: float
    """Azimuth of the longer horizontal axis [rad], in (-pi/2, pi/2]."""
    size: Array
    """Extents (3,): longer horizontal, shorter horizontal, vertical [m]."""

    def axes(self) -> Array:
        """Unit axes as rows (3, 3): longer, shorter, up."""
        c, s = np.cos(self.yaw), np.sin(self.yaw)
        return np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])

    def local(self, points: Array) -> Array:
        """World points (N, 3) relative to the centre, along the box's axes."""
        return (points - self.centre) @ self.axes().T


def wrap_half_turn(angle: float) -> float:
    """The angle [rad] of an undirected axis, in (-pi/2, pi/2]."""
    wrapped = (angle + np.pi / 2) % np.pi - np.pi / 2
    return float(np.pi / 2 if wrapped <= -np.pi / 2 + 1e-12 else wrapped)


def box_at(points: Array, yaw: float, *, trim: float = 0.0) -> UprightBox:
    """The box around points (N, 3) with one axis at azimuth `yaw` [rad].

    `trim` in [0, 0.5) cuts that quantile from each end of each axis, against outliers.
    """
    c, s = np.cos(yaw), np.sin(yaw)
    local = np.column_stack([points[:, 0] * c + points[:, 1] * s, points[:, 1] * c - points[:, 0] * s, points[:, 2]])
    low, high = (local.min(0), local.max(0)) if trim == 0 else np.quantile(local, [trim, 1 - trim], axis=0)
    middle, size = (low + high) / 2, high - low
    centre = np.array([middle[0] * c - middle[1] * s, middle[0] * s + middle[1] * c, middle[2]])
    if size[1] > size[0]:
        yaw, size = yaw + np.pi / 2, size[[1, 0, 2]]
    return UprightBox(centre, wrap_half_turn(yaw), size)


def smallest_yaw(points: Array, *, trim: float = 0.0) -> tuple[float, float]:
    """Azimuth [rad] of the smallest rectangle around points (N, >= 2) seen from above, and that rectangle's area [m^2].

    One-degree search over a quarter turn, then a parabola through the best angle and its neighbours.
    """
    xy = points[:, :2] - points[:, :2].mean(0)
    directions = np.stack([np.cos(_ANGLES), np.sin(_ANGLES)])
    along = xy @ directions
    across = xy @ np.stack([-directions[1], directions[0]])
    if trim == 0:
        areas = np.ptp(along, axis=0) * np.ptp(across, axis=0)
    else:
        a, b = np.quantile(along, [trim, 1 - trim], axis=0), np.quantile(across, [trim, 1 - trim], axis=0)
        areas = (a[1] - a[0]) * (b[1] - b[0])
    best = int(np.argmin(areas))
    left, right = areas[best - 1], areas[(best + 1) % len(areas)]
    bend = left - 2 * areas[best] + right
    shift = 0.0 if bend <= 0 else float(np.clip(0.5 * (left - right) / bend, -0.5, 0.5))
    return float(_ANGLES[best] + np.deg2rad(shift)), float(areas[best])
