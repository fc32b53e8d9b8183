"""The observer's verdict on motions whose outcome is known, in the real physics."""

from __future__ import annotations

import math
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from kb.grasp import Grasp
from kb.verdict import ObservedAttempt
from sim.catalogue import MODELS
from sim.observer import Observer
from sim.placed import Particles, PlacedObject, PlacedScene, RequiredConstraint, Task
from sim.robot import Robot
from sim.world import World


def thing(model: str, name: str, x: float, y: float, z: float = 0.0, **given: Any) -> PlacedObject:
    """An object of nominal size at a place."""
    given = {"size_scale": 1.0, "friction": 0.5, **given}
    return MODELS[model].draw(np.random.default_rng(1), id=name, position=(x, y, z), **given)


def grasp(x: float, y: float, z: float, *, yaw: float = 0.0, opening: float = 0.07, force: float = 10.0) -> Grasp:
    """A grasp straight from above."""
    return Grasp(position=(x, y, z), approach=(0, 0, -1), yaw=yaw, aperture=opening, force=force, type="power")


def perform(scene: PlacedScene, motion: Grasp, meant: str | None) -> tuple[Observer, Robot, ObservedAttempt]:
    """Does one grasp and judges it."""
    world = World(scene)
    robot, observer = Robot(world), Observer(world)
    robot.grasp(motion)
    return observer, robot, observer.judge(world.attempt, meant)


def scene(*objects: PlacedObject, task: Task | None = None, **more: Any) -> PlacedScene:
    return PlacedScene(name="test", seed=0, objects=objects, task=task, **more)


CUBE = thing("wood_cube", "cube", 0.5, 0.05, mass=0.09)
HEAVY = thing("wood_cube", "cube", 0.5, 0.05, mass=0.6)
BALL = thing("tennis_ball", "ball", 0.5, -0.1)
PHONE = thing("smartphone", "phone", 0.5, 0.05)
VASE = thing("glass_vase", "vase", 0.5, 0.13)


@cache
def good() -> tuple[Observer, Robot, ObservedAttempt]:
    """A centred grasp of the cube, as it should be."""
    return perform(scene(CUBE, VASE), grasp(0.5, 0.05, 0.025), "cube")


def test_a_good_grasp_succeeds_by_every_measure() -> None:
    """A centred grasp raises the cube, holds it for two seconds, survives the shake, on its region, and harms nothing."""
    _, _, seen = good()
    verdict = seen.verdict
    assert seen.success
    assert seen.failure is None
    assert seen.lift_success
    assert seen.affordance_correct
    assert seen.strict
    assert verdict.lifted_m >= 0.10
    assert verdict.held_s >= 4.0
    assert verdict.slip_m < 0.01
    assert verdict.slip_m <= verdict.slip_lift_m + verdict.slip_hold_m + 1e-4
    assert verdict.contact
    assert verdict.aperture_m == pytest.approx(0.05, abs=0.001)
    assert verdict.peak_force_n == pytest.approx(10.0, abs=2.0)
    assert verdict.damage == verdict.disturbed == ()
    assert verdict.correct_object


def test_the_peak_force_is_the_commanded_grip_force() -> None:
    """The 10-ms mean of a pad's force in a firm grip is the force that was commanded, within the weight it carries."""
    observer, _, _ = good()
    track = observer._motion(observer.attempts[0])["cube"].track
    held = track.rows("hold")
    assert float(track.pads[held, 0].max()) == pytest.approx(10.0, rel=0.05)


