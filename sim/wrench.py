"""What the wrist feels from outside, and the mass it carries: sensor readings less what the hand itself causes.

The hand's weight and inertia are known; the acceleration comes from the joint encoders by forward kinematics.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from sim.build_model import TIMESTEP
from sim.hand import TCP_OFFSET
from sim.panda import hand_com, hand_mass

Array = NDArray[np.float64]

GRAVITY = 9.81
"""[m/s^2]"""
WINDOW = round(0.010 / TIMESTEP)
"""Steps of the 10-ms mean."""


class WristReader:
    """Interprets rows of sensordata. Forces and accelerations are in the hand frame unless a name says `_w`."""

    def __init__(self, sensors: dict[str, slice]) -> None:
        self._force = sensors["robot/wrist_force"]
        self._torque = sensors["robot/wrist_torque"]
        self._pose = sensors["robot/tcp_quaternion"]
        self._hand = sensors["robot/hand_acceleration"]
        self._tool = sensors["robot/tcp_acceleration"]
        self._mass = hand_mass()

    def force(self, rows: Array) -> Array:
        """External force on the hand [N], shape (..., 3), for sensordata rows (..., ns)."""
        # Newton for the hand: external + wrist = mass * (acceleration - gravity); the accelerometer gives the bracket.
        return hand_mass() * rows[..., self._hand] - rows[..., self._force]

    def reader(self, row: Array) -> Callable[[], tuple[float, float, float]]:
        """`force_now` of a row (ns,) that changes, to be asked again and again."""
        mass, hand, force = self._mass, row[self._hand].tolist, row[self._force].tolist

        def now() -> tuple[float, float, float]:
            (ax, ay, az), (fx, fy, fz) = hand(), force()
            return mass * ax - fx, mass * ay - fy, mass * az - fz

        return now

    def force_now(self, row: Array) -> tuple[float, float, float]:
        """`force` of one row (ns,) as plain numbers [N]."""
        mass, (ax, ay, az), (fx, fy, fz) = self._mass, row[self._hand].tolist(), row[self._force].tolist()
        return mass * ax - fx, mass * ay - fy, mass * az - fz

    def mass_now(self, row: Array) -> float:
        """`mass` of one row (ns,) but for rounding [kg]; NaN in free fall."""
        (x, y, z), (px, py, pz) = self.force_now(row), row[self._tool].tolist()
        square = px * px + py * py + pz * pz
        return -(x * px + y * py + z * pz) / square if square > 0.0 else math.nan

    def force_w(self, rows: Array) -> Array:
        """The same in the world frame, for rows (T, ns)."""
        return np.einsum("tij,tj->ti", rotations(rows[:, self._pose]), self.force(rows))

    def torque(self, rows: Array) -> Array:
        """External torque about the tool point [N m], shape (T, 3), for rows (T, ns); exact at rest."""
        hand = np.cross(np.array(hand_com()), hand_mass() * rows[:, self._hand])
        lever = np.array([0.0, 0.0, TCP_OFFSET])
        return hand - rows[:, self._torque] - np.cross(lever, self.force(rows))

    def mass(self, rows: Array) -> Array:
        """Mass that hangs on the hand [kg], shape (T,): the part of the force that its weight and inertia explain."""
        pull = rows[:, self._tool]
        return -np.einsum("ti,ti->t", self.force(rows), pull) / np.einsum("ti,ti->t", pull, pull)


def rotations(quaternions: Array) -> Array:
    """Rotation matrices (T, 3, 3) of unit quaternions w, x, y, z (T, 4)."""
    w, x, y, z = quaternions.T
    return np.stack(
        [
            np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], -1),
            np.stack([2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)], -1),
            np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], -1),
        ],
        -2,
    )


def moving_mean(values: Array, window: int = WINDOW) -> Array:
    """Means of `window` neighbours of values (T, ...), shape (T - window + 1, ...); all of them if there are fewer."""
    if len(values) <= window:
        return values.mean(axis=0, keepdims=True)
    total = np.cumsum(np.concatenate([np.zeros((1, *values.shape[1:])), values]), axis=0)
    return (total[window:] - total[:-window]) / window


def largest_force(force: Array) -> float:
    """Largest length of the 10-ms mean of forces (T, 3) [N]."""
    return float(np.linalg.norm(moving_mean(force), axis=1).max())
