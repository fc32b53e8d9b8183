"""The physical world: one compiled scene, run step by step, recorded, snapshot and restored exactly."""

# MuJoCo ships no type stubs for its compiled functions.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import json
import struct
from collections.abc import Callable, Sequence
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from kb.errors import BadInputError
from kb.rgbd import RgbdView
from kb.sensing import Phase
from sim.build_model import build_model
from sim.panda import FINGER_TRAVEL, READY
from sim.placed import PlacedScene
from sim.recording import Recorder, Recording
from sim.world_index import WorldIndex, index_model

Array = NDArray[np.float64]
Guard = Callable[[int], str | None]
"""Called with the number of the step just made; a text ends the run and says why."""

GUARD_EVERY = 5
"""Steps between two calls of the guard, unless said otherwise: every 10 ms of simulated time."""
SETTLE_S, SETTLE_PARTICLES_S = 0.1, 0.6
"""Simulated time in which a new scene comes to rest, without and with loose contents [s]."""
STATE = mujoco.mjtState.mjSTATE_INTEGRATION
SLEEP_ARRAYS = ("tree_asleep", "tree_awake", "body_awake", "body_awake_ind", "parent_awake_ind", "dof_awake_ind")
SLEEP_COUNTS = ("ntree_awake", "nbody_awake", "nparent_awake", "nv_awake")
ACCELERATIONS = ("qacc", "qacc_smooth")
"""Sleeping bodies keep their last accelerations and wake with them as the solver's first guess."""
POSITIONAL = (
    mujoco.mj_kinematics,
    mujoco.mj_comPos,
    mujoco.mj_camlight,
    mujoco.mj_tendon,
    mujoco.mj_transmission,
    mujoco.mj_sensorPos,
)
"""The parts of a forward pass that poses and the sensors of joints and tendons need, in their order."""
MAGIC = b"ragvlm-world-1\n"


class Still(NamedTuple):
    """A moment in which nothing moves, of one world and for it alone."""

    state: Array
    """MuJoCo's state vector."""
    arrays: dict[str, Array]
    """Readings, accelerations and who sleeps, by their names in MuJoCo."""
    counts: dict[str, int]
    """How many sleep."""
    attempt: int
    notes: dict[str, float]


