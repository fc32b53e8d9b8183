"""BLOCKS_APPROACH: an object stands in the way of the hand that comes for another one (from the hand's path).

The hand's ways to the target are sampled: straight down with twelve closing axes, and, for things tall enough,
horizontally from the robot's side with seven headings. A way is blocked if the palm's or the fingers' swept box meets the
object.
"""

from __future__ import annotations

import math

import numpy as np

from tools.scene_relations.solid import Piece, Solid
from tools.scene_relations.surface_gap import meet

PALM_HALF_ALONG, PALM_HALF_ACROSS = 0.102, 0.0315
"""Half extents of the Panda hand along and across its closing axis [m] (physics.md)."""
PALM_THICK = 0.066
"""Thickness of the hand behind the palm [m]."""
FINGER = 0.046
"""Reach of the fingertips beyond the palm [m]."""
FINGER_HALF_ALONG, FINGER_HALF_ACROSS = 0.055, 0.011
"""Half extents of the opened fingers [m]."""
STANDOFF = 0.10
SIDE_HEIGHT = 0.06
"""Least height of a target for a horizontal approach [m]: lower, the hand would hit the table."""
YAWS = 12
HEADINGS = tuple(math.radians(angle) for angle in (-60, -40, -20, 0, 20, 40, 60))
"""Horizontal headings relative to the direction base -> target."""
BLOCKED_SHARE = 0.4
"""Share of the ways that must be blocked."""
FARTHEST = math.hypot(FINGER + PALM_THICK + STANDOFF, PALM_HALF_ALONG)
"""Objects whose footprint is farther from the target's centre than this meet no way [m]."""
SKY = 1.0
"""Upper end of the corridor of a vertical approach [m]."""


def blocks_approach(obstacle: Solid, target: Solid, centre: tuple[float, float]) -> bool:
    """Whether `obstacle` blocks at least `BLOCKED_SHARE` of the hand's ways to `target`, whose centre is given."""
    return blocked_share(obstacle, target, centre) >= BLOCKED_SHARE


def blocked_share(obstacle: Solid, target: Solid, centre: tuple[float, float]) -> float:
    """Share of the sampled ways to the target that meet the obstacle, in [0, 1]."""
    middle = np.array([centre])
    if min(float(piece.horizontal_distance(middle)[0]) for piece in obstacle.pieces) > FARTHEST:
        return 0.0
    ways = [_from_above(target, centre, math.pi * i / YAWS) for i in range(YAWS)]
    if target.high - target.low >= SIDE_HEIGHT:
        bearing = math.atan2(centre[1], centre[0])
        ways += [_from_the_side(target, centre, bearing + heading) for heading in HEADINGS]
    blocked = [any(meet(box, p) for box in way for p in obstacle.pieces) for way in ways]
    return sum(blocked) / len(blocked)


def _from_above(target: Solid, centre: tuple[float, float], yaw: float) -> tuple[Piece, ...]:
    """Swept fingers and palm of a vertical approach with closing axis `yaw`; the tips end in the target's upper part."""
    tip = max(target.low + 0.005, target.high - 0.030)
    fingers = Piece(centre, (FINGER_HALF_ALONG, FINGER_HALF_ACROSS), yaw, 0.0, tip, SKY)
    palm = Piece(centre, (PALM_HALF_ALONG, PALM_HALF_ACROSS), yaw, 0.0, tip + FINGER, SKY)
    return fingers, palm


def _from_the_side(target: Solid, centre: tuple[float, float], heading: float) -> tuple[Piece, ...]:
    """Swept hand of a horizontal approach along `heading`, at the middle of the target's height."""
    height = max(0.04, (target.low + target.high) / 2.0)
    back = FINGER + PALM_THICK + STANDOFF
    middle = (
        centre[0] - math.cos(heading) * (FINGER + back) / 2.0,
        centre[1] - math.sin(heading) * (FINGER + back) / 2.0,
    )
    length = (back - FINGER) / 2.0
    return (
        Piece(middle, (length, PALM_HALF_ALONG), heading, 0.0, height - PALM_HALF_ACROSS, height + PALM_HALF_ACROSS),
    )
