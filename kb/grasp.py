"""The grasp action g = (p, d, psi, w, f, tau) with its execution fields (h, v) (Sec. III; ledger G2).

Frame: the world frame, which is the robot's base frame (x to the front, y to the left, z up); the table's top is z = 0.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from kb.base import Finite, Noun, Vec3
from kb.vocabulary import GraspType, ProvenanceSource

MAX_APERTURE = 0.080
"""Opening of the Panda hand [m] (Franka hand datasheet: 80 mm stroke)."""
MIN_FORCE, MAX_FORCE = 1.0, 70.0
"""Continuous grasp force of the Panda hand per finger [N] (ledger G4)."""
DEFAULT_STANDOFF = 0.10
"""Pre-grasp stand-off h along the approach [m] (ledger G2)."""
FULL_SPEED = 0.25
"""Linear speed of the tool point for velocity scale v = 1 [m/s] (ledger G2)."""

GraspField = Literal["position", "approach", "yaw", "aperture", "force", "type", "standoff", "speed"]
"""The fields of a grasp that carry provenance."""


class Grasp(Noun):
    """One grasp, in the world frame."""

    position: Vec3
    """Point between the finger pads at closing [m] (tool centre point, shape (3,))."""
    approach: Vec3
    """Unit vector d along which the hand arrives (pointing from the palm to the fingertips)."""
    yaw: Finite
    """World azimuth psi of the closing axis [rad]: the axis is (cos psi, sin psi, 0) made perpendicular to `approach`."""
    aperture: Annotated[float, Field(ge=0.0, le=MAX_APERTURE)]
    """Opening w before closing [m]."""
    force: Annotated[float, Field(ge=MIN_FORCE, le=MAX_FORCE)]
    """Normal force f per finger [N]."""
    type: GraspType
    standoff: Annotated[float, Field(ge=0.02, le=0.20)] = DEFAULT_STANDOFF
    """Distance h of the pre-grasp pose, back along `approach` [m]."""
    speed: Annotated[float, Field(ge=0.1, le=1.0)] = 1.0
    """Velocity scale v; 1 is `FULL_SPEED`."""

    def closing_axis(self) -> NDArray[np.float64]:
        """Unit closing axis in the world frame, shape (3,), perpendicular to `approach`."""
        return closing_axis(self.approach, self.yaw)

    def rotation(self) -> NDArray[np.float64]:
        """Rotation hand-to-world, shape (3, 3): columns x (across the fingers), y (closing axis), z (approach)."""
        return _rotation(self.approach, self.yaw).copy()


@lru_cache(maxsize=256)
def _rotation(approach: Vec3, yaw: float) -> NDArray[np.float64]:
    """`Grasp.rotation`; planning, execution and diagnosis ask for the same few over and over."""
    y, z = closing_axis(approach, yaw), _unit(approach)
    (y0, y1, y2), (z0, z1, z2) = y.tolist(), z.tolist()
    # The cross product y x z, written out: numpy's own costs more than everything else here.
    return np.array([[y1 * z2 - y2 * z1, y0, z0], [y2 * z0 - y0 * z2, y1, z1], [y0 * z1 - y1 * z0, y2, z2]])


def closing_axis(approach: Vec3 | NDArray[np.float64], yaw: float) -> NDArray[np.float64]:
    """The unit vector nearest to the horizontal direction `yaw` [rad] that is perpendicular to `approach`, shape (3,).

    If the two directions coincide (within 1e-6) the horizontal perpendicular of `approach` is returned.
    """
    d = _unit(approach)
    horizontal = np.array([math.cos(yaw), math.sin(yaw), 0.0])
    axis = horizontal - d * (horizontal @ d)
    length = math.sqrt(axis.dot(axis))
    if length < 1e-6:
        axis, length = np.array([-d[1], d[0], 0.0]), float(np.hypot(d[0], d[1]))
    return axis / length


def _unit(direction: Vec3 | NDArray[np.float64]) -> NDArray[np.float64]:
    """The direction (3,) at length 1; `numpy.linalg.norm` takes three times as long for the same number."""
    vector = np.asarray(direction, float)
    return vector / math.sqrt(vector.dot(vector))


class Provenance(Noun):
    """Where one value of a grasp comes from."""

    source: ProvenanceSource
    id: str
    """What exactly: an experience's id, a constraint ("collision:obj_1"), a rule ("widest clearance")."""
    value: Any
    """The value this source gave or the change it made."""


class Quality(Noun):
    """The seven factors of Eq. (2) and their weighted sum."""

    q: float
    phi: tuple[float, float, float, float, float, float, float]
