"""The disturbance after a lift: the hand is rocked by +-15 degrees at 1 Hz about its own x axis, through the tool point.

Where a joint would have to turn faster than it can, the same rocking takes longer.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sim.build_model import TIMESTEP
from sim.controller import JOINT_SHARE
from sim.curve import cubic_spline
from sim.kinematics import forward, refine, within_limits
from sim.panda import Q_MAX, Q_MIN, Q_VELOCITY

Array = NDArray[np.float64]

ANGLE = math.radians(15.0)
FREQUENCY = 1.0
"""Benchmark section 3: wrist +-15 degrees at 1 Hz."""
RAMP_S = 0.5
"""The amplitude grows and fades in this time [s], so that the arm starts and ends at rest."""
KNOTS = 9
FOLLOWED = 1e-3
"""Error of a followed rotation that is accepted [m]."""


def shake_path(joints: Array, seconds: float) -> Array:
    """Joint angles per time step (T, 7) of the shake at one configuration (7,).

    If the arm cannot rock the hand about x there, it turns it about its approach by the last joint. Near a fold of the
    arm a joint may have to turn so fast that all of it is made slower, as `sim.controller.along` does: angles and number
    of turns stay, so that what is held hangs from the grip as it does elsewhere.

    Args:
        joints: Configuration at rest (7,) [rad].
        seconds: Duration where no joint is too slow [s].
    """
    angles = np.linspace(-ANGLE, ANGLE, KNOTS)
    rocked = rocked_configurations(joints, angles)
    if rocked is None:
        rocked = np.repeat(joints[None], KNOTS, axis=0)
        low, high = Q_MIN[6] + 0.02 + ANGLE, Q_MAX[6] - 0.02 - ANGLE
        shift = np.clip(joints[6], low, high) - joints[6]
        # Beside its limit the joint turns less towards it and more away from it: 30 degrees in all.
        rocked[:, 6] += angles + np.abs(angles) / ANGLE * shift
    path = cubic_spline(angles, rocked, shake_angle(seconds))
    fastest = float((np.abs(np.diff(path, axis=0)).max(axis=0) / (TIMESTEP * Q_VELOCITY)).max())
    if fastest <= 1.0:
        return path
    return cubic_spline(angles, rocked, shake_angle(seconds, slower=fastest / JOINT_SHARE))


def shake_angle(seconds: float, slower: float = 1.0) -> Array:
    """The rocking angle [rad] per time step, shape (T,): a sine with smooth ramps.

    Args:
        seconds: Duration [s].
        slower: The same takes this many times as long.
    """
    t = np.arange(1, math.ceil(slower * seconds / TIMESTEP - 1e-9) + 1) * TIMESTEP / slower
    edge = np.clip(np.minimum(t, seconds - t) / RAMP_S, 0.0, 1.0)
    ramp = edge**3 * (10.0 - 15.0 * edge + 6.0 * edge * edge)
    return ANGLE * ramp * np.sin(2.0 * math.pi * FREQUENCY * t)


def rocked_configurations(joints: Array, angles: Array) -> Array | None:
    """Configurations (K, 7) that turn the hand by each of the sorted angles about its x axis, or None."""
    pose = forward(joints)
    out = np.empty((len(angles), 7))
    middle = int(np.abs(angles).argmin())
    for indices in (range(middle, len(angles)), range(middle, -1, -1)):
        last = joints
        for index in indices:
            cos, sin = math.cos(angles[index]), math.sin(angles[index])
            wanted = pose.copy()
            wanted[:3, :3] = pose[:3, :3] @ np.array([[1, 0, 0], [0, cos, -sin], [0, sin, cos]])
            last, error = refine(wanted, last, steps=6, damping=1e-3)
            if error > FOLLOWED:
                return None
            out[index] = last
    return out if within_limits(out, 0.02).all() else None
