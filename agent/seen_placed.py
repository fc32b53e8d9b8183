"""What a look after a placing shows: the thing where it was to go, elsewhere, fallen over, or not at all."""

from __future__ import annotations

import math
from dataclasses import dataclass

from agent.agenda import on_table
from agent.goal import Goal
from agent.ladder import BRITTLE
from agent.lanes import LANE_WIDTH, lane_of
from kb.base import Vec2
from kb.percept import PerceivedObject, Percept
from kb.sensing import Sensing
from tools.perception.track_ids import unlike

AWAY = 0.08
"""Farther than this from where it was set down a thing has rolled away or was dragged along [m]: long things that are seen
in part appear up to 4 cm off."""
NEAR = 0.05
"""A new thing this near to where something was set down is that thing, whatever it looks like from there [m]."""
ALIKE = 0.35
"""A new thing farther away is that thing only if it looks like it (`tools.perception.track_ids.unlike`)."""
LOW, LONG = 0.6, 0.7
"""A thing lies that is lower than this share of its height and longer than this share of it."""
STANDS_ON = 0.03
"""What stands on a thing may seem this much lower than its top [m]."""


@dataclass(frozen=True)
class SeenPlaced:
    """What was seen of a thing that was put down."""

    thing: PerceivedObject | None
    """The thing, if it was seen."""
    well: bool
    """Nothing speaks against that it is where it was to go."""
    fallen: bool = False
    words: str = ""
    """What is wrong."""


def called_as_before(percept: Percept, before: Percept, put: PerceivedObject, sensing: Sensing | None) -> Percept:
    """The percept in which the thing that was put down bears its id again.

    From another place the same thing may be taken for one of another category. What rolled away or fell beside the bin
    lies too far from where it was taken to be known again by its place: it is the one new thing that looks like it.

    Args:
        percept: The look after the placing.
        before: The look before it was taken.
        put: The thing as it stood before.
        sensing: Of the placing.
    """
    aimed = sensing.aimed_at if sensing is not None else None
    if aimed is None or any(obj.id == put.id for obj in percept.objects):
        return percept
    known = {obj.id for obj in before.objects}
    new = [obj for obj in percept.objects if obj.id not in known]
    found = [obj for obj in new if _off(obj, aimed) < NEAR] or [obj for obj in new if unlike(obj, put) < ALIKE]
    if len(found) != 1:
        return percept
    objects = tuple(o.model_copy(update={"id": put.id}) if o is found[0] else o for o in percept.objects)
    return percept.model_copy(update={"objects": objects})


def seen_placed(percept: Percept, goal: Goal, put: PerceivedObject, sensing: Sensing | None) -> SeenPlaced:
    """Judges a placing by a look.

    Args:
        percept: The look after it, in which the thing bears its old id.
        goal: The placing's goal.
        put: The thing as it stood before it was taken.
        sensing: Of the placing.
    """
    name = put.category.replace("_", " ")
    thing = next((obj for obj in percept.objects if obj.id == put.id), None)
    kind = goal.placement.kind if goal.placement is not None else "aside"
    if sensing is not None and sensing.lost:
        broken = put.affordance.fragility >= BRITTLE
        words = f"The {name} slipped out of my hand on the way" + (" and may be broken." if broken else ".")
        return SeenPlaced(thing, False, fallen=broken, words=words)
    if kind == "bin":
        # Walls and other things hide what lies in the bin: only what is seen outside is not in it.
        outside = thing is not None and on_table(thing, percept)
        return SeenPlaced(thing or put, not outside, words=f"I see the {name} beside the bin, not in it.")
    if thing is None:
        return SeenPlaced(None, False, words=f"I do not see the {name} any more where I put it.")
    if _lies(thing, put):
        return SeenPlaced(thing, False, fallen=True, words=f"The {name} has fallen over where I put it.")
    if kind == "lane" and goal.placement is not None:
        (_, right), (_, left) = lane_of(goal.placement.lane or (0, 1))
        if abs(thing.position[1] - (right + left) / 2) > LANE_WIDTH / 2:
            return SeenPlaced(thing, False, words=f"The {name} is not in its lane: I see it beside it.")
        return SeenPlaced(thing, True)
    if kind == "on" and _fell_off(thing, goal, percept):
        return SeenPlaced(thing, False, words=f"The {name} is not on top any more.")
    aimed = sensing.aimed_at if sensing is not None else None
    if aimed is not None and kind != "aside" and _off(thing, aimed) > AWAY:
        off = _off(thing, aimed) * 100
        return SeenPlaced(thing, False, words=f"The {name} is {off:.0f} cm from where I put it.")
    return SeenPlaced(thing, True)


def _off(thing: PerceivedObject, point: Vec2) -> float:
    """Distance of a thing's middle from a point of the table [m]."""
    return math.dist(thing.position[:2], point)


def _lies(thing: PerceivedObject, put: PerceivedObject) -> bool:
    """Whether what stood upright lies on its side now."""
    height = put.size[2]
    return thing.size[2] < LOW * height and max(thing.size[:2]) > max(LONG * height, 1.3 * max(put.size[:2]))


def _fell_off(thing: PerceivedObject, goal: Goal, percept: Percept) -> bool:
    """Whether it stands lower than the top of what it was put on."""
    target = goal.placement.target if goal.placement is not None else None
    below = next((obj for obj in percept.objects if obj.id == target), None)
    return below is not None and thing.base_z < below.top_z - STANDS_ON and _off(thing, below.position[:2]) > NEAR
