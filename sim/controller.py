"""From joint samples to the control inputs of the motors, one row a time step.

Columns: for each joint position [rad], velocity [rad/s] and feed-forward torque [N m], then the gripper's opening [m].
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sim.build_model import TIMESTEP
from sim.curve import cubic_spline, quintic
from sim.panda import GRIP_KP, Q_VELOCITY

Array = NDArray[np.float64]

COLUMNS = 22
GRIP_COLUMN = 21
CLOSED = -0.04
"""Commanded opening [m] while closing: so far beyond zero that the motor presses with its force limit at any width."""
SQUEEZE = 0.010
"""How much farther than the force limit needs the opening is commanded while holding [m]: the force stays full while
the object gives way by as much, and letting go starts without delay."""

JOINT_SHARE = 0.98
"""Share of a joint's published velocity limit that a straight motion of the hand may ask for."""


def holding_command(opening: float, force: float) -> float:
    """Commanded opening [m] that keeps pressing with `force` [N] at a measured opening."""
    return max(CLOSED, opening - force / GRIP_KP - SQUEEZE)


def follow(joints: Array, opening: float, before: Array | None = None) -> Array:
    """Controls (T, 22) that follow joint samples (T, 7), one per time step, with their velocities fed forward.

    Args:
        joints: Wanted joint angles after each step [rad].
        opening: Commanded opening of the gripper [m].
        before: Joint angles before the first sample (7,); the first sample if left out.
    """
    first = joints[:1] if before is None else np.asarray(before)[None]
    extended = np.concatenate([first, joints, joints[-1:]])
    controls = np.zeros((len(joints), COLUMNS))
    controls[:, 0:GRIP_COLUMN:3] = joints
    controls[:, 1:GRIP_COLUMN:3] = (extended[2:] - extended[:-2]) / (2.0 * TIMESTEP)
    controls[:, GRIP_COLUMN] = opening
    return controls


def hold(joints: Array, opening: float, seconds: float) -> Array:
    """Controls that stay at one configuration (7,)."""
    return follow(np.repeat(np.asarray(joints)[None], steps(seconds), axis=0), opening)


def along(path: Array, seconds: float) -> Array:
    """Joint samples per time step (T, 7) along evenly spaced path points (K, 7) with a quintic time law.

    Takes longer than `seconds` where a joint would have to turn faster than it can: near a fold of the arm a slow hand
    may need a fast joint.
    """
    samples = _along(path, seconds)
    fastest = _fastest(samples)
    return samples if fastest <= JOINT_SHARE else _along(path, seconds * fastest / JOINT_SHARE)


def _fastest(samples: Array) -> float:
    """Largest joint speed of samples, as a share of what the joint can do."""
    return float((np.abs(np.diff(samples, axis=0)).max(axis=0) / (TIMESTEP * Q_VELOCITY)).max())


def _along(path: Array, seconds: float) -> Array:
    return cubic_spline(np.linspace(0.0, 1.0, len(path)), path, quintic(steps(seconds)))


def part(path: Array, first: float, last: float, count: int = 13) -> Array:
    """Evenly spaced points (count, 7) of a path (K, 7) between two shares of its length in [0, 1]."""
    return cubic_spline(np.linspace(0.0, 1.0, len(path)), path, np.linspace(first, last, count))


def along_steadily(path: Array, seconds: float, ramp: float) -> Array:
    """As `along`, at one speed but for smooth ramps at both ends, for going where something may be met.

    Args:
        path: Evenly spaced path points (K, 7).
        seconds: What it would take at that speed throughout; it takes `ramp` longer.
        ramp: Time in which it gets up to speed, and in which it comes to rest [s].
    """
    samples = _steadily(path, seconds, ramp)
    fastest = _fastest(samples)
    return samples if fastest <= JOINT_SHARE else _steadily(path, seconds * fastest / JOINT_SHARE, ramp)


def _steadily(path: Array, seconds: float, ramp: float) -> Array:
    # The integral of a speed that rises from 0 to 1 as the quintic does: half of the ramp is lost at each end.
    speed = np.ones(steps(seconds + ramp))
    rise = quintic(min(steps(ramp), len(speed) // 2))
    speed[: len(rise)], speed[len(speed) - len(rise) :] = rise, rise[::-1]
    way = np.cumsum(speed)
    return cubic_spline(np.linspace(0.0, 1.0, len(path)), path, way / way[-1])


def along_evenly(path: Array, seconds: float) -> Array:
    """The same at constant speed, for creeping until something is touched."""
    count = steps(seconds)
    return cubic_spline(np.linspace(0.0, 1.0, len(path)), path, np.arange(1, count + 1) / count)


def steps(seconds: float) -> int:
    """Number of time steps in a duration, at least two."""
    return max(2, math.ceil(seconds / TIMESTEP - 1e-9))
