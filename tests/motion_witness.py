"""Watches what really reaches the motors: every control input of the simulated robot against the arm's and the hand's limits."""

from __future__ import annotations

from typing import Any

import numpy as np

from kb.grasp import MAX_APERTURE, MAX_FORCE
from sim.controller import CLOSED, GRIP_COLUMN
from sim.panda import LINKS
from sim.recording import Recording

LOWER, UPPER = (np.array([link.range[side] for link in LINKS]) for side in (0, 1))
FASTEST = np.array([link.velocity for link in LINKS])


class MotionWitness:
    """Attached to `World.recorders`, refuses control inputs outside the published limits, whoever asked for them."""

    def __init__(self, world: Any) -> None:
        self.steps = 0
        """Time steps seen."""
        self.phases: set[str] = set()
        self.grips: dict[int, float] = {}
        """Number of the motion -> the largest force that the gripper was allowed while it closed or held [N]."""
        world.recorders.append(self)

    def on_recording(self, recording: Recording) -> None:
        """Checks one phase."""
        if not len(recording):
            return
        controls = recording.controls
        joints, velocities = controls[:, 0:GRIP_COLUMN:3], controls[:, 1:GRIP_COLUMN:3]
        assert np.isfinite(controls).all()
        assert (joints >= LOWER).all()
        assert (joints <= UPPER).all()
        assert (np.abs(velocities) <= 1.01 * FASTEST).all()
        assert (controls[:, GRIP_COLUMN] >= CLOSED).all()
        assert (controls[:, GRIP_COLUMN] <= MAX_APERTURE + 1e-9).all()
        assert recording.grip_force is not None
        assert 0.0 < recording.grip_force <= MAX_FORCE
        if recording.phase in ("close", "lift", "hold", "shake"):
            before = self.grips.get(recording.attempt, 0.0)
            self.grips[recording.attempt] = max(before, recording.grip_force)
        self.steps += len(recording)
        self.phases.add(recording.phase)
