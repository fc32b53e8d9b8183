"""Why a finger came down on the object: would it have fitted if centred, or if turned, or not at all?"""

from __future__ import annotations

import math

import numpy as np

from kb.grasp import Grasp
from kb.percept import PerceivedObject
from kb.vocabulary import FailureType
from sim.hand import swept_distances
from sim.quality import FIT_ALLOWANCE
from tools.planning.section import section
from tools.planning.surroundings import own_points

TURNS = tuple(math.radians(a) for a in (30.0, 60.0, 90.0, 120.0, 150.0))
"""Turns of the hand about its approach for which the width is compared [rad]."""
NARROWER = 0.005
"""A turn counts as better if the object is this much narrower there [m]."""
TOUCH = 0.003
"""The swept hand meets the object if a point of it is nearer than this [m]: error of single points."""


def meets(grasp: Grasp, target: PerceivedObject) -> bool:
    """Whether the open hand's way leads into the perceived object."""
    own = swept_distances(grasp, own_points(target), lift=0.0)
    return len(own) > 3 and float(np.partition(own, 2)[2]) < TOUCH


def misfit(grasp: Grasp, target: PerceivedObject) -> FailureType:
    """The failure type of a hand that pressed on the object before closing, from the perceived shape."""
    here = width_at(grasp, target, 0.0)
    if here + FIT_ALLOWANCE <= grasp.aperture:
        return "POSITION_ERROR"
    best = min(width_at(grasp, target, turn) for turn in TURNS)
    if best + FIT_ALLOWANCE <= grasp.aperture and best < here - NARROWER:
        return "ORIENTATION"
    return "WIDTH_MISMATCH"


def width_at(grasp: Grasp, target: PerceivedObject, turn: float) -> float:
    """Width of the perceived object between the fingers, with the hand turned by an angle [m, rad]."""
    yaw = grasp.yaw + turn
    closing = np.array([math.cos(yaw), math.sin(yaw), 0.0])
    low = grasp.position[2] - 0.02
    seen = section(own_points(target), np.asarray(grasp.position), closing, half=0.011, low=low, high=low + 0.05)
    box = box_width(target, yaw)
    # Walls and handles are narrower than their box; a thin scatter of points is no width.
    return box if seen is None else min(box, seen.width)


def box_width(target: PerceivedObject, yaw: float) -> float:
    """Width of a strip of the object's box as wide as a finger, along the azimuth `yaw` [m]."""
    long, short, _ = target.size
    if target.shape in ("sphere", "cylinder", "bowl"):
        return short
    off = abs(math.remainder(yaw - target.yaw - math.pi / 2, math.pi))
    slanted = short / max(math.cos(off), 1e-6) + 0.021 * math.tan(min(off, 1.5))
    return min(long, slanted) if off < math.radians(80) else long
