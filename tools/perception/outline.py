"""What an object looks like from above: its support function, and the circle or rectangle that it suggests.

h(theta) is the farthest reach of the points along azimuth theta. Of a circle it is c . u(theta) + r; its even Fourier
terms tell elongation and corners. The top camera sees the upper envelope of an upright thing whole, so h is complete
where point clouds of single surfaces are not.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tools.perception.upright_box import wrap_half_turn

Array = NDArray[np.float64]

DIRECTIONS = 180
"""Azimuths at which the support function is taken (2 degrees apart)."""

SPARE = 4
"""The reach is that of the fourth farthest point: of many noisy points the farthest lies beyond the edge."""

_THETA: Array = np.arange(DIRECTIONS, dtype=np.float64) * (2 * np.pi / DIRECTIONS)
_UNIT = np.stack([np.cos(_THETA), np.sin(_THETA)])


@dataclass(frozen=True)
class Outline:
    """The outline of an object seen from above."""

    support: Array
    """h(theta) about `origin` (DIRECTIONS,) [m]."""
    shell: Array
    """The points near the outline (K, 2), relative to `origin` [m]."""
    origin: Array
    """Point about which h is taken (2,) [m]."""
    centre: Array
    """Centre of the fitted circle (2,) [m]."""
    radius: float
    """Radius of the fitted circle [m]."""
    roughness: float
    """Median absolute deviation of h from the circle over the radius; below about 0.03 the outline is round."""
    bulge: float
    """Largest excess of h over the circle [m]: a handle."""
    bulge_azimuth: float
    """Azimuth of that excess [rad]."""
    harmonics: Array
    """Amplitudes of the Fourier terms 2, 3, 4 of h over its mean (3,)."""
    hull_area: float
    """Area of the convex hull [m^2]."""

    def excess(self, centre: Array) -> Array:
        """Reach from a point (2,) along each azimuth (DIRECTIONS,) [m]."""
        return self.support - (centre - self.origin) @ _UNIT

    def rectangle(self) -> tuple[Array, float, float, float]:
        """The smallest rectangle: centre (2,) [m], azimuth of its longer side [rad], longer and shorter side [m]."""
        half, quarter = DIRECTIONS // 2, DIRECTIONS // 4
        width = self.support + np.roll(self.support, -half)
        k = int(np.argmin((width * np.roll(width, -quarter))[:quarter]))
        fine = _THETA[k] + np.deg2rad(np.arange(-2.0, 2.01, 0.25))
        turns = np.concatenate([fine, fine + np.pi / 2, fine + np.pi, fine - np.pi / 2])
        reach = _reach_along(self.shell, turns, SPARE).reshape(4, -1)
        best = int(np.argmin((reach[0] + reach[2]) * (reach[1] + reach[3])))
        theta = float(fine[best])
        high, left_side, low, right_side = reach[:, best]
        along, across = float(high + low), float(left_side + right_side)
        c, s = np.cos(theta), np.sin(theta)
        a, b = (high - low) / 2, (left_side - right_side) / 2
        centre = self.origin + np.array([a * c - b * s, a * s + b * c])
        if across > along:
            theta, along, across = theta + np.pi / 2, across, along
        return centre, wrap_half_turn(theta), along, across


def _reach_along(xy: Array, azimuths: Array, spare: int) -> Array:
    """Reach of points (N, 2) along azimuths (K,) [rad]: the `spare`-th farthest point's, against single noisy ones."""
    along = xy @ np.stack([np.cos(azimuths), np.sin(azimuths)])
    spare = min(spare, len(xy))
    return np.partition(along, len(xy) - spare, axis=0)[len(xy) - spare]


def _shell(xy: Array) -> Array:
    """The points (N, 2) that are near the outline in some direction: the only ones that matter for it."""
    along = xy.astype(np.float32) @ _UNIT[:, ::4].astype(np.float32)
    return xy[(along > along.max(0) - np.float32(0.005)).any(axis=1)]


def outline(xy: Array, spare: int = SPARE) -> Outline:
    """The outline of points (N, >= 2) seen from above [m]."""
    xy = xy[:, :2]
    origin = (xy.min(0) + xy.max(0)) / 2
    shell = _shell(xy - origin)
    support = _reach_along(shell, _THETA, spare)
    a = np.column_stack([_UNIT.T, np.ones(DIRECTIONS)])
    keep = np.ones(DIRECTIONS, bool)
    solution = np.zeros(3)
    for _ in range(5):
        solution = np.linalg.solve(a[keep].T @ a[keep] + 1e-9 * np.eye(3), a[keep].T @ support[keep])
        error = support - a @ solution
        keep = error < max(0.0015, 1.5 * float(np.median(np.abs(error))))  # only what sticks out is not the circle
    error = support - a @ solution
    radius = float(solution[2])
    far = int(np.argmax(error))
    spectrum = np.abs(np.fft.rfft(support)) / DIRECTIONS
    corner = support[:, None] * _UNIT.T + (np.gradient(support, _THETA)[:, None]) * np.stack([-_UNIT[1], _UNIT[0]]).T
    x, y = corner[:, 0], corner[:, 1]
    return Outline(
        support=support,
        shell=shell,
        origin=origin,
        centre=origin + solution[:2],
        radius=radius,
        roughness=float(np.median(np.abs(error)) / max(radius, 1e-3)),
        bulge=float(error[far]),
        bulge_azimuth=float(_THETA[far]),
        harmonics=2 * spectrum[2:5] / max(float(spectrum[0]), 1e-4),
        hull_area=0.5 * abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))),
    )
