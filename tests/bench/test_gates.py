"""The calibration gates: what counts as passed, and what a random grasp is."""

from __future__ import annotations

import math

import numpy as np

from bench.gates import Gates, empty_drift, markdown, random_grasp
from kb.grasp import MAX_APERTURE
from tests.planning_fixtures import context, percept, solid
from tools.plan_grasp import PlanArgs, plan_grasp


def gates(**changes: object) -> Gates:
    fields: dict[str, object] = {
        "empty_drift": 1e-5,
        "hold_drift": {"single_cube": 1e-4},
        "oracle": {"a": (19, 20), "b": (20, 20)},
        "random": {"a": (1, 20), "b": (0, 20)},
        "room": {"apple": 0.001},
    }
    return Gates.model_validate(fields | changes)


def test_all_gates_must_hold() -> None:
    """Drift below 2 mm, 95 % of every scene by oracle grasps, below 20 % by random ones."""
    assert gates().passed()
    assert not gates(hold_drift={"single_cube": 0.0021}).passed()
    assert not gates(oracle={"a": (18, 20), "b": (20, 20)}).passed()
    assert not gates(random={"a": (8, 20), "b": (0, 20)}).passed()
    assert not gates(hold_drift={"single_cube": math.inf}).passed()
    assert "| a | 19/20 | 1/20 |" in markdown(gates())


def test_a_random_grasp_is_anywhere_in_the_object_from_any_side() -> None:
    """Within the box (but not in the table), any opening and force, no stored posture."""
    seen = solid("t", "cube", 0.5, 0.0, 0.4)
    plan = plan_grasp(PlanArgs(percept=percept(seen), target="t"), context()).plan
    assert plan is not None
    rng = np.random.default_rng(0)
    drawn = [random_grasp(plan, percept(seen), seen, rng) for _ in range(40)]
    assert all(math.dist(item.grasp.position[:2], (0.5, 0.0)) <= 0.036 for item in drawn)
    assert all(item.joints == () and item.grasp.aperture <= MAX_APERTURE for item in drawn)
    assert np.ptp([item.grasp.force for item in drawn]) > 40


def test_an_empty_hand_stays_where_it_is() -> None:
    """Two seconds of holding still: less than a tenth of a millimetre."""
    assert empty_drift(2.0) < 1e-4
