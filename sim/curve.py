"""Smooth curves and time laws, in numpy."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sim.panda import Q_ACCELERATION, Q_VELOCITY

Array = NDArray[np.float64]

VELOCITY_SHARE, ACCELERATION_SHARE = 0.9, 0.6
"""Shares of the robot's published joint limits that free motions use."""
TIME_SAMPLES = 64


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
    """Shortest duration [s] of a quintic run along a joint path (K, 7) that keeps to the shares of the joint limits.

    The path's points are evenly spaced in its own parameter; rates are measured on `TIME_SAMPLES` samples of the run.
    """
    run = cubic_spline(np.linspace(0.0, 1.0, len(path)), path, np.concatenate([[0.0], quintic(TIME_SAMPLES)]))
    rate = np.diff(run, axis=0) * TIME_SAMPLES
    change = np.diff(rate, axis=0) * TIME_SAMPLES
    by_velocity = float((np.abs(rate).max(axis=0) / (VELOCITY_SHARE * Q_VELOCITY)).max())
    by_acceleration = float(np.sqrt((np.abs(change).max(axis=0) / (ACCELERATION_SHARE * Q_ACCELERATION)).max()))
    return max(by_velocity, by_acceleration, 0.1)
