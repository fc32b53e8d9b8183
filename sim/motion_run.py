"""One motion of the robot as it happens: phases under guard, and what the robot's own sensors said.

Only robot sensors ("robot/...") are read here.
"""

from __future__ import annotations

from collections.abc import Callable
from operator import sub
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from kb.sensing import Phase, Sensing
from sim.build_model import TIMESTEP
from sim.controller import GRIP_COLUMN, along, follow, hold, steps
from sim.kinematics import tcp_poses
from sim.recording import Recording
from sim.stop import StopSwitch
from sim.world import GUARD_EVERY, World
from sim.wrench import WINDOW, WristReader, moving_mean

Array = NDArray[np.float64]
Cause = Literal["force", "timeout", "stop", "unreachable", "path"]
Check = Callable[[], str | None]
"""A further reason to end a phase; texts other than the causes end only the phase."""

TIME_LIMIT = 60.0
"""Simulated time after which a motion is given up [s] (benchmark: 60 s per attempt)."""
HALT_S = 0.3
"""Simulated time in which a halted arm comes to rest [s]."""
SLOW = 0.05
"""Joint speed from which an arm may be stopped at once [rad/s]."""
BRAKE_S = 0.12
"""Time over which the command slows down when nothing was hit [s]: a sudden stop from full speed saturates the motors."""
STOP_WALL_S = 0.02
"""Wall time after a person's stop at which the physics stands still [s]; the promise is 0.05."""
LAG_LIMIT = 0.02
"""Lag of a joint behind its command that means a collision [rad]; free motions stay below 0.006."""
BACK_OFF_S = 0.5
"""How far back in its path a stopped free motion withdraws [s]."""
LOAD_WINDOW = 50
"""Steps of the 0.1-s mean of the carried mass."""
NOTHING = 1e-3
"""Opening below which nothing is between the fingers [m]."""
LEAST_LOAD = 0.005
"""Mass below which nothing is carried [kg]."""


def is_holding(world: World) -> bool:
    """The hand is told to close, presses with more than 0.5 N, and something keeps the fingers apart."""
    opening = float(world.read("robot/opening")[0])
    told = float(world.data.ctrl[world.index.gripper_control])
    return told < opening - NOTHING and opening > NOTHING and float(world.read("robot/grip_force")[0]) < -0.5


class HaltedError(Exception):
    """The motion ended before its end; a value for the caller, never shown to users."""

    def __init__(self, cause: Cause) -> None:
        super().__init__(cause)
        self.cause: Cause = cause


