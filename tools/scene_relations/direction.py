"""LEFT_OF, RIGHT_OF, BEHIND, IN_FRONT_OF: directions as the person at the front camera sees them (kb.viewpoint)."""

from __future__ import annotations

import math

from kb.base import Vec3
from kb.viewpoint import BEHIND, LEFT

CONE = math.radians(60.0)
"""Half opening of the cone around each direction: on a diagonal two of them hold, as people use the words."""
LEAST = 0.02
"""Centres nearer than this in the plane have no direction [m]."""


def lies_towards(one: Vec3, other: Vec3, direction: Vec3) -> bool:
    """Whether `one` lies from `other` within `CONE` of the horizontal `direction`."""
    x, y = one[0] - other[0], one[1] - other[1]
    length = math.hypot(x, y)
    return length >= LEAST and x * direction[0] + y * direction[1] >= math.cos(CONE) * length


def is_behind(one: Vec3, other: Vec3) -> bool:
    """BEHIND: farther from the person, within 60 degrees of the view's horizontal direction."""
    return lies_towards(one, other, BEHIND)


def is_left_of(one: Vec3, other: Vec3) -> bool:
    """LEFT_OF: to the person's left, within 60 degrees."""
    return lies_towards(one, other, LEFT)
