"""What the robot does and feels: it lifts what is graspable, weighs it, stops when touched or told, and sets down gently."""

from __future__ import annotations

import math
import threading
import time

import numpy as np
import pytest

from kb.errors import BadInputError
from sim.hand import FULL_LIFT
from sim.motion import Obstacle
from sim.robot import Robot
from sim.stop import StopSwitch
from sim.world import World
from tests.robot_fixtures import Keeper, box_of, from_above, from_aside, place_of


@pytest.mark.parametrize("kind", ["cube", "can", "ball"])
def test_random_poses_are_lifted_held_and_shaken(kind: str, cube, can, ball, scene) -> None:
    """Cube and ball from above and a can from the side succeed in every one of 6 random poses."""
    rng = np.random.default_rng(11)
    for _ in range(6):
        x, y = rng.uniform(0.42, 0.65), rng.uniform(-0.22, 0.22)
        turn = rng.uniform(-3, 3)
        if kind == "cube":
            thing = cube(x=x, y=y, quaternion=(math.cos(turn / 2), 0.0, 0.0, math.sin(turn / 2)))
            grasp = from_above(x, y, 0.025, turn)
        elif kind == "ball":
            thing, grasp = ball(x=x, y=y), from_above(x, y, 0.0325, turn)
        else:
            thing, grasp = can(x=x, y=y), from_aside(x, y, 0.1, math.atan2(y, x) + math.copysign(0.35, turn))
        world = World(scene(thing))
        robot = Robot(world)
        felt = robot.grasp(grasp, obstacles=[box_of(thing)])
        assert felt.stopped_by is None
        assert robot.holding
        assert place_of(world, kind)[2] > 0.12
        assert felt.load_end == pytest.approx(thing.mass, abs=2e-3)
        assert felt.held_s > 4.0
        assert felt.tracking_error < 4e-3


def test_the_sensing_tells_the_width_force_load_and_phases(cube, scene) -> None:
    """The fingers stop at the object's width with the commanded force; the load is its mass; phases come in order."""
    world = World(scene(cube(x=0.5, y=0.1)))
    keeper, robot = Keeper(world), Robot(world)
    felt = robot.grasp(from_above(0.5, 0.1, 0.025))
    assert felt.aperture_start == pytest.approx(0.07, abs=1e-3)
    assert felt.aperture_closed == pytest.approx(0.05, abs=1e-3)
    assert felt.motor_force_closed == pytest.approx(15.0, rel=0.02)
    assert felt.load_lifted == pytest.approx(0.09, abs=2e-3)
    assert felt.lift_height == pytest.approx(FULL_LIFT, abs=2e-3)
    assert felt.approach_force < 0.5
    assert felt.load_torque < 0.01
    assert keeper.phases() == ["transit", "approach", "close", "lift", "hold", "shake"]
    assert felt.sim_time == pytest.approx(sum(len(record) for record in keeper.kept) * 0.002)
    pads = keeper.kept[-1].sensordata[:, world.index.sensors["truth/cube/pad_left"]][:, 1:4]
    assert np.linalg.norm(pads, axis=1).mean() == pytest.approx(15.0, rel=0.1)


def test_the_shake_rocks_the_hand_by_fifteen_degrees(cube, scene) -> None:
    """During the shake the approach tilts by 15 degrees both ways and the tool point stays within 5 mm."""
    world = World(scene(cube(x=0.5, y=0.1)))
    keeper, robot = Keeper(world), Robot(world)
    robot.grasp(from_above(0.5, 0.1, 0.025))
    rows = np.concatenate([record.sensordata for record in keeper.kept if record.phase == "shake"])
    quaternion = rows[:, world.index.sensors["robot/tcp_quaternion"]]
    up = 1.0 - 2.0 * (quaternion[:, 1] ** 2 + quaternion[:, 2] ** 2)
    assert np.degrees(np.arccos(-up)).max() == pytest.approx(15.0, abs=1.0)
    position = rows[:, world.index.sensors["robot/tcp_position"]]
    assert np.abs(position - position[0]).max() < 5e-3


