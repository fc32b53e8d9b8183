"""What a run of the physics leaves behind: every step, copied, for observers, pictures and tests."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from kb.sensing import Phase

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Recording:
    """One phase of one motion. Row i is the instant before step i: its state, and the sensors of that very state."""

    phase: Phase
    attempt: int
    """Number of the motion this belongs to; every motion of the robot has its own."""
    time: Array
    """Simulated time [s], shape (T,)."""
    qpos: Array
    """Generalised positions, shape (T, nq)."""
    qvel: Array
    """Generalised velocities, shape (T, nv)."""
    controls: Array
    """Control inputs that were applied, shape (T, nu)."""
    sensordata: Array
    """All sensors, shape (T, ns); columns by name in `WorldIndex.sensors`."""
    ended_by: str | None = None
    """What the guard said when it ended the run early."""
    grip_force: float | None = None
    """Largest force of the gripper motor per finger during the run [N]."""

    def __len__(self) -> int:
        return len(self.time)


class Recorder(Protocol):
    """Whoever wants to see every step."""

    def on_recording(self, recording: Recording) -> None:
        """Called once after each run, in order."""
        ...
