"""Between physics and the 3D view: paces the motion to a clock that a person can follow, and samples poses and forces.

`Live` is a world's watcher and recorder. It runs in the thread of physics, so all it does there is copy and wait; a
thread of its own draws.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from app.force_trace import ForceTrace

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sim.recording import Recording
    from sim.world import World

FRAME_S = 0.04
"""Wall time between two poses shown [s]."""
SAMPLE_S = 0.05
"""Simulated time between two samples of a replay [s]."""
NAP_S = 0.002
"""Less than this is not worth waiting for [s]."""
PAUSE_S = 0.25
"""A wall-clock gap of this length between two calls means that the robot was thinking; the clock starts again [s]."""
SPEEDS = (1.0, 2.0, 4.0, 0.0)
"""Simulated seconds a wall second; 0 is as fast as the machine can."""
MAX_SAMPLES = 6000
"""Samples kept of one turn: five minutes of motion."""


class Live:
    """Shows one world while it moves."""

    def __init__(
        self, show: Callable[[NDArray[np.float64]], None], halted: Callable[[], None], felt: Callable[[], None]
    ) -> None:
        """Args: who draws a pose (nq,); who is told that physics has halted on a stop; and that a phase is over."""
        self._speed = 2.0
        self._show, self._halted, self._felt = show, halted, felt
        self._world: World | None = None
        self._wall = self._sim = self._last = self._shown = 0.0
        self._pose: NDArray[np.float64] | None = None
        self._fresh = threading.Event()
        self._open = True
        self.phase: str | None = None
        """Phase of the motion that ended last."""
        self.forces = ForceTrace()
        self.times: list[float] = []
        self.poses: list[NDArray[np.float32]] = []
        """Samples of the current turn, for its replay: simulated time [s] and joints (nq,)."""
        threading.Thread(target=self._draw, name="ragvlm-view", daemon=True).start()

    def attach(self, world: World) -> None:
        """Watches this world from now on, and no other."""
        self.detach()
        self._world = world
        self.begin()
        world.watcher = self
        world.recorders.append(self)
        self.touch()

    def detach(self) -> None:
        """Lets go of the world."""
        if self._world is not None:
            self._world.watcher = None
            self._world.recorders.remove(self)
            self._world = None

    def close(self) -> None:
        """Ends the drawing thread."""
        self.detach()
        self._open = False
        self._fresh.set()

    @property
    def world(self) -> World | None:
        """The world that is watched."""
        return self._world

    @property
    def speed(self) -> float:
        """Simulated seconds a wall second; 0 is as fast as the machine can. May be set at any time."""
        return self._speed

    @speed.setter
    def speed(self, speed: float) -> None:
        self._speed = speed
        self._last = 0.0

    def begin(self) -> None:
        """A turn begins: its samples and forces start empty."""
        self.times, self.poses, self.forces = [], [], ForceTrace()
        if self._world is not None:
            self.forces.listen_to(self._world.index.sensors)

    def touch(self) -> None:
        """Shows the world as it is now: after a motion, a restore, or a replay."""
        if self._world is not None:
            self._pose = self._world.data.qpos.copy()
            self._fresh.set()

    def __call__(self) -> None:
        """Called by physics every 10 ms of simulated time: samples, shows, and waits for the clock."""
        assert self._world is not None
        now, sim = time.monotonic(), self._world.time
        if not self.times or sim >= self.times[-1] + SAMPLE_S or sim < self.times[-1]:
            self._sample(sim)
        if now - self._shown > FRAME_S:
            self._shown = now
            self.touch()
        if now - self._last > PAUSE_S or not 0.0 <= sim - self._sim < 60.0:
            self._wall, self._sim = now, sim
        self._last = now
        if self._speed <= 0.0:
            self._wall, self._sim = now, sim
            return
        ahead = (sim - self._sim) / self._speed - (now - self._wall)
        if ahead > NAP_S:
            # Never longer than one watcher's interval at the slowest speed: the guard that reads the stop comes next.
            time.sleep(min(ahead, 0.02))

    def _sample(self, sim: float) -> None:
        assert self._world is not None
        if len(self.times) < MAX_SAMPLES:
            self.times.append(sim)
            self.poses.append(self._world.data.qpos.astype(np.float32))

    def on_recording(self, recording: Recording) -> None:
        """One phase is over."""
        self.phase = recording.phase
        self.forces.on_recording(recording)
        if recording.ended_by == "stop":
            self._halted()
        self._felt()
        self.touch()

    def _draw(self) -> None:
        """Draws the latest pose, at most every `FRAME_S`; sleeps while nothing moves."""
        while self._fresh.wait() and self._open:
            self._fresh.clear()
            pose: Any = self._pose
            if pose is not None:
                self._show(pose)
            time.sleep(FRAME_S)
