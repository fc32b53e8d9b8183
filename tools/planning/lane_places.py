"""Places in a lane of the table, from the roomiest to the last resort."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator

from kb.base import Vec2
from kb.percept import PerceivedObject, Percept
from kb.sensing import Plan
from tools.planning.set_down import GAP, SetDown, is_free, set_downs, stands_clear, strip

LEAST_GAP = 0.012
"""Distance between what is set down and what stands there where there is no room for more [m]."""
HAND_ROOMS = (0.07, 0.05, 0.0)
"""Distances from what is still to be gripped that are wished for, in order [m]. The hand fits between from 5 cm on: a banana
beside which a glass had been put was gripped by its end, turned in the hand and hit the glass."""
LANE_INSET = 0.035
"""Distance that the middle of what is put into a lane keeps from the lane's edges [m]: the set-down is good to 1 cm, and a
ball may roll another."""
ACROSS_STEP = 0.03
"""Widths across a lane that differ by less than this are as good as each other [m]."""


def lane_places(
    held: PerceivedObject, plan: Plan, percept: Percept, corners: tuple[Vec2, Vec2], to_take: Collection[str] = ()
) -> Iterator[SetDown]:
    """Free places in a lane, well inside it, with long things along it: what lies across is in the others' way.

    Those that leave room for the hand beside what is still to be gripped come first.

    Args:
        held: The object as it stood when it was gripped.
        plan: The plan that holds it.
        percept: What stands where.
        corners: Near right and far left corner of the lane [m].
        to_take: Perceived ids of what is still to be gripped.
    """
    others = [other for other in percept.objects if other.id != held.id]
    long, short = held.size[0], held.size[1]
    narrow = min(long, short) / 2

    def across(option: SetDown) -> int:
        yaw = held.yaw + option.turn
        return round((abs(math.sin(yaw)) * long + abs(math.cos(yaw)) * short) / ACROSS_STEP)

    def room(option: SetDown) -> float:
        return next(wish for wish in HAND_ROOMS if wish == 0.0 or stands_clear(held, option, waiting, wish))

    waiting = [other for other in others if other.id in to_take]
    wishes = [(GAP, wish) for wish in HAND_ROOMS] if waiting else [(GAP, None)]
    for gap, wish in (*wishes, (LEAST_GAP, None)):
        for centre in strip(corners, LANE_INSET):
            if is_free(centre, narrow, percept, (held.id,), gap, held.size[2] + GAP):
                for option in sorted(set_downs(held, plan, centre, 0.0), key=across):
                    if stands_clear(held, option, others, gap) and (wish is None or room(option) == wish):
                        yield option
