"""What is in the hand: a twin is noticed and put back, a heavy thing is no wrong one, a hidden place is no doubt."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from agent import build_agent, nodes
from bench.provocations import the_other_one

TWINS = 16_203
"""Two blocks and a ball."""


def grasp_the_other_one_first(monkeypatch: pytest.MonkeyPatch) -> None:
    """Bends the first plan so that it takes the thing most like the target."""
    real, calls = nodes.plan_grasp, list[Any]()

    def plan(args: Any, context: Any) -> Any:
        outcome = real(args, context)
        calls.append(args)
        if len(calls) > 1:
            return outcome
        target = args.percept.object(args.target)
        bent = the_other_one(outcome.plan, args.percept, target, np.random.default_rng(1))
        return outcome.model_copy(update={"plan": bent})

    monkeypatch.setattr(nodes, "plan_grasp", plan)


def test_a_twin_in_the_hand_is_noticed_put_back_and_the_right_one_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    """Width and weight are the target's own; the place that became empty is not. The retry takes the right block."""
    grasp_the_other_one_first(monkeypatch)
    agent = build_agent("repeated_categories", TWINS, perception="rgbd")
    before = agent.opened.observer.poses()
    result = agent.run("pick up the left block")
    attempts = result.goals[0].attempts
    assert [a.failure for a in attempts] == ["WRONG_OBJECT", None]
    assert [a.observed_failure for a in attempts] == ["WRONG_OBJECT", None]
    assert result.success
    meant, after = result.goals[0].object, agent.opened.observer.poses()
    others = [name for name in before if name != meant]
    # The twin stands where it stood, up to what a set-down shifts.
    assert max(float(np.linalg.norm(before[name][:2] - after[name][:2])) for name in others) < 0.015


def test_a_known_thing_five_times_as_heavy_is_not_called_a_wrong_one() -> None:
    """Its weight is a surprise, its place is empty: success is claimed, and the observer agrees."""
    agent = build_agent("single_cube", 16_500, perception="rgbd")
    model = agent.opened.world.model
    cube = model.body(agent.opened.placed.objects[0].id).id
    model.body_mass[cube] *= 5.0
    model.body_inertia[cube] *= 5.0
    result = agent.run("pick up the cube")
    assert [a.claimed for a in result.goals[0].attempts] == [True]
    assert result.success


def test_a_thing_alone_costs_no_further_look(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing could be mistaken for the cube and nothing is odd: one look, of two cameras, in the whole run."""
    agent = build_agent("single_cube", 10_001, perception="rgbd")
    taken: list[Any] = []
    real = agent.opened.robot.look

    def look(*args: Any, **kwargs: Any) -> Any:
        taken.append(args)
        return real(*args, **kwargs)

    monkeypatch.setattr(agent.opened.robot, "look", look)
    assert agent.run("pick up the cube").success
    assert len(taken) == 1
