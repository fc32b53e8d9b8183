"""Why a finger came down on the object: would it have fitted if centred, or if turned, or not at all?"""

from __future__ import annotations

import math

import numpy as np

from kb.by_identity import ByIdentity
from kb.grasp import Grasp
from kb.percept import PerceivedObject
from kb.vocabulary import FailureType
from sim.quality import FIT_ALLOWANCE
from sim.swept_hand import Passing
from tools.planning.candidate import TIP_REACH, Array
from tools.planning.section import section
from tools.planning.surroundings import own_points

TURNS = tuple(math.radians(a) for a in (30.0, 60.0, 90.0, 120.0, 150.0))
"""Turns of the hand about its approach for which the width is compared [rad]."""
NARROWER = 0.005
"""A turn counts as better if the object is this much narrower there [m]."""
BACK_STEPS = np.arange(0.002, 0.081, 0.003)
"""Distances before the end of the approach at which contact is looked for [m]."""
TABLE_TOUCH = 0.0005
"""Fingertips aimed lower than this meet the table [m]."""
TOUCH = 0.003
"""The swept hand meets the object if a point of it is nearer than this [m]: error of single points."""


def first_contact(grasp: Grasp, points_w: Array, touch: float = TOUCH) -> float | None:
    """How far before the end of the approach the open hand first comes within `touch` of the points [m]; None if never.

    The end itself is 0; the larger, the earlier.
    """
    if points_w.flags.writeable:
        return _first_contact(grasp, points_w, touch)
    # Points that nobody can change are shared: other configurations of a trial ask for the same.
    kept = _contacts.get((points_w,), None, dict[tuple[object, ...], float | None])
    way = grasp.position, grasp.approach, grasp.yaw, grasp.aperture, grasp.standoff, touch
    if way not in kept:
        kept[way] = _first_contact(grasp, points_w, touch)
    return kept[way]


_contacts: ByIdentity[dict[tuple[object, ...], float | None]] = ByIdentity(32)
"""Points -> way of the hand -> where it first met them."""


def _first_contact(grasp: Grasp, points_w: Array, touch: float) -> float | None:
    near = points_w[np.linalg.norm(points_w - np.asarray(grasp.position), axis=1) < 0.3] if len(points_w) else points_w
    if len(near) < 4:
        return None
    passing = Passing(grasp, near)
    # Single points err: two may be nearer.
    if passing.count(touch) < 3:
        return None
    for back in BACK_STEPS.tolist():
        # The way up to `back` before the end: the first part that is free tells where the contact begins.
        if passing.count(touch, back) < 3:
            return back
    return float(BACK_STEPS[-1])


def meets(grasp: Grasp, target: PerceivedObject) -> bool:
    """Whether the open hand's way leads into the perceived object."""
    return first_contact(grasp, own_points(target)) is not None


def table_contact(grasp: Grasp) -> float | None:
    """How far before the end of the approach a fingertip meets the table [m]; None if never."""
    rotation = grasp.rotation()
    reach = (0.5 * grasp.aperture, 0.5 * grasp.aperture + 0.0144)
    corners = [
        rotation @ np.array([x, sign * y, TIP_REACH]) for x in (-0.0089, 0.0089) for y in reach for sign in (-1, 1)
    ]
    lowest = grasp.position[2] + min(float(corner[2]) for corner in corners)
    if lowest >= TABLE_TOUCH or grasp.approach[2] > -0.1:
        return None
    return (TABLE_TOUCH - lowest) / -grasp.approach[2]


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
    kept = _widths.get((target,), None, dict[tuple[object, ...], float])
    place = grasp.position, grasp.yaw, turn
    if place not in kept:
        kept[place] = _width_at(grasp, target, turn)
    return kept[place]


_widths: ByIdentity[dict[tuple[object, ...], float]] = ByIdentity(16)
"""Object -> place and turn of the hand -> width there: asked again after the look that follows a failure."""


def _width_at(grasp: Grasp, target: PerceivedObject, turn: float) -> float:
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
