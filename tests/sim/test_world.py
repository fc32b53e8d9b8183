"""Laws of the physical world: exact snapshots, honest recordings, refused scenes, readable sensors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kb.errors import BadInputError
from kb.grasp import Grasp
from sim.controller import follow
from sim.panda import READY
from sim.placed import Geom, Particles
from sim.recording import Recording
from sim.robot import Robot
from sim.world import GUARD_EVERY, World


def _sway(world: World, count: int, seed: int) -> np.ndarray:
    """Controls that swing the arm about, low enough to brush objects."""
    rng = np.random.default_rng(seed)
    t = np.arange(count) * 0.002
    swing = np.outer(np.sin(3.0 * t), rng.uniform(0.2, 0.6, 7) * [1, 1.5, 1, -0.5, 1, 1, 1])
    return follow(READY + swing, 0.05)


class Keeper:
    def __init__(self) -> None:
        self.kept: list[Recording] = []

    def on_recording(self, recording: Recording) -> None:
        self.kept.append(recording)


def _same(one: Recording, two: Recording) -> bool:
    fields = ("time", "qpos", "qvel", "controls", "sensordata")
    return all(np.array_equal(getattr(one, name), getattr(two, name)) for name in fields)


def test_a_snapshot_continues_bit_for_bit(cube, ball, scene) -> None:
    """Restored in the same world or in a new one, the run continues exactly, with sleeping and moving objects."""
    placed = scene(cube(x=0.45, y=0.1), ball(x=0.6, y=-0.1, z=0.4), cube("other", x=0.615, y=-0.1))
    world = World(placed, settle=False)
    world.run(_sway(world, 120, 1), "transit")
    blob = world.snapshot()
    first = world.run(_sway(world, 400, 3), "transit")
    end = world.snapshot()
    world.restore(blob)
    assert _same(first, world.run(_sway(world, 400, 3), "transit"))
    fresh = World(placed)
    fresh.restore(blob)
    assert _same(first, fresh.run(_sway(fresh, 400, 3), "transit"))
    assert fresh.snapshot() == end
    assert first.qpos[0, world.index.objects["ball"].qpos][2] > 0.1


def test_a_sleeping_object_wakes_the_same_after_a_restore(cube, scene) -> None:
    """An object that sleeps in the snapshot and is gripped afterwards moves bit for bit as without the restore."""
    grasp = Grasp(position=(0.5, 0.0, 0.03), approach=(0, 0, -1), yaw=0.0, aperture=0.07, force=15, type="pinch")
    world = World(scene(cube()))
    assert (world.data.tree_asleep >= 0).any()
    blob = world.snapshot()
    felt = Robot(world).grasp(grasp)
    end = world.snapshot()
    assert world.data.qpos[world.index.objects["cube"].qpos][2] > 0.1
    fresh = World(world.placed)
    fresh.restore(blob)
    assert Robot(fresh).grasp(grasp) == felt
    assert fresh.snapshot() == end


def test_a_snapshot_keeps_force_motion_number_and_notes(cube, scene) -> None:
    """The gripper's force range, the number of the motion and the controller's notes come back."""
    world = World(scene(cube()))
    world.attempt, world.notes = 5, {"hang_z": 0.1}
    world.set_grip_force(12.5)
    blob = world.snapshot()
    other = World(world.placed)
    other.restore(blob)
    assert (other.attempt, other.notes) == (5, {"hang_z": 0.1})
    assert other.model.actuator_forcerange[other.index.gripper].tolist() == [-12.5, 12.5]


def test_foreign_snapshots_are_refused(cube, scene) -> None:
    """A snapshot of another scene, or garbage, is bad input and changes nothing."""
    world = World(scene(cube()))
    before = world.data.qpos.copy()
    other = World(replace(scene(cube()), seed=7))
    with pytest.raises(BadInputError, match="seed 7"):
        world.restore(other.snapshot())
    with pytest.raises(BadInputError, match="not a snapshot"):
        world.restore(b"nonsense")
    assert np.array_equal(world.data.qpos, before)


def test_the_same_run_twice_gives_the_same_bytes(cube, scene) -> None:
    """Two worlds of the same scene agree bit for bit."""
    worlds = [World(scene(cube())) for _ in range(2)]
    assert _same(*[world.run(_sway(world, 300, 4), "transit") for world in worlds])


def test_a_recording_holds_state_and_sensors_of_the_same_instant(cube, scene) -> None:
    """Joint positions read by the sensors equal the recorded state of the same row, and rows are one step apart."""
    world = World(scene(cube()))
    keeper = Keeper()
    world.recorders.append(keeper)
    begun = world.time
    record = world.run(_sway(world, 100, 5), "approach")
    assert keeper.kept == [record]
    assert np.array_equal(record.sensordata[:, world.index.sensors["robot/joint_position"]], record.qpos[:, :7])
    assert record.time == pytest.approx(begun + 0.002 * np.arange(100))
    assert (record.phase, record.attempt) == ("approach", 0)


def test_the_guard_ends_a_run_within_two_steps(cube, scene) -> None:
    """A guard that speaks ends the run at once, and the record says why and ends there."""
    world = World(scene(cube()))
    record = world.run(_sway(world, 100, 6), "hold", lambda step: "stop" if step >= 40 else None)
    assert record.ended_by == "stop"
    assert 41 <= len(record) <= 41 + GUARD_EVERY
    assert len(record.qpos) == len(record.controls) == len(record)


def test_overlapping_objects_are_refused_by_name(cube, scene) -> None:
    """Objects inside each other, inside the table or inside the robot are refused, naming both."""
    with pytest.raises(BadInputError, match=r"'cube' and 'other'|'other' and 'cube'"):
        World(scene(cube(), cube("other", x=0.53)))
    with pytest.raises(BadInputError, match="'table'"):
        World(scene(cube(z=-0.01)))
    with pytest.raises(BadInputError, match="'robot'"):
        World(scene(cube(x=0.0, y=0.0, z=0.1)))


def test_malformed_objects_are_refused(cube, scene) -> None:
    """Twice the same name, no geometry, no mass, a flat mesh and ownerless particles are bad input."""
    bad_mesh = replace(cube(), geoms=(Geom("mesh", vertices=np.zeros((2, 3)), mass=0.1),))
    massless = replace(cube(), geoms=(Geom("box", (0.02,) * 3, (0, 0, 0.02)),))
    for things in ((cube(), cube()), (replace(cube(), geoms=()),), (massless,), (bad_mesh,)):
        with pytest.raises(BadInputError):
            World(scene(*things))
    with pytest.raises(BadInputError, match="nobody"):
        World(scene(cube(), particles=(Particles("nobody", 0.01, 0.002, np.zeros((1, 3))),)))


def test_convex_meshes_and_particles_have_the_given_mass(cube, scene) -> None:
    """A mesh piece collides and weighs what it should; particles are free bodies found by the index."""
    corners = np.array([[x, y, z] for x in (-0.03, 0.03) for y in (-0.02, 0.02) for z in (0.0, 0.05)])
    brick = replace(cube("brick"), geoms=(Geom("mesh", vertices=corners, mass=0.2),))
    beans = Particles("brick", 0.01, 0.003, np.array([[0.5, 0.1, 0.012], [0.5, 0.15, 0.012]]))
    world = World(scene(brick, particles=(beans,)))
    assert world.model.body("brick").mass[0] == pytest.approx(0.2)
    assert abs(world.data.qpos[world.index.objects["brick"].qpos][2]) < 1e-3
    heights = world.data.qpos[world.index.particles["brick"] + 2]
    assert heights == pytest.approx([0.01, 0.01], abs=1e-3)
    weight = np.linalg.norm(world.read("truth/brick/table")[1:4])
    assert weight == pytest.approx(0.2 * 9.81, rel=0.02)


def test_fixed_things_do_not_move_and_others_rest(cube, scene) -> None:
    """A part of the set-up is static; a free object on the table settles within 0.1 mm and goes to sleep."""
    world = World(scene(cube(), cube("block", x=0.6, y=0.2, fixed=True)))
    assert world.index.objects["block"].qpos is None
    world.run(_sway(world, 50, 8), "hold")
    place = world.data.qpos[world.index.objects["cube"].qpos]
    assert place[:3] == pytest.approx((0.5, 0.0, 0.0), abs=1e-4)
    assert (world.data.tree_asleep >= 0).sum() == 1


def test_a_watcher_sees_the_motion_and_changes_nothing(cube, scene) -> None:
    """The watcher is called every GUARD_EVERY steps while physics runs; the recording is the same bit for bit."""
    placed = scene(cube(x=0.45, y=0.1))
    times: list[float] = []
    alone, watched = World(placed), World(placed)
    watched.watcher = lambda: times.append(watched.time)
    controls = _sway(alone, 100, 5)
    assert _same(alone.run(controls, "transit"), watched.run(controls, "transit"))
    assert len(times) == 100 // GUARD_EVERY
    assert np.allclose(np.diff(times), GUARD_EVERY * 0.002)