class MotionRun:
    """Runs the phases of one motion and keeps the readings that `Sensing` reports."""

    def __init__(self, world: World, stop: StopSwitch, limit: float | None = None) -> None:
        world.attempt += 1
        self.world = world
        self.stop = stop
        self.wrist = WristReader(world.index.sensors)
        self.fields: dict[str, Any] = {}
        self.started = world.time
        self.limit = TIME_LIMIT if limit is None else limit
        self.tracking = 0.0
        self.loads: list[Array] = []
        """Carried mass per step of the phases after the test lift [kg]."""
        # An arm that was stopped while it leaned on something would feel that again at once: it begins where it is.
        if float(np.abs(self.commanded - self.joints).max()) > LAG_LIMIT and not stop.pressed:
            self.halt("transit")

    # Commands as they stand -------------------------------------------------------------------------------------

    @property
    def commanded(self) -> Array:
        """Commanded joint angles (7,) [rad]."""
        return self.world.data.ctrl[0:GRIP_COLUMN:3].copy()

    @property
    def grip(self) -> float:
        """Commanded opening [m]."""
        return float(self.world.data.ctrl[GRIP_COLUMN])

    @property
    def joints(self) -> Array:
        """Joint angles from the encoders (7,) [rad]."""
        return self.world.read("robot/joint_position")

    @property
    def aperture(self) -> float:
        """Opening from the finger encoders [m]."""
        return float(self.world.read("robot/opening")[0])

    @property
    def holding(self) -> bool:
        """The hand was told to close, presses, and something keeps the fingers apart."""
        return is_holding(self.world)

    def run(self, controls: Array, phase: Phase, check: Check | None = None) -> Recording:
        """Runs one phase.

        Raises:
            HaltedError: stop, time-out, or whatever cause `check` returns; the arm has come to rest by then.
        """
        self.fields["phase"] = phase
        if self.stop.pressed:
            raise HaltedError("stop")
        deadline, data, pressed = self.started + self.limit, self.world.data, self.stop.is_pressed

        def guard(_: int) -> str | None:
            if pressed():
                return "stop"
            if data.time > deadline:
                return "timeout"
            return None if check is None else check()

        recording = self.world.run(controls, phase, guard, every=GUARD_EVERY if check is None else 1)
        self._track(recording)
        if recording.ended_by in ("stop", "timeout"):
            self._brake(phase)
        if recording.ended_by in ("stop", "timeout", "force"):
            self.halt(phase)
            raise HaltedError(recording.ended_by)  # type: ignore[arg-type]
        return recording

    def _brake(self, phase: Phase) -> None:
        """Slows the command down evenly, from where and how fast it is."""
        speed = self.world.data.ctrl[1:GRIP_COLUMN:3].copy()
        if float(np.abs(speed).max()) < SLOW:
            return
        t = TIMESTEP * np.arange(1, steps(BRAKE_S) + 1)[:, None]
        here = self.commanded
        self.world.run(
            follow(here + speed * (t - t * t / (2 * BRAKE_S)), self.grip, here), phase, self._overdue, every=1
        )

    def halt(self, phase: Phase) -> None:
        """Brings the arm to rest where it is; the gripper keeps its command and force.

        After a person's stop the physics itself stands still `STOP_WALL_S` later at the latest, at rest or not: the command
        to hold stays, and nothing steps the world until it is released.
        """
        here = self.world.read("robot/joint_position")
        self.world.run(hold(here, self.grip, HALT_S), phase, self._overdue, every=1)

    def _overdue(self, _: int) -> str | None:
        """Whether a person's stop has waited long enough for the physics to stand still."""
        return "halted" if self.stop.waited > STOP_WALL_S else None

    def run_guarded(
        self, joints: Array, opening: float, phase: Phase, limit: float, *, back: float = BACK_OFF_S
    ) -> Recording:
        """Follows joint samples (T, 7) with the force reflex: on contact the arm stops and withdraws along its path.

        Args:
            joints: Joint angles per time step, beginning next to the commanded ones.
            opening: Commanded opening [m].
            phase: Name of the phase.
            limit: Wrist force of the reflex [N].
            back: How far back in the path it withdraws [s].

        Raises:
            HaltedError: as `run`; after "force" the arm has withdrawn.
        """
        before = self.commanded
        try:
            return self.run(follow(joints, opening, before), phase, self.force_check(limit))
        except HaltedError as halted:
            if halted.cause == "force":
                nearest = int(np.abs(joints - self.joints).sum(axis=1).argmin())
                way = joints[max(0, nearest - steps(back)) : nearest + 1][::-1]
                if len(way) > 2:
                    path = way[np.linspace(0, len(way) - 1, 12).astype(int)]
                    # From where it was told to rest: a jump from there onto its path would press once more, and harder.
                    path[0] = self.commanded
                    self.run(follow(along(path, max(0.3, len(way) * TIMESTEP)), opening, self.commanded), "retreat")
                self.note(phase=phase, approach_force=self.fields["abort_force"])
            raise

    # Readings ---------------------------------------------------------------------------------------------------

    def force_check(self, limit: float) -> Check:
        """A check that ends the motion when the external wrist force, a 10-ms mean, exceeds `limit` [N].

        A link that hits something is not felt at the wrist, but a joint then lags behind its command.
        """
        sensed, wrist = self.world.data.sensordata, self.wrist
        told, felt = self.world.data.ctrl[0:GRIP_COLUMN:3], sensed[self.world.index.sensors["robot/joint_position"]]
        recent = [(0.0, 0.0, 0.0)] * WINDOW
        count, strong, force_now, safe = 0, 0, wrist.reader(sensed), (0.999 * limit) ** 2

        def check() -> str | None:
            # Called at every step, so in plain numbers; only what is near the limit is reckoned as the report does.
            nonlocal count, strong
            x, y, z = recent[count % WINDOW] = force_now()
            count += 1
            if x * x + y * y + z * z >= safe:
                strong = count + WINDOW
            lag = max(map(abs, map(sub, told.tolist(), felt.tolist())))
            # A mean is no larger than the largest of its parts.
            if lag <= LAG_LIMIT and strong <= count:
                return None
            x, y, z = map(sum, zip(*recent, strict=True))
            if lag <= LAG_LIMIT and (x * x + y * y + z * z) / min(count, WINDOW) ** 2 < safe:
                return None
            mean = np.array(recent).sum(axis=0) / min(count, WINDOW)
            size = float(np.sqrt(mean @ mean))
            if size <= limit and lag <= LAG_LIMIT:
                return None
            direction = wrist.force_w(sensed[None].copy())[0]
            self.fields["abort_force"] = size
            self.fields["abort_direction"] = tuple(float(v) for v in direction / max(np.linalg.norm(direction), 1e-9))
            return "force"

        return check

    def carry(self, recording: Recording) -> None:
        """Adds a phase to the record of the carried mass."""
        self.loads.append(self.wrist.mass(recording.sensordata))

    def reading(self, name: str, recording: Recording) -> Array:
        """Columns of one robot sensor over a recording."""
        return recording.sensordata[:, self.world.index.sensors[name]]

    def note(self, **fields: Any) -> None:
        """Keeps readings for the report."""
        self.fields.update(fields)

    def _track(self, recording: Recording) -> None:
        every = slice(0, max(len(recording) - 1, 0), 25)
        wanted = recording.controls[every, 0:GRIP_COLUMN:3]
        if len(wanted):
            actual = self.reading("robot/tcp_position", recording)[1:][every]
            error = np.linalg.norm(tcp_poses(wanted)[:, :3, 3] - actual, axis=1)
            self.tracking = max(self.tracking, float(error.max()))

    def sensing(self) -> Sensing:
        """The report of the whole motion."""
        fields = dict(self.fields)
        if self.loads:
            mean = moving_mean(np.concatenate(self.loads), LOAD_WINDOW)
            least = max(LEAST_LOAD, 0.5 * fields.get("load_lifted", 0.0))
            fields["load_min"] = float(mean.min())
            fields["held_s"] = float((mean > least).sum() * self.world.model.opt.timestep)
        fields["tracking_error"] = self.tracking
        fields["sim_time"] = self.world.time - self.started
        return Sensing(**fields)
