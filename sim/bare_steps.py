"""The steps of some recordings again with nothing around them: what the physics itself costs."""

# MuJoCo ships no type stubs for its compiled functions.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import time
from collections.abc import Sequence

import mujoco

from sim.recording import Recording
from sim.world import World


def bare_steps(world: World, recordings: Sequence[Recording]) -> tuple[float, float]:
    """Processor and wall time [s] of the recordings' steps under their controls, from the world's state now; nobody is told."""
    model, data, step, live = world.model, world.data, mujoco.mj_step, world.data.ctrl
    spent = wall = 0.0
    for recording in recordings:
        if recording.grip_force is not None:
            world.set_grip_force(recording.grip_force)
        controls = recording.controls
        start, began = time.thread_time(), time.perf_counter()
        for row in controls:
            live[:] = row
            step(model, data)
        spent += time.thread_time() - start
        wall += time.perf_counter() - began
    return spent, wall
