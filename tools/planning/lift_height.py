"""How far to lift, so that the hand passes over what stands around while it is rocked."""

from __future__ import annotations

import math
from collections.abc import Iterable

from kb.base import Vec3
from kb.percept import PerceivedObject
from sim.hand import FULL_LIFT, PALM_ABOVE_TCP
from sim.shake import ANGLE

HAND_SPAN = 0.105
"""How far the hand reaches to either side of the tool point [m]."""
OVER = 0.015
"""Distance that the rocked palm keeps from what is below it [m]."""
HIGHEST = 0.24
"""Highest lift that is asked for [m]; the arm does less where it must."""


def lift_height(position: Vec3, others: Iterable[PerceivedObject]) -> float:
    """The lift [m] of a grasp at a tool point [m] among other things.

    The palm rocked by the shake reaches lower by the sine of its angle; it is to pass over everything within its reach.
    """
    x, y, z = position
    tops = [
        other.top_z
        for other in others
        if math.dist((x, y), other.position[:2]) < HAND_SPAN + max(other.size[0], other.size[1]) / 2
    ]
    needed = max(tops, default=0.0) + OVER - (z + PALM_ABOVE_TCP - HAND_SPAN * math.sin(ANGLE))
    return min(HIGHEST, max(FULL_LIFT, needed))
