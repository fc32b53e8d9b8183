"""Places in the bin, from the roomiest to the last resort."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from kb.base import Vec2, Vec3
from kb.percept import PerceivedObject
from kb.sensing import Plan
from tools.planning.set_down import GAP, SetDown, set_downs, stands_clear

BIN_SLOTS: tuple[Vec2, ...] = (
    (-0.075, -0.050), (0.075, -0.050), (0.0, 0.060), (0.090, 0.060), (-0.090, 0.060), (0.0, 0.0),
)  # fmt: skip
"""Places inside the bin, from its middle [m]; which comes first depends on how much is in already."""
BIN_RAISES = (0.0, 0.015, 0.03, 0.045, 0.07, 0.11)
"""How far above the bin's floor things may be let go where the walls stop the hand from going deeper [m]."""
WALL_ROOM = 0.006
"""Distance that what is put into the bin keeps from its walls [m]."""
DROP_FRAGILITY, GENTLE_DROP = 0.3, 0.03
"""Things at least this fragile must not fall farther than this [m] (benchmark.md section 1: 5 cm damage them)."""


def bin_places(
    held: PerceivedObject, plan: Plan, others: Sequence[PerceivedObject], corners: tuple[Vec3, Vec3], slot: int
) -> Iterator[SetDown]:
    """Hand poses in the order of preference: as deep as the walls let the hand go; fragile things are not dropped.

    Best with room for what swings or rolls when it is let go, and not on top of what lies in the bin already.

    Args:
        held: The object as it stood when it was gripped.
        plan: The plan that holds it.
        others: Everything else, with what lies in the bin.
        corners: Lowest and highest corner of the bin [m].
        slot: How many things lie there: they are spread.
    """
    low, high = corners
    middle = ((low[0] + high[0]) / 2, (low[1] + high[1]) / 2)
    first = slot % len(BIN_SLOTS)
    gentle = held.affordance.fragility >= DROP_FRAGILITY
    raises = [raised for raised in BIN_RAISES if not gentle or raised <= GENTLE_DROP] or [0.0]
    slots = [(middle[0] + dx, middle[1] + dy) for dx, dy in (*BIN_SLOTS[first:], *BIN_SLOTS[:first])]
    grades: list[list[int]] = []
    for wanted in range(4):
        for number, centre in enumerate(slots):
            if number == len(grades):  # mostly the first slots will do
                grades.append(
                    [_grade(held, option, others, corners) for option in set_downs(held, plan, centre, low[2])]
                )
            graded = grades[number]
            if wanted in graded:
                for raised in raises:
                    options = set_downs(held, plan, centre, low[2] + raised)
                    yield from (option for option, grade in zip(options, graded, strict=True) if grade == wanted)


def _grade(
    held: PerceivedObject, option: SetDown, others: Sequence[PerceivedObject], corners: tuple[Vec3, Vec3]
) -> int:
    """How much room there is in the bin, whatever the height: 0 most, 2 not enough, 3 not even from the walls."""
    if not fits_bin(option, held, corners):
        return 3
    rooms = enumerate((GAP, WALL_ROOM))
    return next((k for k, gap in rooms if stands_clear(held, option, others, gap)), 2)


def fits_bin(option: SetDown, held: PerceivedObject, corners: tuple[Vec3, Vec3]) -> bool:
    """Whether the object, turned as it will be, keeps off the walls of the bin."""
    low, high = corners
    yaw = held.yaw + option.turn
    long, short = held.size[0] / 2, held.size[1] / 2
    half = (
        abs(math.cos(yaw)) * long + abs(math.sin(yaw)) * short,
        abs(math.sin(yaw)) * long + abs(math.cos(yaw)) * short,
    )
    if held.shape in ("sphere", "bowl"):
        half = (long, long)
    return all(
        low[k] + WALL_ROOM <= option.centre[k] - half[k] and option.centre[k] + half[k] <= high[k] - WALL_ROOM
        for k in (0, 1)
    )