@pytest.mark.parametrize(
    ("objects", "motion", "meant", "failure"),
    [
        pytest.param((CUBE,), grasp(0.5, 0.17, 0.025), "cube", "POSITION_ERROR", id="closed beside it"),
        pytest.param((CUBE,), grasp(0.5, 0.05, 0.085), "cube", "POSITION_ERROR", id="closed above it"),
        pytest.param((CUBE,), grasp(0.525, 0.05, 0.025), "cube", "POSITION_ERROR", id="finger on top"),
        pytest.param((CUBE,), grasp(0.5, 0.05, 0.025, opening=0.045), "cube", "WIDTH_MISMATCH", id="too narrow"),
        pytest.param(
            (CUBE,), grasp(0.5, 0.05, 0.025, yaw=0.785, opening=0.06), "cube", "ORIENTATION", id="across the corners"
        ),
        pytest.param((HEAVY,), grasp(0.5, 0.05, 0.025, force=3.0), "cube", "SLIP", id="too weak"),
        pytest.param((CUBE, BALL), grasp(0.5, -0.1, 0.03, opening=0.078), "cube", "WRONG_OBJECT", id="took the ball"),
        pytest.param((CUBE, VASE), grasp(0.5, 0.05, 0.025, yaw=math.pi / 2), "cube", "COLLISION", id="into the vase"),
        pytest.param((PHONE,), grasp(0.5, 0.05, -0.004, opening=0.08), "phone", "APPROACH_ANGLE", id="into the table"),
        pytest.param((CUBE,), grasp(0.95, 0.35, 0.025), "cube", "UNREACHABLE_POSE", id="out of reach"),
    ],
)
def test_the_first_anomalous_event_names_the_failure(
    objects: tuple[PlacedObject, ...], motion: Grasp, meant: str, failure: str
) -> None:
    """Each provoked mistake gets its own label (physics.md: by the first anomalous event in time)."""
    _, _, seen = perform(scene(*objects), motion, meant)
    assert not seen.success
    assert seen.failure == failure


def test_squeezing_harder_than_it_bears_is_damage() -> None:
    """A grip force above F_dmg damages; by the material it is called force damage or deformation."""
    for material, failure in (("plastic", "FORCE_DAMAGE"), ("organic", "DEFORMATION")):
        brittle = thing("wood_cube", "cube", 0.5, 0.05, fragility=0.9)
        affordance = brittle.affordance.model_copy(update={"material": material})
        fragile = PlacedObject(**{**brittle.__dict__, "affordance": affordance})
        _, _, seen = perform(scene(fragile), grasp(0.5, 0.05, 0.025, force=30.0), "cube")
        assert seen.verdict.damage == ("cube",)
        assert seen.verdict.peak_force_n > fragile.damage_force
        assert seen.failure == failure


def test_a_release_in_the_air_is_a_drop_that_breaks_a_cup_but_not_a_block() -> None:
    """A fall of more than 5 cm damages what has a fragility of at least 0.3, and nothing tougher."""
    for fragility, broken in ((0.3, True), (0.1, False)):
        world = World(scene(thing("wood_cube", "cube", 0.5, 0.05, fragility=fragility)))
        robot, observer = Robot(world), Observer(world)
        robot.grasp(grasp(0.5, 0.05, 0.025))
        world.attempt += 1
        controls = np.tile(world.data.ctrl, (1200, 1))
        controls[:, world.index.gripper_control] = 0.08
        world.run(controls, "carry")
        seen = observer.judge(world.attempt, "cube")
        drops = [d for d in observer._trial().damaged if d == "cube"]
        assert bool(drops) == broken
        assert not seen.success or not broken


def test_a_grasp_of_something_that_is_not_there_is_judged() -> None:
    """Where nothing in the scene was meant, whatever the hand took is the wrong object."""
    _, _, seen = perform(scene(CUBE), grasp(0.5, 0.05, 0.025), None)
    assert seen.failure == "WRONG_OBJECT"
    assert not seen.verdict.correct_object


def test_a_gripped_handle_is_affordance_correct_and_a_gripped_wall_is_not() -> None:
    """The pads' place on the object decides: the cup's annotated region is its handle."""
    cup = thing("ceramic_cup", "cup", 0.5, 0.05)
    on_wall = grasp(0.5, 0.05 + 0.038, 0.078, yaw=math.pi / 2, opening=0.04)
    on_handle = grasp(0.56, 0.05, 0.062, yaw=math.pi / 2, opening=0.04)
    _, _, wall = perform(scene(cup), on_wall, "cup")
    _, _, handle = perform(scene(cup), on_handle, "cup")
    assert wall.success
    assert not wall.affordance_correct
    assert not wall.strict
    assert handle.verdict.contact
    assert handle.affordance_correct


