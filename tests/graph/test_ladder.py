"""The retry ladder: levels, budget, and honest ends, with failures made by hand."""

from __future__ import annotations

import math
from typing import Any

import pytest

from agent import build_agent, motions
from agent.ladder import budget, irreversible, level_of
from kb.sensing import CameraEvidence, Sensing
from kb.switches import Switches
from tests.percept_fixtures import thing

NOTHING = Sensing(phase="close", aperture_start=0.08, aperture_closed=0.0, aperture_end=0.0)
"""The fingers closed on nothing."""


def failing(monkeypatch: pytest.MonkeyPatch, times: int) -> list[Any]:
    """Makes the first `times` grasps close on nothing; the list collects the plans."""
    plans: list[Any] = []
    real = motions.execute_grasp

    def grasp(args: Any, context: Any) -> Sensing:
        plans.append(args.plan)
        return NOTHING if len(plans) <= times else real(args, context)

    monkeypatch.setattr(motions, "execute_grasp", grasp)
    return plans


def test_levels_are_indexed_by_the_attempt_being_prepared() -> None:
    """Resolved: 0, 1, 2, 3; as written level 3 is never reached within four attempts (ledger G19)."""
    assert [level_of(n, Switches()) for n in range(4)] == [0, 1, 2, 3]
    assert [level_of(n, Switches(levels="as_written")) for n in range(4)] == [0, 1, 1, 2]


def test_budget() -> None:
    """Four attempts with recovery, one without."""
    assert budget(Switches()) == 4
    assert budget(Switches(recovery=False)) == 1


def test_a_failure_is_retried_after_another_look(monkeypatch: pytest.MonkeyPatch) -> None:
    """One miss: look, diagnosis, correction of level 1, success at the second attempt."""
    failing(monkeypatch, 1)
    steps: list[Any] = []
    result = build_agent("single_cube", 10_001, perception="oracle").run("pick up the cube", steps.append)
    kinds = [s.kind for s in steps]
    assert result.goals[0].claimed
    assert [a.level for a in result.goals[0].attempts] == [0, 1]
    assert result.goals[0].attempts[1].correction is not None
    assert kinds.index("reflection") > kinds.index("look", kinds.index("action"))


def test_the_arm_is_out_of_the_picture_when_a_failure_is_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    """A miss that leaves the arm stretched out over the table: at the look after it the tool point is back within 1 cm."""
    points: list[tuple[float, float, float]] = []
    real_grasp, real_look = motions.execute_grasp, motions.look

    def grasp(args: Any, context: Any) -> Sensing:
        if points:
            return real_grasp(args, context)
        points.append(context.robot.tool_point)
        context.robot.handover()
        assert math.dist(points[0], context.robot.tool_point) > 0.05
        return NOTHING

    def look(state: Any, runtime: Any) -> Any:
        points.append(runtime.context.world.at(state.world).robot.tool_point)
        return real_look(state, runtime)

    monkeypatch.setattr(motions, "execute_grasp", grasp)
    monkeypatch.setattr(motions, "look", look)
    result = build_agent("single_cube", 10_001, perception="oracle").run("pick up the cube")
    assert result.success
    assert math.dist(points[0], points[1]) < 0.01


@pytest.mark.parametrize(("configuration", "attempts"), [("full", 4), ("no_recovery", 1), ("blind_retry", 4)])
def test_the_budget_is_kept(monkeypatch: pytest.MonkeyPatch, configuration: str, attempts: int) -> None:
    """Misses without end: as many attempts as the configuration allows, then an honest failure that claims nothing."""
    plans = failing(monkeypatch, 99)
    result = build_agent("single_cube", 10_001, perception="oracle", configuration=configuration).run(
        "pick up the cube"
    )
    assert len(plans) == attempts
    assert not result.success
    assert not result.goals[0].claimed
    assert "attempt" in result.answer


def test_levels_of_an_exhausted_goal(monkeypatch: pytest.MonkeyPatch) -> None:
    """The four attempts carry the levels 0, 1, 2, 3, and blind retry carries no correction."""
    failing(monkeypatch, 99)
    full = build_agent("single_cube", 10_001, perception="oracle").run("pick up the cube")
    assert [a.level for a in full.goals[0].attempts] == [0, 1, 2, 3]
    assert all(a.correction for a in full.goals[0].attempts[1:])
    blind = build_agent("single_cube", 10_001, perception="oracle", configuration="blind_retry").run("pick up the cube")
    assert not any(a.correction for a in blind.goals[0].attempts)
    assert blind.goals[0].attempts[0].grasp == full.goals[0].attempts[0].grasp


def test_toppled_glass_is_not_tried_again() -> None:
    """A fragile thing that has fallen over ends the goal; a sturdy one does not."""
    fallen = CameraEvidence(target_tilted=True)
    assert irreversible(thing("obj_0", "wine_glass", 0.5, 0.0), fallen) is not None
    assert irreversible(thing("obj_0", "bottle", 0.5, 0.0), fallen) is None
    assert irreversible(thing("obj_0", "wine_glass", 0.5, 0.0), None) is None


def test_fragile_things_that_fell_are_not_tried_again() -> None:
    """What was carried for a second and then lost fell from the height of the lift; what slipped away at once did not."""
    cup, cube = thing("obj_0", "cup", 0.5, 0.0), thing("obj_0", "cube", 0.5, 0.0)
    high = Sensing(load_lifted=0.3, load_end=0.0, held_s=2.5)
    low = Sensing(load_lifted=0.2, load_end=0.0, held_s=0.6)
    kept = Sensing(load_lifted=0.3, load_end=0.3, held_s=5.0)
    assert irreversible(cup, None, high) is not None
    assert irreversible(cube, None, high) is None
    assert irreversible(cup, None, low) is None
    assert irreversible(cup, None, kept) is None
