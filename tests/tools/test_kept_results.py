"""What planning and scene graphs keep between calls changes no result: known objects give what fresh copies give."""

from __future__ import annotations

import numpy as np
import pytest

from kb.constraint import Adjustment, Constraints
from kb.percept import PerceivedObject
from kb.switches import Switches
from tests.percept_fixtures import thing
from tests.planning_fixtures import bottle, context, cup, percept
from tools.build_scene_graph import SceneGraphArgs, build_scene_graph
from tools.context import ToolContext
from tools.plan_grasp import PlanArgs, PlanOutcome, plan_grasp
from tools.planning.constrain_candidates import constrain
from tools.planning.generate_candidates import generate_candidates
from tools.planning.surroundings import completed, own_points, surroundings


def copies(*objects: PerceivedObject) -> tuple[PerceivedObject, ...]:
    """Equal objects that nothing is known of."""
    return tuple(PerceivedObject.model_validate(item.model_dump()) for item in objects)


def plan(objects: tuple[PerceivedObject, ...], **switches: object) -> PlanOutcome:
    """The plan for a cup among other things, leaned away from them."""
    bent = Constraints(adjustment=Adjustment(away=(0.2, 0.1, 0.0)))
    return plan_grasp(PlanArgs(percept=percept(*objects), target="t", constraints=bent), context(**switches))


def test_plans_are_the_same_from_known_objects() -> None:
    """The second plan on the same objects, and one after another configuration's, is the plan on fresh copies."""
    seen = cup("t", 0.5, 0.1), bottle("n", 0.5, 0.22)
    first, other = plan(seen), plan(seen, clearance=False)
    assert plan(seen) == first == plan(copies(*seen))
    assert plan(copies(*seen), clearance=False) == other == plan(seen, clearance=False)
    assert first.plan is not None


def test_scene_graphs_are_the_same_from_known_objects() -> None:
    """Graphs of several targets and both measures of distance, asked for in any order, are those of fresh copies."""
    seen = thing("a", "block", 0.5, 0.0, base=0.12), thing("b", "box", 0.5, 0.0), thing("c", "vase", 0.5, 0.12)
    for distance in ("gap", "centre", "gap"):
        tools = ToolContext(switches=Switches.model_validate({"distance": distance}))
        for target in (None, "a", "c", "a"):
            known = build_scene_graph(SceneGraphArgs(percept=percept(*seen), target=target), tools)
            fresh = build_scene_graph(SceneGraphArgs(percept=percept(*copies(*seen)), target=target), tools)
            assert known == fresh


def test_constraints_count_their_refusals_each_time() -> None:
    """Refusals are added to the counter at every call, and the pool is a list of its own."""
    seen = cup("t", 0.5, 0.1)
    limits = Constraints(adjustment=Adjustment(max_tilt=0.17))
    once: dict[str, int] = {}
    twice: dict[str, int] = {}
    pool = constrain(generate_candidates(seen), seen, limits, once)
    for _ in range(2):
        again = constrain(generate_candidates(seen), seen, limits, twice)
        assert again == pool
        again.clear()
    assert once
    assert twice == {reason: 2 * count for reason, count in once.items()}


def test_shared_points_cannot_be_changed() -> None:
    """Points that several callers get are closed to changes, and equal to those of fresh copies."""
    seen = cup("t", 0.5, 0.1), bottle("n", 0.5, 0.22)
    other = copies(*seen)
    pairs = (
        (surroundings(percept(*seen), "t"), surroundings(percept(*other), "t")),
        (own_points(seen[0]), own_points(other[0])),
        (completed(seen[1]), completed(other[1])),
    )
    for points, fresh in pairs:
        np.testing.assert_array_equal(points, fresh)
        with pytest.raises(ValueError, match="read-only"):
            points[0] = 0.0


def test_a_generator_is_made_when_something_is_drawn() -> None:
    """Of promised generators only those are made that are asked for, once each, and they give their own numbers."""
    made: list[int] = []

    def draws() -> np.random.Generator:
        made.append(1)
        return np.random.default_rng(5)

    tools = context().with_draws(draws)
    assert not made
    drawn = [tools.rng.random() for _ in range(2)]
    assert made == [1]
    rng = np.random.default_rng(5)
    assert drawn == [rng.random(), rng.random()]
    assert tools.with_rng(np.random.default_rng(6)).rng.random() == np.random.default_rng(6).random()
    with pytest.raises(AttributeError):
        _ = tools.nothing