def test_state_survives_as_bytes() -> None:
    """What was recorded is restored from its bytes to the same verdict, and stays small."""
    observer, _, seen = good()
    blob = observer.state()
    other = Observer(World(observer.placed))
    other.load(blob)
    assert other.judge(other.attempts[0], "cube") == seen
    assert other.state() == blob
    assert len(blob) < 200_000


def test_constraints_are_measured_and_never_vacuous() -> None:
    """A protected neighbour counts as spared only when something was attempted, and not when it was hit."""
    task = Task(target="cube", instructions=(), required=(RequiredConstraint("collision", "vase"),))
    world = World(scene(CUBE, VASE, task=task))
    robot, observer = Robot(world), Observer(world)
    (before,) = observer.constraints()
    assert (before.required, before.satisfied) == (True, False)
    robot.grasp(grasp(0.5, 0.05, 0.025))
    (spared,) = observer.constraints([("collision", "vase")])
    assert (spared.required, spared.inferred, spared.satisfied) == (True, True, True)
    assert spared.measured["force_n"] < 2.0
    _, robot, hit = perform(scene(CUBE, VASE, task=task), grasp(0.5, 0.05, 0.025, yaw=math.pi / 2), "cube")
    assert not hit.success
    (struck,) = Observer.constraints(robot.world.recorders[0])  # type: ignore[arg-type]
    assert not struck.satisfied
    assert struck.measured["force_n"] > 2.0


def test_contents_are_counted() -> None:
    """All contents of a cup that is lifted upright stay in it; spilling shows as a share."""
    cup = thing("ceramic_cup", "cup", 0.5, 0.0, state="filled")
    places = [(0.5 + dx, dy, 0.02 + 0.021 * k) for k in range(2) for dx in (-0.014, 0.014) for dy in (-0.014, 0.014)]
    balls = Particles("cup", radius=0.01, mass=0.004, positions=np.array(places))
    task = Task(target="cup", instructions=(), required=(RequiredConstraint("content", "cup"),))
    placed = scene(cup, task=task, particles=(balls,))
    observer, _, seen = perform(placed, grasp(0.5, 0.038, 0.078, yaw=math.pi / 2, opening=0.04, force=15.0), "cup")
    (kept,) = observer.constraints()
    assert seen.success
    assert kept.satisfied
    assert kept.measured["spilled"] == 0.0


def test_the_supported_object_must_be_removed_first() -> None:
    """Support is satisfied when the upper object was taken off and set down before the lower one moved."""
    plate = thing("box", "box", 0.5, 0.05)
    block = thing("toy_block", "block", 0.5, 0.05, plate.size[2])
    task = Task(target="box", instructions=(), required=(RequiredConstraint("support", "block"),))
    top = plate.size[2] + block.size[2] / 2
    world = World(scene(plate, block, task=task))
    robot, observer = Robot(world), Observer(world)
    robot.grasp(grasp(0.5, 0.05, top, opening=0.06))
    assert observer.judge(world.attempt, "block").success
    assert not observer.constraints()[0].satisfied, "still in the hand"
    robot.place((0.45, -0.2, block.size[2] / 2 + 0.005))
    aside = observer.judge(world.attempt, "block", SimpleNamespace(kind="aside"))
    assert aside.success
    assert aside.verdict.placed
    assert not observer.judge(world.attempt, "block", SimpleNamespace(kind="side", side="left")).verdict.placed
    (record,) = observer.constraints()
    assert record.satisfied
    assert record.measured["supporter"] == "box"


