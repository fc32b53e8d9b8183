"""Where the lanes of a sorted table are, and who stands in one."""

from __future__ import annotations

from collections.abc import Iterable

from kb.base import Vec2
from kb.percept import PerceivedObject
from tools.planning.lane_places import HAND_ROOMS, LANE_INSET
from tools.planning.set_down import box_distance, strip

LANE_X: tuple[float, float] = (0.35, 0.68)
"""Depth of the lanes on the table [m]."""
LANE_WIDTH = 0.15
"""Width of a lane [m] (benchmark section 3)."""


def lane_of(lane: tuple[int, int]) -> tuple[Vec2, Vec2]:
    """Corners (near right, far left) of lane `lane` = (number from the left, of how many), centred on the table [m]."""
    number, count = lane
    centre = ((count - 1) / 2 - number) * LANE_WIDTH
    return ((LANE_X[0], centre - LANE_WIDTH / 2), (LANE_X[1], centre + LANE_WIDTH / 2))


def in_the_way(lane: tuple[int, int], others: Iterable[PerceivedObject]) -> int:
    """How many things stand with their middle in a lane."""
    (x0, y0), (x1, y1) = lane_of(lane)
    return sum(x0 <= other.position[0] <= x1 and y0 <= other.position[1] <= y1 for other in others)


def has_room(lane: tuple[int, int], thing: PerceivedObject, waiting: Iterable[PerceivedObject]) -> bool:
    """Whether a lane has a place for a thing beside which the hand can still grip everything that waits to be taken."""
    others, room = list(waiting), min(thing.size[:2]) / 2 + min(wish for wish in HAND_ROOMS if wish > 0.0)
    return any(
        all(box_distance(place, other) >= room for other in others) for place in strip(lane_of(lane), LANE_INSET)
    )
