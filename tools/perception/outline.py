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

_THETA = np.arange(DIRECTIONS) * (2 * np.pi / DIRECTIONS)
_UNIT = np.stack([np.cos(_THETA), np.sin(_THETA)])


@dataclass(frozen=True)
class Outline:
    """The outline of an object seen from above."""

    support: Array
    """h(theta) about `origin` (DIRECTIONS,) [m]."""
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

    def rectangle(self) -> tuple[Array, float, float, float]:
        """The smallest rectangle: centre (2,) [m], azimuth of its longer side [rad], longer and shorter side [m]."""
        half, quarter = DIRECTIONS // 2, DIRECTIONS // 4
        width = self.support + np.roll(self.support, -half)
        area = (width * np.roll(width, -quarter))[:quarter]
        k = int(np.argmin(area))
        left, right = area[k - 1], area[(k + 1) % quarter]
        bend = left - 2 * area[k] + right
        shift = 0.0 if bend <= 0 else float(np.clip(0.5 * (left - right) / bend, -0.5, 0.5))
        theta = _THETA[k] + shift * _THETA[1]
        low, high = self._reach(theta + np.pi), self._reach(theta)
        right_side, left_side = self._reach(theta - np.pi / 2), self._reach(theta + np.pi / 2)
        along, across = high + low, left_side + right_side
        c, s = np.cos(theta), np.sin(theta)
        a, b = (high - low) / 2, (left_side - right_side) / 2
        centre = self.origin + np.array([a * c - b * s, a * s + b * c])
        if across > along:
            theta, along, across = theta + np.pi / 2, across, along
        return centre, wrap_half_turn(theta), along, across

    def _reach(self, theta: float) -> float:
        """h at any azimuth [rad], linear between the sampled ones."""
        place = (theta % (2 * np.pi)) / _THETA[1]
        low = int(place) % DIRECTIONS
        share = place - int(place)
        return float((1 - share) * self.support[low] + share * self.support[(low + 1) % DIRECTIONS])


def outline(xy: Array) -> Outline:
    """The outline of points (N, >= 2) seen from above [m]."""
    xy = xy[:, :2]
    origin = (xy.min(0) + xy.max(0)) / 2
    support = ((xy - origin).astype(np.float32) @ _UNIT.astype(np.float32)).max(0).astype(np.float64)
    a = np.column_stack([_UNIT.T, np.ones(DIRECTIONS)])
    keep = np.ones(DIRECTIONS, bool)
    solution = np.zeros(3)
    for _ in range(5):
        solution = np.linalg.lstsq(a[keep], support[keep], rcond=None)[0]
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
        origin=origin,
        centre=origin + solution[:2],
        radius=radius,
        roughness=float(np.median(np.abs(error)) / max(radius, 1e-3)),
        bulge=float(error[far]),
        bulge_azimuth=float(_THETA[far]),
        harmonics=2 * spectrum[2:5] / max(float(spectrum[0]), 1e-4),
        hull_area=0.5 * abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))),
    )
