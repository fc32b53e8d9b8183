"""Laws of the robot model: Franka's kinematics and limits, and a hand that presses with the commanded force."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from sim.build_model import build_model
from sim.controller import CLOSED, hold
from sim.hand import hand_boxes
from sim.kinematics import forward
from sim.panda import LINKS, Q_MAX, Q_MIN, READY, hand_com, hand_mass
from sim.placed import PlacedScene
from sim.world import World


@pytest.fixture(scope="module")
def empty() -> World:
    return World(PlacedScene("empty", 0, ()))


def test_model_agrees_with_closed_form_kinematics(empty: World) -> None:
    """The compiled arm's tool pose equals the analytic forward kinematics to 1e-6 m on 1000 configurations."""
    data = mujoco.MjData(empty.model)
    rng = np.random.default_rng(1)
    worst = 0.0
    for joints in rng.uniform(Q_MIN, Q_MAX, (1000, 7)):
        data.qpos[:7] = joints
        mujoco.mj_kinematics(empty.model, data)
        pose = forward(joints)
        site = data.site("robot/tcp")
        worst = max(worst, np.abs(site.xpos - pose[:3, 3]).max(), np.abs(site.xmat.reshape(3, 3) - pose[:3, :3]).max())
    assert worst < 1e-6


def test_limits_and_masses_are_franka_s(empty: World) -> None:
    """Joint ranges, torque limits and link masses of the compiled model are the published ones."""
    for number, link in enumerate(LINKS, start=1):
        joint = empty.model.joint(f"robot/joint_{number}")
        assert joint.range == pytest.approx(link.range)
        assert empty.model.jnt_actfrcrange[joint.id, 1] == link.torque
        assert empty.model.body(f"robot/link{number}").mass[0] == pytest.approx(link.mass)


def test_physics_has_no_meshes_of_the_robot(empty: World) -> None:
    """The physical model compiles without visual meshes; the picture model has them and the same joints."""
    assert empty.model.nmesh == 0
    picture = build_model(empty.placed, visual=True)
    assert picture.nmesh == 10
    assert picture.nq == empty.model.nq


def test_collision_boxes_of_the_hand_are_those_of_the_clearance(empty: World) -> None:
    """Physics and clearance use the same hand: every box of `hand_boxes` is a collision box of the open hand."""
    data = mujoco.MjData(empty.model)
    data.qpos[:7], data.qpos[7:9] = READY, 0.03
    mujoco.mj_kinematics(empty.model, data)
    hand = data.body("robot/hand")
    turn = hand.xmat.reshape(3, 3)
    names = ("robot/hand", "robot/left_finger", "robot/right_finger")
    bodies = {empty.model.body(name).id for name in names}
    boxes = [g for g in range(empty.model.ngeom) if empty.model.geom_bodyid[g] in bodies]
    compiled = [np.concatenate([turn.T @ (data.geom_xpos[g] - hand.xpos), empty.model.geom_size[g]]) for g in boxes]
    wanted = [np.concatenate(box) for box in hand_boxes(0.06)]
    assert len(compiled) == len(wanted)
    for box in wanted:
        assert min(np.abs(box - other).max() for other in compiled) < 1e-6


@pytest.mark.parametrize("force", [5.0, 30.0, 70.0])
def test_motor_force_is_the_commanded_force(force: float) -> None:
    """Closing on nothing, the motor ends at the commanded force; the opening shrinks at no more than 0.1 m/s."""
    world = World(PlacedScene("empty", 0, ()))
    world.set_grip_force(force)
    record = world.run(hold(READY, CLOSED, 1.6), "close")
    opening = record.sensordata[:, world.index.sensors["robot/opening"]][:, 0]
    assert -world.read("robot/grip_force")[0] == pytest.approx(force, rel=1e-3)
    assert abs(opening[-1]) < 1e-3
    assert -np.diff(opening).min() / 0.002 < 0.13


def test_wrist_carries_the_hand_s_weight(empty: World) -> None:
    """At rest the wrist sensor reads the weight of hand and fingers, about their common centre of mass."""
    force, torque = empty.read("robot/wrist_force"), empty.read("robot/wrist_torque")
    assert np.linalg.norm(force) == pytest.approx(hand_mass() * 9.81, rel=1e-6)
    assert torque == pytest.approx(np.cross(hand_com(), force), abs=1e-6)
