"""The analytic evaluator: outcomes from the seven factors, deterministic, told to the observer alone."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from kb.grasp import Grasp
from kb.sensing import Sensing
from kb.verdict import ObservedAttempt
from sim.analytic import AnalyticRobot
from sim.analytic_observer import AnalyticObserver
from sim.analytic_outcome import _clearances, cloud
from sim.catalogue import MODELS
from sim.placed import PlacedObject, PlacedScene, RequiredConstraint, Task
from sim.swept_hand import swept_distances
from sim.world import World


def thing(model: str, name: str, x: float, y: float, z: float = 0.0, **given: Any) -> PlacedObject:
    given = {"size_scale": 1.0, "friction": 0.5, **given}
    return MODELS[model].draw(np.random.default_rng(1), id=name, position=(x, y, z), **given)


def grasp(x: float, y: float, z: float, **changes: Any) -> Grasp:
    base = {"yaw": 0.0, "aperture": 0.06, "force": 10.0, "type": "power", "approach": (0, 0, -1), **changes}
    return Grasp(position=(x, y, z), **base)


def opened(*objects: PlacedObject, task: Task | None = None) -> tuple[AnalyticRobot, AnalyticObserver, World]:
    world = World(PlacedScene(name="test", seed=0, objects=objects, task=task))
    return AnalyticRobot(world), AnalyticObserver(world), world


def perform(motion: Grasp, meant: str, *objects: PlacedObject) -> tuple[Sensing, ObservedAttempt]:
    robot, observer, world = opened(*objects)
    sensing = robot.grasp(motion)
    return sensing, observer.judge(world.attempt, meant)


CUBE = thing("wood_cube", "cube", 0.5, 0.05, mass=0.09)
BALL = thing("tennis_ball", "ball", 0.5, -0.15)
NEAR = thing("wood_cube", "near", 0.5, 0.105)


@pytest.mark.parametrize(
    ("objects", "motion", "failure"),
    [
        ((CUBE,), grasp(0.5, 0.05, 0.025), None),
        ((CUBE,), grasp(0.5, 0.12, 0.025), "POSITION_ERROR"),
        ((CUBE,), grasp(0.5, 0.05, 0.025, aperture=0.045), "WIDTH_MISMATCH"),
        ((CUBE,), grasp(0.95, 0.38, 0.025), "UNREACHABLE_POSE"),
        ((CUBE,), grasp(0.5, 0.05, 0.002), "APPROACH_ANGLE"),
        ((CUBE, NEAR), grasp(0.5, 0.05, 0.025, yaw=math.pi / 2, aperture=0.065), "COLLISION"),
        ((CUBE, BALL), grasp(0.5, -0.15, 0.033, aperture=0.075), "WRONG_OBJECT"),
        ((thing("wood_cube", "cube", 0.5, 0.05, mass=0.9),), grasp(0.5, 0.05, 0.025), "SLIP"),
        ((thing("wood_cube", "cube", 0.5, 0.05, mass=1.5),), grasp(0.5, 0.05, 0.025), "DROP"),
        ((thing("wood_cube", "cube", 0.5, 0.05, fragility=0.99),), grasp(0.5, 0.05, 0.025), "FORCE_DAMAGE"),
        ((thing("smartphone", "cube", 0.5, 0.05),), grasp(0.5, 0.05, 0.01, aperture=0.08), "ORIENTATION"),
    ],
)
def test_outcomes_follow_the_decision_list(
    objects: tuple[PlacedObject, ...], motion: Grasp, failure: str | None
) -> None:
    """The outcome is y = 1 exactly when nothing of ledger G17 applies, and the first that applies is the label."""
    _, seen = perform(motion, "cube", *objects)
    assert seen.failure == failure
    assert seen.success == (failure is None)


def test_what_is_felt_fits_the_outcome() -> None:
    """A success is felt as a load between open fingers, a miss as closed ones, a collision as a force."""
    success, _ = perform(grasp(0.5, 0.05, 0.025), "cube", CUBE)
    assert success.load_end == pytest.approx(0.09)
    assert success.aperture_end == pytest.approx(0.05)
    missed, _ = perform(grasp(0.5, 0.12, 0.025), "cube", CUBE)
    assert missed.aperture_end == missed.load_end == 0.0
    blocked, _ = perform(grasp(0.5, 0.05, 0.025, yaw=math.pi / 2), "cube", CUBE, NEAR)
    assert blocked.stopped_by == "force"
    assert blocked.lift_height == 0.0


def test_the_same_grasp_has_the_same_outcome() -> None:
    """No dice: two worlds of the same scene give identical sensing and verdicts."""
    assert perform(grasp(0.5, 0.055, 0.03), "cube", CUBE) == perform(grasp(0.5, 0.055, 0.03), "cube", CUBE)


def test_pick_and_place_moves_the_object_there() -> None:
    """A held thing follows the hand, and after placing stands at the place, judged by where it stands."""
    robot, observer, world = opened(CUBE)
    robot.grasp(grasp(0.5, 0.05, 0.025))
    assert robot.holding
    assert observer.poses()["cube"][2] > 0.10
    blob, state = world.snapshot(), observer.state()
    robot.place((0.45, -0.2, 0.03))
    assert not robot.holding
    assert observer.poses()["cube"][:3] == pytest.approx([0.45, -0.2, 0.0], abs=2e-3)
    right = SimpleNamespace(kind="side", side="right")
    assert observer.judge(world.attempt, "cube", right).success
    assert not observer.judge(world.attempt, "cube", SimpleNamespace(kind="side", side="left")).success
    world.restore(blob)
    observer.load(state)
    assert robot.holding
    assert observer.attempts == (1,)


def test_required_constraints_are_measured() -> None:
    """Support asks for the upper object to be placed first; a neighbour that the hand sweeps is not spared."""
    box = thing("box", "box", 0.5, 0.05)
    block = thing("toy_block", "block", 0.5, 0.05, box.size[2])
    task = Task(target="box", instructions=(), required=(RequiredConstraint("support", "block"),))
    robot, observer, _ = opened(box, block, task=task)
    assert not observer.constraints()[0].satisfied
    robot.grasp(grasp(0.5, 0.05, box.size[2] + 0.02, aperture=0.05))
    robot.place((0.45, -0.25, 0.025))
    assert observer.constraints()[0].satisfied
    task = Task(target="cube", instructions=(), required=(RequiredConstraint("collision", "near"),))
    robot, observer, _ = opened(CUBE, NEAR, task=task)
    robot.grasp(grasp(0.5, 0.05, 0.025, yaw=math.pi / 2))
    record = observer.constraints()[0]
    assert not record.satisfied
    assert record.measured["clearance_mm"] < 0


def test_pieces_that_are_left_out_change_no_clearance() -> None:
    """The clearance from each neighbour is the least distance of all points of it."""
    rng = np.random.default_rng(5)
    _, _, world = opened(CUBE, BALL, thing("wine_glass", "glass", 0.62, 0.0), thing("ceramic_bowl", "bowl", 0.42, 0.2))
    for _ in range(30):
        x, y, z = rng.uniform([0.35, -0.2, 0.02], [0.65, 0.25, 0.15]).tolist()
        motion = grasp(x, y, z, yaw=float(rng.uniform(-3, 3)), approach=(math.sin(0.5), 0.0, -math.cos(0.5)))
        found = _clearances(world, list(world.placed.objects), motion)
        for other in world.placed.objects:
            assert found[other.id] == pytest.approx(swept_distances(motion, cloud(world, other)).min(), abs=1e-12)
