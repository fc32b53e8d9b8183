"""A place to grip, found by geometry alone, and the numbers of the hand that decide where the fingers fit."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from kb.base import Vec3
from kb.experience import ApproachClass
from kb.grasp import MAX_APERTURE
from kb.percept import PerceivedObject
from kb.vocabulary import GraspType, Region
from sim.hand import PALM_ABOVE_TCP, TIP_BEYOND_TCP

Array = NDArray[np.float64]

TIP_REACH = TIP_BEYOND_TCP
"""How far the fingertips reach beyond the tool point along the approach [m] (pads are 17.8 mm long around it)."""
PAD_HALF_WIDTH = 0.0105
"""Half the width of a finger across the closing axis [m]."""
PALM_DEPTH = PALM_ABOVE_TCP
"""From the palm to the tool point along the approach [m]: the tips are 46 mm below the palm (ledger G39)."""
PALM_HALF_WIDTH = 0.0235
"""Half the palm's front part across the closing axis [m]."""
FINGER_THICKNESS = 0.0145
"""Finger along the closing axis [m]: what a finger needs beside the object."""
TABLE_MARGIN = 0.0025
"""Smallest distance of the fingertips from the table [m]."""
PALM_MARGIN = 0.004
"""Room left between the palm and the top of the object [m]; covers the error of the perceived height."""
WIDEST_GRIP = 0.072
"""Widest place that is gripped when a narrower one exists [m]: leaves 4 mm a side (perception.md)."""
TOP_LIMIT, SIDE_LIMIT = math.radians(20.0), math.radians(65.0)
"""Tilts that bound the approach classes [rad] (kb.experience.ApproachClass)."""

DOWNWARD = -0.7
"""Height of an approach's unit vector below which it points down: the pads then hold what stands above the fingertips."""


@dataclass(frozen=True)
class Candidate:
    """Where and how the hand could close, before force, opening and constraints are decided."""

    name: str
    """Stable over looks: place, direction and azimuth relative to the object where it has an axis."""
    region: Region
    type: GraspType
    position: Vec3
    """Tool point at closing, world frame [m]."""
    approach: Vec3
    """Unit vector along which the hand arrives."""
    yaw: float
    """World azimuth of the closing axis [rad]."""
    width: float
    """Estimated width between the pads [m]."""
    room: float = MAX_APERTURE
    """Largest opening with which both fingers still fit at this place [m]."""
    miss: float = 0.0
    """Distance of the tool point from the best point of the region [m]."""
    depth: float = 0.5
    """Height of the tool point above the object's base over the object's height."""
    merit: float = 0.0
    """Geometric preference among candidates of the same kind, in [-1, 0]: 0 is the textbook grasp."""

    @cached_property
    def tilt(self) -> float:
        """Angle between the approach and straight down [rad]."""
        return math.acos(max(-1.0, min(1.0, -self.approach[2])))

    @cached_property
    def approach_class(self) -> ApproachClass:
        """Top, tilted or side."""
        return approach_class(self.tilt)

    @property
    def numbers(self) -> tuple[float, ...]:
        """What a score follows from besides words: width, room, miss [m], depth, merit, tilt [rad], the position [m], cosine
        and sine of the yaw, and whether the approach points down (1) or not (0)."""
        downward = 1.0 if self.approach[2] < DOWNWARD else 0.0
        return (
            self.width, self.room, self.miss, self.depth, self.merit, self.tilt, *self.position,
            math.cos(self.yaw), math.sin(self.yaw), downward,
        )  # fmt: skip


def depth_of(subject: PerceivedObject, height: float) -> float:
    """Height of the tool point over the object's base as a share of the object's height, in [0, 1]."""
    return min(1.0, max(0.0, (height - subject.base_z) / max(subject.size[2], 1e-3)))


def approach_class(tilt: float) -> ApproachClass:
    """The class of an approach by its tilt off vertical [rad]."""
    # Half a degree of slack, so that a nominal 20 degrees counts as top on both sides of rounding.
    if tilt <= TOP_LIMIT + 0.009:
        return "top"
    return "tilted" if tilt < SIDE_LIMIT else "side"


def vec3(values: Array | tuple[float, ...] | list[float]) -> Vec3:
    """Three floats as a plain tuple."""
    x, y, z = values.tolist() if isinstance(values, np.ndarray) else values
    return float(x), float(y), float(z)


def horizontal(azimuth: float) -> Array:
    """Unit vector in the table plane, shape (3,)."""
    return np.array([math.cos(azimuth), math.sin(azimuth), 0.0])


def leaning(azimuth: float, tilt: float) -> Vec3:
    """Approach that points down, tilted by `tilt` [rad] towards the horizontal direction `azimuth` [rad]."""
    aside = math.sin(tilt)
    # A zero is added so that no component is a negative zero.
    return math.cos(azimuth) * aside + 0.0, math.sin(azimuth) * aside + 0.0, -math.cos(tilt)


def wrap(angle: float) -> float:
    """The same axis (not direction) as an angle in (-pi/2, pi/2] [rad]."""
    wrapped = math.remainder(angle, math.pi)
    return wrapped if wrapped > -math.pi / 2 else wrapped + math.pi


def degrees(angle: float) -> str:
    """Whole degrees as part of a name."""
    return f"{round(math.degrees(angle)):d}"
