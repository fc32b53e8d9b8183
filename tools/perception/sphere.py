"""Fit a ball to points of which only one side was seen."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Sphere:
    """A fitted ball."""

    centre: Array
    """(3,) [m]."""
    radius: float
    """[m]."""
    residual: float
    """Root-mean-square distance of the points from its surface [m]."""


def fit_sphere(points: Array, rounds: int = 3) -> Sphere:
    """Algebraic fit |p|^2 = 2 c.p + k with points beyond three residuals dropped between rounds; points (N >= 10, 3)."""
    middle = points.mean(0)
    p = points - middle
    keep = np.ones(len(p), bool)
    centre: Array = np.zeros(3)
    radius, distance = 0.0, np.zeros(len(p))
    for _ in range(rounds):
        q = p[keep]
        a = np.column_stack([2 * q, np.ones(len(q))])
        normal, right = a.T @ a, a.T @ (q**2).sum(1)
        solution: Array = np.asarray(np.linalg.lstsq(normal, right, rcond=None)[0], np.float64)
        centre = solution[:3]
        radius = float(np.sqrt(max(solution[3] + centre @ centre, 1e-8)))
        distance: Array = np.asarray(np.linalg.norm(p - centre, axis=1), np.float64) - radius
        spread = float(np.sqrt(np.mean(distance[keep] ** 2)))
        keep = np.abs(distance) < max(3 * spread, 0.002)
        if keep.sum() < 10:
            break
    return Sphere(centre + middle, radius, float(np.sqrt(np.mean(distance**2))))
