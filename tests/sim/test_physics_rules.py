"""What would be cheating is absent from the compiled model and from a run (docs: what physics may not do)."""

from __future__ import annotations

import inspect
import re
from pathlib import Path

import mujoco
import numpy as np
import pytest

import sim
from kb.grasp import Grasp
from sim.build_model import IMPRATIO, SOLREF_HARD, SOLREF_SOFT, TIMESTEP
from sim.draw_scene import draw_scene
from sim.recording import Recording
from sim.robot import Robot
from sim.scene_file import builtin_scenes, load_scene
from sim.world import World

SCENES = ("single_cube", "cup_near_vase", "filled_cup", "sort_by_fragility")


@pytest.fixture(scope="module", params=SCENES)
def world(request: pytest.FixtureRequest) -> World:
    return World(draw_scene(load_scene(request.param), 10001))


def test_these_scenes_exist() -> None:
    """The inspected scenes are built-in ones."""
    assert set(SCENES) <= set(builtin_scenes())


def test_nothing_is_welded_glued_or_carried(world: World) -> None:
    """No weld or connect constraints, no adhesion, no mocap bodies, no plugins; one coupling of the two fingers."""
    model = world.model
    assert model.neq == 1
    assert model.eq_type[0] == mujoco.mjtEq.mjEQ_JOINT
    joints = {model.joint(int(model.eq_obj1id[0])).name, model.joint(int(model.eq_obj2id[0])).name}
    assert joints == {"robot/finger_left", "robot/finger_right"}
    assert model.nmocap == 0
    assert model.nplugin == 0
    assert model.nu == 22
    assert {model.actuator(i).name.split("/")[0] for i in range(len(model.actuator_trntype))} == {"robot"}
    allowed = {mujoco.mjtTrn.mjTRN_JOINT, mujoco.mjtTrn.mjTRN_TENDON}
    assert set(model.actuator_trntype.tolist()) <= {int(kind) for kind in allowed}


def test_gravity_acts_on_everything_but_the_arm(world: World) -> None:
    """Standard gravity; gravity compensation only on the robot's own bodies; every free object has a plain free joint."""
    model = world.model
    assert model.opt.gravity.tolist() == [0.0, 0.0, -9.81]
    for body in range(model.nbody):
        compensated = model.body_gravcomp[body] != 0.0
        assert compensated == (model.body(body).name.startswith("robot/") and model.body(body).name != "robot/link0")
    for thing in world.placed.objects:
        body = model.body(thing.id)
        assert body.jntnum[0] == (0 if thing.fixed else 1)
        if not thing.fixed:
            joint = int(body.jntadr[0])
            assert model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_FREE
            assert model.jnt_stiffness[joint].sum() == 0.0
            assert np.all(model.dof_damping[world.index.objects[thing.id].qvel] == 0.0)


def test_settings_on_which_verdicts_rest(world: World) -> None:
    """Integrator, step, cone, impedance ratio and solver defaults are the measured ones."""
    option = world.model.opt
    assert option.integrator == mujoco.mjtIntegrator.mjINT_DISCRETE
    assert option.cone == mujoco.mjtCone.mjCONE_ELLIPTIC
    assert (option.timestep, option.impratio) == (TIMESTEP, IMPRATIO) == (0.002, 100.0)
    assert (option.iterations, option.ls_iterations, option.noslip_iterations) == (100, 50, 0)
    assert option.disableflags == 0
    assert option.enableflags == mujoco.mjtEnableBit.mjENBL_SLEEP


