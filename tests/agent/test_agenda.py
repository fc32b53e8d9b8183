"""Which part of a sort comes next."""

from __future__ import annotations

import math

from agent.agenda import NO_PLACE, next_to_handle, parts_of, put_back
from agent.attempt import Held
from agent.goal import Goal, Placement, Reference
from agent.lanes import has_room
from agent.state import State
from kb.percept import PerceivedObject, Percept
from tests.planning_fixtures import context, percept, solid
from tools.plan_grasp import PlanArgs, plan_grasp


def sorting(seen: Percept, order: tuple[str, ...], *parts: Goal) -> State:
    sort = Goal(kind="sort", reference=Reference(words="everything", ids=order, plural=True))
    return State(goals=(sort, *parts), agenda=(0,), percept=seen)


def part(obj: PerceivedObject, number: int, status: str, note: str = "") -> Goal:
    return Goal(
        kind="place", reference=Reference(words="it", ids=(obj.id,)), placement=Placement(kind="lane", lane=(number, 2)),
        target=obj.id, parent=0, note=note,
    ).model_copy(update={"status": status})  # fmt: skip


def test_what_has_a_free_lane_comes_first() -> None:
    """Two lanes, right (order a) and left (order b); b stands in a's lane, so b goes first although a comes first."""
    a, b = solid("a", "cube", 0.5, 0.25), solid("b", "cube", 0.5, -0.05)
    seen = percept(a, b)
    following = next_to_handle(sorting(seen, ("a", "b")), seen, None)
    assert following is not None
    assert following.target == "b"
    elsewhere = percept(a, solid("b", "cube", 0.5, -0.25))
    following = next_to_handle(sorting(elsewhere, ("a", "b")), elsewhere, None)
    assert following is not None
    assert following.target == "a"


def test_what_would_crowd_another_waits() -> None:
    """The first lane is full of two long things that wait, though their middles are outside: one of them goes first."""
    a = solid("a", "wine_glass", 0.55, -0.25)
    b = solid("b", "smartphone", 0.42, -0.08, yaw=math.pi / 2)
    c = solid("c", "smartphone", 0.60, -0.08, yaw=math.pi / 2)
    lane = (2, 3)
    assert not has_room(lane, a, (b, c))
    assert has_room(lane, a, (b,))
    seen = percept(a, b, c)
    following = next_to_handle(sorting(seen, ("a", "b", "c")), seen, None)
    assert following is not None
    assert following.target != "a"


def test_what_found_no_room_is_taken_up_once_more_at_the_end() -> None:
    """After a failure for want of room the part comes again when all others are done; after a second one it does not."""
    a, b = solid("a", "cube", 0.5, 0.25), solid("b", "cube", 0.5, 0.075)
    seen = percept(a, b)
    failed, done = part(a, 1, "failed", NO_PLACE), part(b, 0, "done")
    again = next_to_handle(sorting(seen, ("a", "b"), failed, done), seen, None)
    assert again is not None
    assert again.target == "a"
    assert next_to_handle(sorting(seen, ("a", "b"), failed, done, failed), seen, None) is None
    other = part(a, 1, "failed", "it has fallen over and may be broken")
    assert next_to_handle(sorting(seen, ("a", "b"), other, done), seen, None) is None


def test_of_a_part_that_was_taken_up_again_the_last_one_counts() -> None:
    """A part that failed and succeeded later is one part, and done."""
    a = solid("a", "cube", 0.5, 0.25)
    goals = sorting(percept(a), ("a",), part(a, 0, "failed", NO_PLACE), part(a, 0, "done")).goals
    assert [goal.status for goal in parts_of(goals, 0)] == ["done"]


def test_back_is_where_it_was_taken_from() -> None:
    """The sub-goal that frees the hand remembers the place, whatever happens to the thing on the way."""
    a = solid("a", "cube", 0.5, 0.25)
    plan = plan_grasp(PlanArgs(percept=percept(a), target="a"), context()).plan
    assert plan is not None
    goal = put_back(Held(plan=plan, object=a, category="cube"))
    assert goal.placement is not None
    assert goal.placement.point == (0.5, 0.25)
