"""How near the arm's links behind the hand come to what stands around, over a path."""

from __future__ import annotations

import numpy as np

from sim.arm_shape import RADII, spheres
from sim.kinematics import forward
from sim.reach import Reach
from tools.planning.candidate import Array

BEHIND_FLANGE = 0.112
"""Spheres that lie at least this far behind the tool point along the approach belong to the arm, not to the hand [m]."""
LOWEST = 0.06
"""Points below this height can't be met by links behind a hand that stays above the table [m]."""
FAR = 0.45
"""Points farther than this from the tool point are left to the free motion's own check [m]."""


def arm_clearance(reach: Reach, points_w: Array) -> float:
    """Smallest distance [m] of the links behind the hand from points (N, 3) over approach and lift; inf without any."""
    return path_clearance(np.concatenate([reach.approach[::3], reach.lift[::3]]), points_w)


def path_clearance(path: Array, points_w: Array) -> float:
    """Smallest distance [m] of the links behind the hand from points (N, 3) over configurations (K, 7).

    The hand keeps its direction over the path.
    """
    tools = np.array([forward(joints) for joints in path])
    middle = tools[:, :3, 3].mean(axis=0)
    offset = points_w - middle
    near = (points_w[:, 2] > LOWEST) & (np.einsum("ij,ij->i", offset, offset) < FAR**2)
    points = points_w[near]
    if not len(points):
        return float("inf")
    centres = spheres(path)
    behind = np.einsum("nsi,i->ns", centres - tools[:, None, :3, 3], tools[0, :3, 2]) < -BEHIND_FLANGE
    least = float("inf")
    for row, mask in zip(centres, behind, strict=True):
        gaps = np.linalg.norm(row[mask][:, None] - points[None], axis=-1) - RADII[mask][:, None]
        least = min(least, float(gaps.min()))
    return least
