"""From a goal's placement to the arguments of `place_object`."""

from __future__ import annotations

from agent.agenda import on_table
from agent.attempt import Attempt
from agent.goal import Placement
from agent.lanes import lane_of
from agent.state import State
from kb.base import Vec2
from kb.percept import Percept
from tools.place_object import PlaceArgs, Relation

_MIRRORED: dict[str, str] = {
    "left": "right", "right": "left", "front": "back", "back": "front", "left_of": "right_of", "right_of": "left_of",
    "behind": "in_front_of", "in_front_of": "behind",
}  # fmt: skip


def in_robots_words(placement: Placement) -> Placement:
    """The placement with left, right, front and back as the robot sees them.

    A person speaks from the front camera (kb.viewpoint), opposite to the robot; `place_object` and the observer's check
    of a placement count sides from the robot's base.
    """
    side, relation = placement.side, placement.relation
    return placement.model_copy(
        update={
            "side": _MIRRORED.get(side, side) if side else None,
            "relation": _MIRRORED.get(relation, relation) if relation else None,
        }
    )


def place_args(state: State) -> PlaceArgs:
    """Arguments for putting down what is in the hand as the goal in work says."""
    held, percept, placement = state.held, state.percept, state.goal.placement
    assert held is not None
    assert percept is not None
    placement = in_robots_words(placement or Placement(kind="aside"))
    chosen = placement.point if placement.kind != "back" else None
    here = tuple(obj for obj in percept.objects if obj.id != held.object.id)
    percept = percept.model_copy(update={"objects": here})
    x, y = held.object.position[0], held.object.position[1]
    if chosen is not None:  # by a person, before the motion
        return PlaceArgs(percept=percept, held=held.plan, object=held.object, kind="point", point=chosen)
    if placement.kind == "lane":
        corners = lane_of(placement.lane or (0, 1))
        middle = ((corners[0][0] + corners[1][0]) / 2, (corners[0][1] + corners[1][1]) / 2)
        waiting = tuple(obj.id for obj in here if obj.id not in state.displaced)
        return PlaceArgs(
            percept=percept,
            held=held.plan,
            object=held.object,
            kind="point",
            point=middle,
            keep_in=corners,
            to_take=waiting,
        )
    if placement.kind == "back":
        return PlaceArgs(
            percept=percept, held=held.plan, object=held.object, kind="point", point=placement.point or (x, y)
        )
    slot = sum(
        goal.status == "done" and goal.placement is not None and goal.placement.kind == "bin" for goal in state.goals
    ) + sum(not on_table(obj, percept) for obj in here)
    return PlaceArgs(
        percept=percept,
        held=held.plan,
        object=held.object,
        kind=placement.kind,
        side=placement.side,
        reference=placement.target,
        relation=_relation(placement),
        slot=slot if placement.kind == "bin" else 0,
        lying=tuple(obj for obj in state.in_bin if all(obj.id != other.id for other in here)),
    )


def origin_of(state: State) -> Vec2 | None:
    """Where what is in the hand stood before, or is said to have stood [m]."""
    placement = state.goal.placement
    if placement is not None and placement.point is not None:
        return placement.point
    return None if state.held is None else (state.held.object.position[0], state.held.object.position[1])


def put_back_args(attempt: Attempt) -> PlaceArgs:
    """Arguments for putting what a failed attempt left in the hand back where it stood."""
    percept = attempt.percept or Percept(look=0, perception="rgbd", objects=())
    point = (attempt.target.position[0], attempt.target.position[1])
    return PlaceArgs(percept=percept, held=attempt.plan, object=attempt.target, kind="point", point=point)


def _relation(placement: Placement) -> Relation:
    word = placement.relation
    return word if word not in (None, "on", "under", "in") else "near"
