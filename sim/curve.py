"""Smooth curves and time laws, in numpy."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sim.panda import Q_ACCELERATION, Q_VELOCITY

Array = NDArray[np.float64]

VELOCITY_SHARE, ACCELERATION_SHARE = 0.8, 0.5
"""Shares of the robot's published joint limits that motions use."""


def quintic(count: int) -> Array:
    """Fractions of the way from just above 0 to 1 of a minimum-jerk motion, shape (count,): at rest at both ends."""
    t = np.arange(1, count + 1) / count
    return t**3 * (10.0 - 15.0 * t + 6.0 * t * t)


def cubic_spline(knots: Array, values: Array, at: Array) -> Array:
    """The natural cubic spline through `values` (K, D) at `knots` (K,), evaluated at `at` (T,); shape (T, D)."""
    count = len(knots)
    if count == 2:
        share = ((at - knots[0]) / (knots[1] - knots[0]))[:, None]
        return values[0] + share * (values[1] - values[0])
    h = np.diff(knots)
    slope = np.diff(values, axis=0) / h[:, None]
    system = np.eye(count)
    right = np.zeros_like(values)
    inner = np.arange(1, count - 1)
    system[inner, inner - 1], system[inner, inner], system[inner, inner + 1] = h[:-1], 2 * (h[:-1] + h[1:]), h[1:]
    right[1:-1] = 6.0 * np.diff(slope, axis=0)
    bend = np.linalg.solve(system, right)
    i = np.clip(np.searchsorted(knots, at, side="right") - 1, 0, count - 2)
    left, gap = (at - knots[i])[:, None], h[i][:, None]
    first = slope[i] - gap * (2 * bend[i] + bend[i + 1]) / 6.0
    return values[i] + left * (first + left * (bend[i] / 2.0 + left * (bend[i + 1] - bend[i]) / (6.0 * gap)))


def path_time(path: Array) -> float:
    """Shortest duration [s] of a quintic run along a joint path (K, 7), evenly spaced in the path's own parameter,
    that keeps to the shares of the joint limits."""
    slope = np.gradient(path, 1.0 / (len(path) - 1), axis=0) if len(path) > 2 else np.diff(path, axis=0)
    bend = np.gradient(slope, 1.0 / (len(path) - 1), axis=0) if len(path) > 2 else np.zeros_like(slope)
    # Quintic: largest rate 15/8 per duration, largest second derivative 5.7735 per duration squared.
    steepest = np.abs(slope).max(axis=0)
    by_velocity = float((steepest * 15.0 / 8.0 / (VELOCITY_SHARE * Q_VELOCITY)).max())
    pull = steepest * 5.7735 + np.abs(bend).max(axis=0) * (15.0 / 8.0) ** 2
    by_acceleration = float(np.sqrt((pull / (ACCELERATION_SHARE * Q_ACCELERATION)).max()))
    return max(by_velocity, by_acceleration, 0.1)