def test_an_empty_grasp_is_felt(cube, scene) -> None:
    """Closing beside the object ends with closed fingers, no load, and without the full lift."""
    world = World(scene(cube(x=0.5, y=0.1)))
    robot = Robot(world)
    felt = robot.grasp(from_above(0.5, -0.1, 0.025))
    assert felt.aperture_closed < 1e-3
    assert abs(felt.load_lifted) < 2e-3
    assert not robot.holding
    assert felt.lift_height < 0.03
    assert place_of(world, "cube") == pytest.approx((0.5, 0.1, 0.0), abs=1e-4)


def test_too_little_force_slips_and_is_felt(cube, scene) -> None:
    """Coulomb: 2 x 0.6 x 3 N cannot lift 1 kg; the load stays on the table and the robot weighs almost nothing."""
    world = World(scene(cube(x=0.5, y=0.1, mass=1.0)))
    felt = Robot(world).grasp(from_above(0.5, 0.1, 0.025, force=3.0), shake=False)
    assert place_of(world, "cube")[2] < 0.02
    assert felt.load_end < 0.1


def test_the_reflex_stops_an_approach_into_an_obstacle(cube, scene) -> None:
    """A fixed block under a finger triggers the reflex: the arm stops, backs off, and reports the force."""
    world = World(scene(cube(x=0.5, y=0.1), cube("post", x=0.54, y=0.1, half=0.012, z=0.06, fixed=True)))
    keeper, robot = Keeper(world), Robot(world)
    felt = robot.grasp(from_above(0.5, 0.1, 0.025, aperture=0.08))
    assert felt.stopped_by == "force"
    assert felt.phase == "approach"
    assert felt.abort_force >= 30.0
    assert felt.abort_direction is not None
    assert felt.abort_direction[2] > 0.5
    assert keeper.phases() == ["transit", "approach", "retreat"]
    pushed = np.concatenate([record.sensordata for record in keeper.kept if record.phase == "retreat"])
    sensed = pushed[-10:, world.index.sensors["robot/tcp_position"]][:, 2]
    assert sensed.min() > 0.1


@pytest.mark.parametrize(("creep", "speed", "most"), [(0.0, 0.0, 400.0), (0.06, 0.04, 50.0)])
def test_the_withdrawal_never_presses_once_more(creep: float, speed: float, most: float, cube, scene) -> None:
    """A finger that lands on a cube: what follows the reflex presses less than the landing; a guarded one is gentle."""
    world = World(scene(cube(x=0.5, y=0.1)))
    keeper, robot = Keeper(world), Robot(world)
    felt = robot.grasp(from_above(0.5, 0.145, 0.025, math.pi / 2, aperture=0.08), creep=creep, creep_speed=speed or 1.0)
    assert felt.stopped_by == "force"
    peaks = {"landing": 0.0, "retreat": 0.0}
    for record in keeper.kept:
        rows = record.sensordata[:, world.index.sensors["truth/cube/table"]][:, 1:4]
        part = "retreat" if record.phase == "retreat" else "landing"
        ten_ms = np.convolve(np.linalg.norm(rows, axis=1), np.ones(5) / 5, "valid")
        peaks[part] = max(peaks[part], float(ten_ms.max()))
    assert peaks["retreat"] < 31.0
    assert 30.0 < peaks["landing"] < most


def test_a_lower_limit_stops_earlier(cube, scene) -> None:
    """With a limit of 8 N the reflex acts at a smaller force than with 30 N."""
    forces = []
    for limit in (8.0, 30.0):
        world = World(scene(cube("post", x=0.54, y=0.1, half=0.012, z=0.06, fixed=True)))
        felt = Robot(world).grasp(from_above(0.5, 0.1, 0.025, aperture=0.08, speed=0.3), force_limit=limit)
        assert felt.stopped_by == "force"
        forces.append(felt.abort_force)
    assert 8.0 <= forces[0] < forces[1]