def test_contact_belongs_to_the_material_and_not_to_the_grasper(world: World) -> None:
    """Objects bring their own friction by priority, the same on every piece, and one of two softnesses."""
    model = world.model
    for thing in world.placed.objects:
        for geom in world.index.objects[thing.id].geoms:
            assert model.geom_priority[geom] == 1
            assert model.geom_friction[geom, 0] == pytest.approx(thing.friction)
            assert model.geom_solref[geom, 0] == (SOLREF_SOFT if thing.soft else SOLREF_HARD)
            assert model.geom_margin[geom] == 0.0
            assert model.geom_gap[geom] == 0.0
    robot = [geom for geom, owner in world.index.geom_owner.items() if owner == "robot"]
    assert set(model.geom_priority[robot].tolist()) == {0}
    assert model.geom_friction[robot, 0].max() <= 0.3
    assert model.npair == 0
    assert model.nexclude == 0


def test_mass_and_pose_are_those_of_the_scene(world: World) -> None:
    """Each compiled object has its drawn mass, and starts within 2 mm of its drawn place."""
    for thing in world.placed.objects:
        if thing.fixed:
            continue
        assert world.model.body(thing.id).mass[0] == pytest.approx(thing.mass, rel=1e-3)
        place = world.data.qpos[world.index.objects[thing.id].qpos]
        assert np.linalg.norm(place[:3] - thing.position) < 2e-3


class Witness:
    """Watches a run for jumps that physics cannot make."""

    def __init__(self, world: World) -> None:
        self.world = world
        self.rows: list[Recording] = []

    def on_recording(self, recording: Recording) -> None:
        self.rows.append(recording)


def test_between_attempts_nothing_is_reset(cube, scene) -> None:
    """Over a grasp, a release and a second grasp, time only advances and no coordinate jumps faster than it moves."""
    world = World(scene(cube(x=0.5, y=0.1)))
    witness = Witness(world)
    world.recorders.append(witness)
    robot = Robot(world)
    grasp = Grasp(position=(0.5, 0.1, 0.025), approach=(0, 0, -1), yaw=0.0, aperture=0.07, force=15, type="pinch")
    robot.grasp(grasp, shake=False)
    robot.release_and_home()
    robot.grasp(grasp, shake=False)
    time = np.concatenate([row.time for row in witness.rows])
    assert np.allclose(np.diff(time), TIMESTEP, atol=1e-9)
    qpos, qvel = (np.concatenate([getattr(row, name) for row in witness.rows]) for name in ("qpos", "qvel"))
    index = world.index.objects["cube"]
    for positions, speeds in ((qpos[:, :9], qvel[:, :9]), (qpos[:, index.qpos][:, :3], qvel[:, index.qvel][:, :3])):
        moved = np.diff(positions, axis=0)
        assert np.abs(moved - speeds[1:] * TIMESTEP).max() < 1e-6
    assert [row.attempt for row in witness.rows] == sorted(row.attempt for row in witness.rows)
    assert world.data.xfrc_applied.any() == world.data.qfrc_applied.any() == False  # noqa: E712


def test_the_code_never_writes_object_state() -> None:
    """Outside model building, no physical code assigns positions, velocities or applied forces, or resets the world,
    except where a world is first set up or a snapshot is restored; and the robot reads no truth."""
    folder = Path(inspect.getfile(sim)).parent
    writes = re.compile(
        r"\.(qpos|qvel|xfrc_applied|qfrc_applied|mocap_pos|mocap_quat|eq_active)(\[[^\]]*\])?\s*[-+*/]?=[^=]"
    )
    robot_side = [
        "robot",
        "grasp_motion",
        "place_motion",
        "motion_run",
        "wrench",
        "reach",
        "motion",
        "shake",
        "controller",
    ]
    for name in robot_side:
        text = (folder / f"{name}.py").read_text()
        assert not writes.search(text), name
        assert "mj_reset" not in text, name
        assert not re.search(r"""(read|sensors)[\[(]["']truth/""", text), name
        assert "index.objects" not in text, name
        assert "index.particles" not in text, name
    text = (folder / "world.py").read_text()
    assert text.count("mj_resetData") == 1
    inside_reset = text[text.index("def _reset") : text.index("def settle")]
    assert len(writes.findall(text)) == len(writes.findall(inside_reset)) == 2
