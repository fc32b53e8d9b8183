"""How much longer a grasp takes than the physics steps in it: the processor time of `Robot.grasp` over that of bare
steps. Processor time, because both share the machine with other workers.

Bare steps are made from the state before the grasp with the very controls that the grasp sent, by nothing but the
physics engine; afterwards the world is as it was, so that measuring changes no result.
"""

from __future__ import annotations

import time
from typing import Any

from sim.bare_steps import bare_steps
from sim.recording import Recording


class MotionMeter:
    """A robot whose grasps are timed if asked; everything else goes straight through."""

    def __init__(self, robot: Any, world: Any, measure: bool) -> None:
        self._robot = robot
        self._world = world
        self._measure = measure and hasattr(world, "run")
        self._recordings: list[Recording] = []
        self._grasps, self._grasps_wall = 0.0, 0.0
        self._bare, self._bare_wall = 0.0, 0.0
        self.spent = 0.0
        """Wall time that measuring took [s]."""

    @property
    def ratio(self) -> float | None:
        """Processor time of the grasps over that of their bare steps; None if nothing was measured."""
        return self._grasps / self._bare if self._bare > 0.0 else None

    @property
    def wall_ratio(self) -> float | None:
        """The same of wall times, which whatever else the machine does takes part in."""
        return self._grasps_wall / self._bare_wall if self._bare_wall > 0.0 else None

    def on_recording(self, recording: Recording) -> None:
        """Keeps the controls of a run."""
        self._recordings.append(recording)

    def grasp(self, *args: Any, **kwargs: Any) -> Any:
        """As `sim.robot.Robot.grasp`."""
        if not self._measure:
            return self._robot.grasp(*args, **kwargs)
        before, self._recordings = self._world.snapshot(), []
        self._world.recorders.append(self)
        start, began = time.thread_time(), time.perf_counter()
        try:
            sensing = self._robot.grasp(*args, **kwargs)
        finally:
            took, wall = time.thread_time() - start, time.perf_counter() - began
            self._world.recorders.remove(self)
        self._compare(before, took, wall)
        return sensing

    def _compare(self, before: bytes, took: float, wall: float) -> None:
        """Makes the same steps bare, and puts the world back."""
        if not self._recordings:
            return
        start = time.perf_counter()
        after = self._world.snapshot()
        self._world.restore(before)
        bare, bare_wall = bare_steps(self._world, self._recordings)
        self._bare, self._bare_wall = self._bare + bare, self._bare_wall + bare_wall
        self._grasps, self._grasps_wall = self._grasps + took, self._grasps_wall + wall
        self._world.restore(after)
        self.spent += time.perf_counter() - start

    def __getattr__(self, name: str) -> Any:
        return getattr(self._robot, name)