def test_a_perceived_object_is_matched_to_the_nearest_true_one() -> None:
    """`meant` takes the nearest object, prefers the perceived category, and gives up beyond 10 cm."""
    observer, _, _ = good()
    number = observer.attempts[0]
    assert observer.meant("cube", (0.5, 0.06, 0.03), number) == "cube"
    assert observer.meant("vase", (0.5, 0.10, 0.05), number) == "vase"
    assert observer.meant("cube", (0.8, -0.3, 0.03), number) is None


def test_tool_grasp_conditions() -> None:
    """A screwdriver gripped from straight above is not a tool's side grasp: its approach must be 30 to 60 degrees off."""
    driver = thing("screwdriver", "driver", 0.5, 0.0)
    task = Task(target="driver", instructions=(), side_grasp_of="driver")
    straight = grasp(0.45, 0.0, 0.015, yaw=math.pi / 2, opening=0.05)
    _, _, above = perform(scene(driver, task=task), straight, "driver")
    _, _, free = perform(scene(driver), straight, "driver")
    assert free.success
    assert not above.success
    assert above.failure == "CONSTRAINT_VIOLATION"
    sloped = (math.sin(0.75), 0.0, -math.cos(0.75))
    tilted = straight.model_copy(update={"approach": sloped, "position": (0.45, 0.0, 0.02)})
    _, _, side = perform(scene(driver, task=task), tilted, "driver")
    assert side.failure != "CONSTRAINT_VIOLATION"


def test_what_an_earlier_task_broke_is_not_held_against_this_one() -> None:
    """Damage lasts within a task; a task that began after it is judged by itself."""
    brittle = thing("wood_cube", "cube", 0.5, 0.05, fragility=0.9)
    world = World(scene(brittle, thing("toy_block", "block", 0.5, -0.2)))
    robot, observer = Robot(world), Observer(world)
    robot.grasp(grasp(0.5, 0.05, 0.025, force=30.0), shake=False)
    robot.release_and_home()
    assert "cube" in observer.judge(world.attempt - 1, "cube").verdict.damage
    robot.grasp(grasp(0.5, -0.2, 0.02))
    assert not observer.judge(world.attempt, "block").success
    assert observer.judge(world.attempt, "block", since=world.attempt).success


def test_carrying_a_fragile_thing_is_no_damage() -> None:
    """The impulse rule protects neighbours: what the hand carries home is touched on purpose."""
    fragile = thing("wood_cube", "cube", 0.5, 0.05, fragility=0.9)
    world = World(scene(fragile))
    robot, observer = Robot(world), Observer(world)
    robot.grasp(grasp(0.5, 0.05, 0.025, force=3.0))
    picked = world.attempt
    assert observer.judge(picked, "cube").success
    robot.go_home()
    assert observer.damaged() == ()
    assert observer.judge(picked, "cube").success


def test_letting_go_does_not_squeeze() -> None:
    """Opening the hand never presses harder than the grip did: a fragile thing survives being put down."""
    fragile = thing("wood_cube", "cube", 0.5, 0.05, fragility=0.9)
    world = World(scene(fragile))
    robot, observer = Robot(world), Observer(world)
    robot.grasp(grasp(0.5, 0.05, 0.025, force=3.0))
    robot.place((0.5, -0.1, 0.027))
    track = observer._motion(world.attempt)["cube"].track
    assert float(track.pads[track.rows("release")].max()) < 4.0
    assert observer.damaged() == ()


def test_what_was_meant_by_a_motion_that_was_never_begun() -> None:
    """An attempt without a way to it leaves no record; what it meant is found where things stood, not in the hand now."""
    world = World(scene(thing("wood_cube", "cube", 0.5, 0.05)))
    robot, observer = Robot(world), Observer(world)
    robot.grasp(grasp(1.5, 0.05, 0.025))
    never = world.attempt
    robot.grasp(grasp(0.5, 0.05, 0.025))
    assert never not in observer.attempts
    assert observer.meant("cube", (0.5, 0.05, 0.025), never) == "cube"
