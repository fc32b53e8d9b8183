"""Executing a plan: what reaches the robot, and what the robot reports."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from kb.errors import BadInputError
from kb.sensing import Sensing
from sim.grasp_motion import CREEPING
from sim.hand import FULL_LIFT
from sim.quality import maximum_force
from tests.planning_fixtures import context, cup, percept, solid
from tools.context import ToolContext
from tools.execute_grasp import (
    CAUTIOUS_FORCE,
    GUARDED,
    MOST_OF_STANDOFF,
    ExecuteArgs,
    abort_force,
    creep,
    creep_speed,
    execute_grasp,
    trial_lift_cap,
)  # fmt: skip
from tools.open_world import open_perceiver, open_world
from tools.perceive import PerceiveArgs, perceive
from tools.plan_grasp import PlanArgs, plan_grasp
from tools.planning.lift_height import lift_height


class Recorder:
    """A robot that only writes down what it was told."""

    def __init__(self) -> None:
        self.calls: list[tuple[Any, dict[str, Any]]] = []

    def grasp(self, grasp: Any, **options: Any) -> Sensing:
        self.calls.append((grasp, options))
        return Sensing(phase="shake")


def test_the_robot_is_told_the_plan_and_everything_to_keep_clear_of() -> None:
    """The planned joints, one box per perceived object (the target's own too, for the way there), and the reflex."""
    seen = percept(cup("t", 0.5, 0.1), solid("n", "vase", 0.5, -0.1))
    plan = plan_grasp(PlanArgs(percept=seen, target="t"), context()).plan
    assert plan is not None
    robot = Recorder()
    sensing = execute_grasp(ExecuteArgs(plan=plan, percept=seen, target="t"), ToolContext(robot=robot))
    grasp, options = robot.calls[0]
    assert sensing.phase == "shake"
    assert grasp == plan.grasp
    assert options["joints"] == plan.joints
    assert [box.centre for box in options["obstacles"]] == [item.position for item in seen.objects]


def test_the_lift_passes_over_tall_neighbours() -> None:
    """Beside a 20-cm glass a low grasp is lifted higher than 17 cm; alone, or beside a block, by 17 cm."""
    glass, block = solid("n", "wine_glass", 0.5, -0.1), solid("n", "block", 0.5, -0.1)
    low = (0.5, 0.0, 0.004)
    assert lift_height(low, [glass]) > 0.18
    assert lift_height(low, [block]) == lift_height(low, []) == FULL_LIFT


@pytest.mark.parametrize(("category", "limit"), [("cube", 30.0), ("vase", 7.0), ("wine_glass", 3.5)])
def test_the_reflex_is_gentler_for_fragile_targets(category: str, limit: float) -> None:
    """The lower of 30 N and half of the damage force 70 (1 - frag), which is never below 5 N (benchmark section 3)."""
    assert abort_force(solid("t", category, 0.5, 0.0)) == pytest.approx(limit)


def test_the_last_stretch_is_slow_and_slower_onto_fragile_things() -> None:
    """It begins above the thing's upper side, or beside it, and is gone at half the speed where the thing bears little."""
    fragile, sturdy = cup("t", 0.5, 0.1), solid("t", "cube", 0.5, 0.1)
    for thing in (fragile, sturdy):
        plan = plan_grasp(PlanArgs(percept=percept(thing), target="t"), context()).plan
        assert plan is not None
        for approach in ((0.0, 0.0, -1.0), (1.0, 0.0, 0.0)):
            turned = plan.model_copy(update={"grasp": plan.grasp.model_copy(update={"approach": approach})})
            near = thing.top_z - plan.grasp.position[2] if approach[2] else max(thing.size[:2]) / 2
            longest = MOST_OF_STANDOFF * plan.grasp.standoff
            assert min(longest, near) < creep(turned, thing) <= longest
    assert creep_speed(fragile) == CREEPING < creep_speed(sturdy) == GUARDED


def test_in_noisy_pictures_the_hand_is_careful_with_everything() -> None:
    """With more than ordinary noise it creeps onto a cube as slowly as onto a cup, and longer, and stops at 5 N."""
    sturdy = solid("t", "cube", 0.5, 0.1)
    seen = percept(sturdy)
    plan = plan_grasp(PlanArgs(percept=seen, target="t"), context()).plan
    assert plan is not None
    assert 0.0 < creep(plan, sturdy, 1.5) <= creep(plan, sturdy, 3.0) < plan.grasp.standoff
    assert abort_force(sturdy, 2.0) == CAUTIOUS_FORCE < abort_force(sturdy)
    speeds = []
    for noise in (1.0, 2.0):
        robot = Recorder()
        noisy = seen.model_copy(update={"noise": noise})
        execute_grasp(ExecuteArgs(plan=plan, percept=noisy, target="t"), ToolContext(robot=robot))
        speeds.append(robot.calls[0][1]["creep_speed"])
    assert speeds == [GUARDED, pytest.approx(CREEPING / 2)]


def test_what_slipped_is_lifted_on_trial() -> None:
    """A known thing's weight is not in question, until it slips: then the grip may rise to what such things bear."""
    known = solid("t", "bottle", 0.5, 0.1)
    assert trial_lift_cap(known) is None
    most = trial_lift_cap(known, weigh=True)
    assert most is not None
    assert 0.0 < most < maximum_force(known.affordance.fragility)


def test_an_unknown_target_is_refused() -> None:
    """The choices are named."""
    seen = percept(cup("t", 0.5, 0.1))
    plan = plan_grasp(PlanArgs(percept=seen, target="t"), context()).plan
    assert plan is not None
    with pytest.raises(BadInputError, match="valid: t"):
        execute_grasp(ExecuteArgs(plan=plan, percept=seen, target="x"), ToolContext(robot=Recorder()))


@pytest.mark.parametrize("scene", ["single_cup", "single_bowl", "single_bottle", "screwdriver_side_grasp"])
def test_a_plan_on_true_poses_lifts_holds_and_survives_the_shake(scene: str) -> None:
    """Physics: rim, handle, side and tool grasps end with the object in the hand, as the observer sees it."""
    opened = open_world(scene, 10003)
    tools = ToolContext(
        robot=opened.robot, perceiver=open_perceiver("oracle", opened, None), rng=np.random.default_rng(0)
    )
    seen = perceive(PerceiveArgs(), tools)
    wanted = opened.placed.task.target if opened.placed.task else None
    target = next(item for item in seen.objects if opened.observer.meant(item.category, item.position) == wanted)
    plan = plan_grasp(PlanArgs(percept=seen, target=target.id), tools).plan
    assert plan is not None
    execute_grasp(ExecuteArgs(plan=plan, percept=seen, target=target.id), tools)
    assert opened.observer.judge(opened.motions, wanted).success
