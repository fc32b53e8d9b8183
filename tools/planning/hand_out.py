"""Whether the hand meets anything where it lets go of something and on its way out."""

from __future__ import annotations

import numpy as np

from kb.grasp import Grasp
from sim.swept_hand import HAND_RADIUS, swept_count
from tools.planning.candidate import Array

HAND_LIFT = 0.12
"""Height above a set-down up to which the hand's way out is looked at [m]."""
STRAIGHT = 0.003
"""Sideways part of an approach up to which it surely counts as straight down (`sim.swept_hand.VERTICAL`)."""
HAND_GAP = 0.006
"""Distance that the hand keeps from everything while it sets down [m]."""

SPARSE = 8
"""Every so many points are looked at first."""


def meets(pose: Grasp, points_w: Array, met: dict[tuple[object, ...], bool]) -> bool:
    """Whether the hand comes nearer than `HAND_GAP` to a point.

    Args:
        pose: The hand where it lets go, and how far it backs out.
        points_w: Points of everything else (N, 3) [m].
        met: Answers for these points so far; the same pose is asked about again with other care.
    """
    if not len(points_w):
        return False
    # Raised straight up, the hand passes wherever a shorter way back along the approach leads.
    x, y, z = pose.approach
    straight = z < 0.0 and max(abs(x), abs(y)) < STRAIGHT and pose.standoff <= HAND_LIFT
    way = pose.position, pose.approach, pose.yaw, pose.aperture, 0.0 if straight else pose.standoff
    known = met.get(way)
    if known is None:
        # Most poses that meet anything meet one of a few points.
        known = met[way] = _met(pose, points_w[::SPARSE]) or _met(pose, _near(pose, points_w))
    return known


def _met(pose: Grasp, points_w: Array) -> bool:
    return len(points_w) > 0 and swept_count(pose, points_w, HAND_GAP, lift=HAND_LIFT) > 0


def _near(pose: Grasp, points_w: Array) -> Array:
    """The points (M, 3) that the hand can come near at all on its way [m]."""
    offset = points_w - np.asarray(pose.position)
    reach = HAND_RADIUS + max(pose.standoff, HAND_LIFT) + 2.0 * HAND_GAP
    return points_w.take(np.flatnonzero(np.einsum("ij,ij->i", offset, offset) < reach * reach), axis=0)
