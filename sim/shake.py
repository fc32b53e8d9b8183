"""The disturbance after a lift: the hand is rocked by +-15 degrees at 1 Hz about its own x axis, through the tool point."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sim.build_model import TIMESTEP
from sim.curve import cubic_spline
from sim.kinematics import forward, refine, within_limits
from sim.panda import Q_MAX, Q_MIN

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

    If the arm cannot rock the hand about x there, it turns it about its approach by the last joint.
    """
    angle = shake_angle(seconds)
    angles = np.linspace(-ANGLE, ANGLE, KNOTS)
    rocked = rocked_configurations(joints, angles)
    if rocked is None:
        rocked = np.repeat(joints[None], KNOTS, axis=0)
        low, high = Q_MIN[6] + 0.02 + ANGLE, Q_MAX[6] - 0.02 - ANGLE
        rocked[:, 6] += np.clip(joints[6], low, high) - joints[6] + angles
        rocked[KNOTS // 2] = joints
    return cubic_spline(angles, rocked, angle)


def shake_angle(seconds: float) -> Array:
    """The rocking angle [rad] per time step, shape (T,): a sine with smooth ramps."""
    t = np.arange(1, round(seconds / TIMESTEP) + 1) * TIMESTEP
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