class World:
    """The truth. Sensing and acting go through `sim.robot.Robot`; verdicts through recorders."""

    def __init__(self, placed: PlacedScene, *, settle: bool = True) -> None:
        """Compiles the scene with the arm at its ready pose and lets it come to rest.

        Raises:
            BadInputError: the scene does not compile or starts in penetration.
        """
        self.placed = placed
        self.model = build_model(placed)
        self.data = mujoco.MjData(self.model)
        self.index: WorldIndex = index_model(self.model, placed)
        self.recorders: list[Recorder] = []
        self.watcher: Callable[[], None] | None = None
        """Called every `GUARD_EVERY` steps of `run`, in its thread and before the guard, for live views. It may wait,
        which slows the physics down to the watcher's clock, and must not change the world."""
        self.attempt = 0
        """Number of the current motion of the robot."""
        self.notes: dict[str, float] = {}
        """The robot controller's own numbers that must survive a snapshot (never truth)."""
        self._reset()
        if settle:
            self.settle()

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return float(self.data.time)

    def _reset(self) -> None:
        data = self.data
        data.qpos[self.index.arm] = READY
        data.qpos[self.index.fingers] = FINGER_TRAVEL
        data.act[:] = 2 * FINGER_TRAVEL
        data.ctrl[:] = 0.0
        data.ctrl[0:21:3] = READY
        data.ctrl[self.index.gripper_control] = 2 * FINGER_TRAVEL
        mujoco.mj_forward(self.model, data)

    def settle(self, seconds: float | None = None) -> None:
        """Lets the scene come to rest under the standing controls, unrecorded."""
        if seconds is None:
            seconds = SETTLE_PARTICLES_S if self.placed.particles else SETTLE_S
        mujoco.mj_step(self.model, self.data, round(seconds / self.model.opt.timestep))

    def set_grip_force(self, force: float) -> None:
        """Sets the largest force of the gripper motor per finger [N] for what follows."""
        self.model.actuator_forcerange[self.index.gripper] = (-force, force)

    def read(self, sensor: str) -> Array:
        """A copy of one sensor's latest reading."""
        return self.data.sensordata[self.index.sensors[sensor]].copy()

    def run(self, controls: Array, phase: Phase, guard: Guard | None = None, *, every: int = GUARD_EVERY) -> Recording:
        """Steps the physics under the controls, one row a step, and tells the recorders.

        Args:
            controls: Control inputs, shape (T, nu).
            phase: Name of the phase for the record.
            guard: Called every `every` steps; a returned text ends the run after that step.
            every: Steps between two calls of the guard.
        """
        model, data, step = self.model, self.data, mujoco.mj_step
        count = len(controls)
        time = np.empty(count)
        qpos, qvel = np.empty((count, model.nq)), np.empty((count, model.nv))
        sensed = np.empty((count, model.nsensordata))
        ended_by, made = None, count
        watcher, due = self.watcher, 0
        live_qpos, live_qvel, live_sensors, live_ctrl = data.qpos, data.qvel, data.sensordata, data.ctrl
        for i in range(count):
            time[i] = data.time
            qpos[i] = live_qpos
            qvel[i] = live_qvel
            live_ctrl[:] = controls[i]
            step(model, data)
            sensed[i] = live_sensors
            if watcher is not None and i % GUARD_EVERY == 0:
                watcher()
            if guard is not None and i == due:
                due += every
                ended_by = guard(i)
                if ended_by is not None:
                    made = i + 1
                    break
        force = float(model.actuator_forcerange[self.index.gripper, 1])
        recording = Recording(
            phase, self.attempt, time[:made], qpos[:made], qvel[:made], controls[:made], sensed[:made], ended_by, force
        )
        for recorder in self.recorders:
            recorder.on_recording(recording)
        return recording

    def snapshot(self) -> bytes:
        """The whole state, from which `restore` continues bit for bit."""
        state = np.empty(mujoco.mj_stateSize(self.model, STATE))
        mujoco.mj_getState(self.model, self.data, state, STATE)
        header = {
            "scene": self.placed.name,
            "seed": self.placed.seed,
            "attempt": self.attempt,
            "notes": self.notes,
            "force": float(self.model.actuator_forcerange[self.index.gripper, 1]),
        }
        text = json.dumps(header).encode()
        asleep = np.concatenate([getattr(self.data, name) for name in SLEEP_ARRAYS] + [self._sleep_counts()])
        parts = [text, state.tobytes(), asleep.astype(np.int32).tobytes(), self.data.sensordata.tobytes()]
        parts += [getattr(self.data, name).tobytes() for name in ACCELERATIONS]
        return MAGIC + b"".join(struct.pack("<I", len(part)) + part for part in parts)

    def _sleep_counts(self) -> NDArray[np.int32]:
        return np.array([getattr(self.data, name) for name in SLEEP_COUNTS], np.int32)

    def restore(self, blob: bytes) -> None:
        """Puts back what `snapshot` returned, in this world or in another one of the same scene and seed.

        Raises:
            BadInputError: the blob is not a snapshot of this scene.
        """
        header, state, asleep, sensors, accelerations = _unpack(blob)
        if (header["scene"], header["seed"]) != (self.placed.name, self.placed.seed):
            raise BadInputError(
                f"the snapshot is of scene {header['scene']!r} seed {header['seed']}",
                where=f"scene {self.placed.name!r} seed {self.placed.seed}",
            )
        sizes = [len(getattr(self.data, name)) for name in SLEEP_ARRAYS]
        if len(state) != mujoco.mj_stateSize(self.model, STATE) or len(asleep) != sum(sizes) + len(SLEEP_COUNTS):
            raise BadInputError("the snapshot has the wrong size; the scene has changed since", where=self.placed.name)
        mujoco.mj_resetData(self.model, self.data)
        self.set_grip_force(header["force"])
        mujoco.mj_setState(self.model, self.data, state, STATE)
        mujoco.mj_forward(self.model, self.data)
        # The forward pass fills poses and contacts of every body once; then the exact state, and who sleeps, return.
        # MuJoCo's state vector leaves the latter out.
        mujoco.mj_setState(self.model, self.data, state, STATE)
        for name, values in zip(SLEEP_ARRAYS, np.split(asleep, np.cumsum(sizes))[:-1], strict=True):
            getattr(self.data, name)[:] = values
        for name, value in zip(SLEEP_COUNTS, asleep[sum(sizes) :], strict=True):
            setattr(self.data, name, int(value))
        self.data.sensordata[:] = sensors
        for name, values in zip(ACCELERATIONS, accelerations, strict=True):
            getattr(self.data, name)[:] = values
        self.attempt = int(header["attempt"])
        self.notes = dict(header["notes"])

    def bearings(self) -> None:
        """Brings poses and the sensors that follow from them up to date with the joints; no forces, no contacts."""
        for part in POSITIONAL:
            part(self.model, self.data)

    def still(self) -> Still:
        """A state in which nothing moves, for `be_still`: much cheaper than `snapshot`, and for this world alone."""
        state = np.empty(mujoco.mj_stateSize(self.model, STATE))
        mujoco.mj_getState(self.model, self.data, state, STATE)
        arrays = {name: getattr(self.data, name).copy() for name in (*SLEEP_ARRAYS, *ACCELERATIONS, "sensordata")}
        counts = {name: getattr(self.data, name) for name in SLEEP_COUNTS}
        return Still(state, arrays, counts, self.attempt, dict(self.notes))

    def be_still(self, known: Still) -> None:
        """Puts back what `still` returned."""
        mujoco.mj_setState(self.model, self.data, known.state, STATE)
        self.bearings()
        for name, values in known.arrays.items():
            getattr(self.data, name)[:] = values
        for name, count in known.counts.items():
            setattr(self.data, name, count)
        self.attempt, self.notes = known.attempt, dict(known.notes)

    def capture(self, rng: np.random.Generator, names: Sequence[str] = ("front", "top")) -> tuple[RgbdView, ...]:
        """Pictures by the named cameras of the scene, with the noise of this draw.

        Raises:
            BadInputError: the scene has no camera of that name.
        """
        from sim.cameras import capture_all

        cameras = {camera.name: camera for camera in self.placed.cameras}
        missing = [name for name in names if name not in cameras]
        if missing:
            raise BadInputError(f"there is no camera {missing[0]!r}", where=self.placed.name, choices=cameras)
        return capture_all(self.model, self.data, [cameras[name] for name in names], self.placed, rng)


def _unpack(blob: bytes) -> tuple[dict, Array, NDArray[np.int32], Array, list[Array]]:
    """Header, state vector, sleep cycles, sensor readings and accelerations of a snapshot."""
    if not blob.startswith(MAGIC):
        raise BadInputError("this is not a snapshot of a world")
    parts, at = [], len(MAGIC)
    while at < len(blob):
        (size,) = struct.unpack_from("<I", blob, at)
        parts.append(blob[at + 4 : at + 4 + size])
        at += 4 + size
    if len(parts) != 4 + len(ACCELERATIONS):
        raise BadInputError("the snapshot is incomplete")
    return (
        json.loads(parts[0]),
        np.frombuffer(parts[1], np.float64),
        np.frombuffer(parts[2], np.int32),
        np.frombuffer(parts[3], np.float64),
        [np.frombuffer(part, np.float64) for part in parts[4:]],
    )
