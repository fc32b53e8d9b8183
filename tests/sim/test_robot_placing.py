"""What the robot does with a thing in its hand: it sets down gently, hands over, and finds its way back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sim import lower_motion
from sim.build_model import TIMESTEP
from sim.carry_path import way_down
from sim.controller import along, follow, part
from sim.kinematics import forward
from sim.motion_run import Check, MotionRun
from sim.panda import READY
from sim.place_motion import go_back
from sim.robot import Robot
from sim.stop import StopSwitch
from sim.world import World
from tests.robot_fixtures import Keeper, from_above, place_of


def test_placing_is_gentle_and_ends_at_home(cube, scene) -> None:
    """The object stands where it was to go, 3 mm at most off, was set down with less than 20 N, and the arm is home."""
    world = World(scene(cube(x=0.5, y=0.1)))
    robot = Robot(world)
    robot.grasp(from_above(0.5, 0.1, 0.025), shake=False)
    keeper = Keeper(world)
    felt = robot.place((0.55, -0.15, 0.027))
    assert felt.stopped_by is None
    assert place_of(world, "cube") == pytest.approx((0.55, -0.15, 0.0), abs=3e-3)
    rows = np.concatenate([record.sensordata for record in keeper.kept])
    force = np.linalg.norm(rows[:, world.index.sensors["truth/cube/table"]][:, 1:4], axis=1)
    assert np.convolve(force, np.full(5, 0.2), "valid").max() < 20.0
    assert not robot.holding
    assert robot.joints == pytest.approx(READY, abs=5e-3)
    assert keeper.phases() == ["carry", "set_down", "release", "retreat", "home"]


def test_a_swing_in_the_hand_is_no_ground(cube, scene, monkeypatch) -> None:
    """What is felt once high above the table, but no longer at rest, does not end the way down: nothing is dropped."""
    world = World(scene(cube(x=0.5, y=0.1)))
    robot = Robot(world)
    robot.grasp(from_above(0.5, 0.1, 0.025), shake=False)
    felt, really = list[float](), lower_motion.touch_check

    def touched_first(motion: MotionRun, limit: float = lower_motion.TOUCH) -> Check:
        felt.append(limit)
        return really(motion, limit) if len(felt) > 1 else lambda: "contact"

    keeper = Keeper(world)
    monkeypatch.setattr(lower_motion, "touch_check", touched_first)
    robot.place((0.55, -0.15, 0.027))
    assert len(felt) > 1
    assert place_of(world, "cube") == pytest.approx((0.55, -0.15, 0.0), abs=3e-3)
    rows = np.concatenate([record.sensordata for record in keeper.kept])
    force = np.linalg.norm(rows[:, world.index.sensors["truth/cube/table"]][:, 1:4], axis=1)
    assert np.convolve(force, np.full(5, 0.2), "valid").max() < 20.0


def test_what_may_break_is_carried_more_slowly(cube, scene) -> None:
    """At 0.6 of the speed the way to above the place takes at least twice as long: what jerks grows with the square."""
    seconds: list[float] = []
    for speed in (1.0, 0.6):
        world = World(scene(cube(x=0.5, y=0.1)))
        robot = Robot(world)
        robot.grasp(from_above(0.5, 0.1, 0.025), shake=False)
        keeper = Keeper(world)
        robot.place((0.55, -0.15, 0.027), speed=speed)
        seconds.append(sum(len(record) for record in keeper.kept if record.phase == "carry") * TIMESTEP)
    assert seconds[1] > 2.0 * seconds[0]


def test_release_puts_the_object_back_where_it_was(cube, scene) -> None:
    """After a lift, `release_and_home` lowers the object first: it ends within 3 mm of its start, never dropped."""
    world = World(scene(cube(x=0.5, y=0.1)))
    robot = Robot(world)
    robot.grasp(from_above(0.5, 0.1, 0.025), shake=False)
    felt = robot.release_and_home()
    assert felt.stopped_by is None
    assert place_of(world, "cube") == pytest.approx((0.5, 0.1, 0.0), abs=3e-3)
    assert robot.joints == pytest.approx(READY, abs=5e-3)
    assert robot.aperture > 0.06


def test_the_bin_is_avoided_without_being_seen(cube, scene) -> None:
    """The set-up's bin stands in the way of a carry; the arm goes over its walls and drops nothing."""
    corners = ((0.30, 0.425, -0.02), (0.60, 0.675, 0.08))
    world = World(replace(scene(cube(x=0.5, y=0.2)), bin=corners))
    robot = Robot(world)
    assert robot.bin == corners
    robot.grasp(from_above(0.5, 0.2, 0.025), shake=False)
    felt = robot.place((0.45, 0.55, 0.06))
    assert felt.stopped_by is None
    x, y, _ = place_of(world, "cube")
    assert 0.30 < x < 0.60
    assert 0.425 < y < 0.675


def test_a_handover_holds_the_object_out_and_keeps_it(cube, scene) -> None:
    """Held out in front and in the air, the object stays in the hand; releasing then sets it on the table upright."""
    world = World(scene(cube(x=0.5, y=0.1)))
    robot = Robot(world)
    robot.grasp(from_above(0.5, 0.1, 0.025), shake=False)
    felt = robot.handover()
    assert felt.stopped_by is None
    assert felt.load_min == pytest.approx(0.09, abs=3e-3)
    assert robot.holding
    assert place_of(world, "cube")[2] > 0.35
    robot.release_and_home()
    assert abs(place_of(world, "cube")[2]) < 1e-3


def test_an_arm_that_leans_on_something_gets_away(scene, cube) -> None:
    """Told to stay 0.05 rad beyond where it is held up, the arm would feel a collision at once; it goes home all the same."""
    world = World(scene(cube(x=0.5, y=-0.2)))
    motion = MotionRun(world, StopSwitch())
    beyond = motion.commanded
    beyond[3] += 0.05
    world.run(follow(beyond[None], 0.04), "transit")
    assert float(np.abs(beyond - world.read("robot/joint_position")).max()) > 0.02
    felt = Robot(world).go_home()
    assert felt.stopped_by is None
    assert world.read("robot/joint_position") == pytest.approx(READY, abs=5e-3)


def test_a_hand_goes_back_the_way_it_came(scene, cube) -> None:
    """From below a set-down the arm gets up and back to where the way to it began, to within 1 mrad a joint."""
    world = World(scene(cube(x=0.5, y=-0.2)))
    motion = MotionRun(world, StopSwitch())
    goal = forward(READY)
    goal[:3, 3] = 0.5, 0.2, 0.08
    way = way_down(goal, READY, (), None)
    assert way is not None
    motion.run_guarded(way.transit.samples(TIMESTEP), 0.04, "carry", 30.0)
    motion.run(follow(along(part(way.path, 0.0, 0.8), 1.0), 0.04, motion.commanded), "set_down")
    go_back(motion, way)
    assert motion.commanded == pytest.approx(READY, abs=1e-3)
    assert motion.joints == pytest.approx(READY, abs=0.02)