def test_out_of_reach_and_walled_in_are_reported_without_motion(cube, scene) -> None:
    """An unreachable grasp and one without a free path move nothing and say so."""
    world = World(scene(cube(x=0.5, y=0.1)))
    robot, begun = Robot(world), world.time
    far = robot.grasp(from_above(1.2, 0.0, 0.025))
    assert (far.reachable, far.stopped_by, far.phase) == (False, "unreachable", "plan")
    assert far.ik_residual > 0.1
    cage = [Obstacle((0.5, s * 0.16 + 0.1, 0.5), 0.0, (0.4, 0.02, 0.5)) for s in (1, -1)]
    cage += [Obstacle((x, 0.1, 0.62), 0.0, (0.02, 0.3, 0.6)) for x in (0.40, 0.62)]
    walled = robot.grasp(from_above(0.5, 0.1, 0.025), obstacles=cage)
    assert (walled.reachable, walled.stopped_by) == (True, "path")
    assert world.time == begun


def test_a_stop_ends_the_motion_and_latches(cube, scene) -> None:
    """Pressed in the air, the arm holds, the gripper keeps its force, and nothing moves until the switch is released."""
    world = World(scene(cube(x=0.5, y=0.1)))
    stop = StopSwitch()
    robot = Robot(world, stop=stop)
    robot.grasp(from_above(0.5, 0.1, 0.025), shake=False)
    pressed_at: list[tuple[float, float]] = []
    original = world.run

    def run(controls, phase, guard=None, **options):
        def pressing(step: int) -> str | None:
            if phase == "carry" and step >= 100 and not pressed_at:
                thread = threading.Thread(target=stop.press)
                thread.start()
                thread.join()
                pressed_at.append((world.time, time.perf_counter()))
            said = None if guard is None else guard(step)
            if said == "stop":
                noticed.append((world.time, time.perf_counter()))
            return said

        return original(controls, phase, pressing, **options)

    noticed: list[tuple[float, float]] = []
    world.run = run  # type: ignore[method-assign]
    felt = robot.place((0.55, -0.15, 0.027))
    assert felt.stopped_by == "stop"
    assert noticed[0][0] - pressed_at[0][0] < 0.012
    assert noticed[0][1] - pressed_at[0][1] < 0.05
    assert robot.holding
    here = robot.joints
    assert np.abs(world.read("robot/joint_velocity")).max() < 0.02
    again = robot.go_home()
    assert again.stopped_by == "stop"
    assert np.array_equal(robot.joints, here)
    stop.release()
    assert robot.release_and_home().stopped_by is None


def test_a_full_hand_refuses_a_second_grasp(cube, scene) -> None:
    """Grasping while holding is bad input."""
    world = World(scene(cube(x=0.5, y=0.1)))
    robot = Robot(world)
    robot.grasp(from_above(0.5, 0.1, 0.025), shake=False)
    with pytest.raises(BadInputError, match="already holds"):
        robot.grasp(from_above(0.5, -0.1, 0.025))


def test_a_motion_gives_up_after_a_minute(cube, scene, monkeypatch: pytest.MonkeyPatch) -> None:
    """Simulated time beyond the limit ends the motion with "timeout"."""
    monkeypatch.setattr("sim.motion_run.TIME_LIMIT", 2.0)
    world = World(scene(cube(x=0.5, y=0.1)))
    felt = Robot(world).grasp(from_above(0.5, 0.1, 0.025))
    assert felt.stopped_by == "timeout"
    assert felt.sim_time < 2.4


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["cube", "can", "ball"])
def test_half_a_minute_of_holding_drifts_less_than_two_millimetres(kind: str, cube, can, ball, scene) -> None:
    """Calibration gate: hold drift in the hand and of the empty arm over 30 s is below 2 mm."""
    from sim.controller import hold

    thing = {"cube": cube, "can": can, "ball": ball}[kind](x=0.5, y=0.1)
    grasp = from_aside(0.5, 0.1, 0.1, 0.55) if kind == "can" else from_above(0.5, 0.1, thing.size[2] / 2)
    world = World(scene(thing))
    robot = Robot(world)
    robot.grasp(grasp, shake=False, obstacles=[box_of(thing)])
    before, tool = place_of(world, kind), world.read("robot/tcp_position")
    for _ in range(6):
        world.run(hold(world.data.ctrl[0:21:3], float(world.data.ctrl[21]), 5.0), "hold")
    assert np.linalg.norm(place_of(world, kind) - before) < 2e-3
    assert np.linalg.norm(world.read("robot/tcp_position") - tool) < 2e-4
