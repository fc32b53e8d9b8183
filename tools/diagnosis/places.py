"""Where things stood before a grasp: does the depth picture still meet them there, or does it see past them?

While something is held, the place that has become empty tells what it is, however alike two things are. Only the points
that were measured before are looked up again, so no object has to be found and no hand to be cut out: whatever hides a
point, the arm included, says nothing about it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from kb.percept import PerceivedObject
from kb.rgbd import RgbdView
from tools.perception.calibrate_view import CalibratedView, calibrate_view

Place = Literal["empty", "occupied", "unseen"]
"""What a look shows of the place where a thing stood."""

LOW = 0.004
"""Points nearer to what the thing stood on are not looked up [m]: table and thing are not told apart there."""
ROOM_SHARE, LEAST, MOST = 0.5, 0.004, 0.020
"""A ray passes through a former point from half of the way on that it then had to the ground, within these limits [m]:
two standard deviations of a pixel's depth, and well beyond a nudge."""
HIDDEN = 0.012
"""Something this much nearer to the camera hides a former point [m]."""
ENOUGH = 40
"""Points that must be seen through or met for a word about a place."""
EMPTY, OCCUPIED = 0.8, 0.5
"""Shares of points seen through from which a place is empty, and up to which it is occupied; measured on 50 attempts: at
least 0.97 where a thing was taken, at most 0.25 where it stayed."""
LEFT = 0.9
"""Share of the lift up to which points are looked up: above it the lower end of a tall thing that is held may hang."""


def places(objects: Iterable[PerceivedObject], views: Iterable[RgbdView], lift: float) -> dict[str, Place]:
    """What the pictures show of the places where things stood.

    Args:
        objects: Things as they were perceived before, with their surface points.
        views: Pictures taken since.
        lift: How far what is held was raised [m].

    Returns:
        Perceived id -> place. "unseen" where too little is seen, or neither is clear.
    """
    ready = [calibrate_view(view) for view in views]
    return {thing.id: _judged([_counted(thing, view, lift) for view in ready]) for thing in objects}


@dataclass(frozen=True)
class _Count:
    """What one picture shows of a thing's former points."""

    past: int = 0
    """Points that it sees past."""
    met: int = 0
    """Points that it still meets."""
    lost: int = 0
    """Points of glass without a depth, in a picture whose noise loses glass: no evidence for an empty place."""


def _judged(counts: list[_Count]) -> Place:
    past, met, lost = (sum(getattr(count, name) for count in counts) for name in ("past", "met", "lost"))
    if past + met < ENOUGH:
        return "unseen"
    if past <= OCCUPIED * (past + met):
        return "occupied"
    return "empty" if past >= EMPTY * (past + met + lost) else "unseen"


def _counted(thing: PerceivedObject, view: CalibratedView, lift: float) -> _Count:
    """Former points of a thing in one picture."""
    points, base = thing.surface_points(), thing.base_z
    points = points[(points[:, 2] > base + LOW) & (points[:, 2] < base + LEFT * lift)]
    column, row, depth = view.project(points)
    height, width = view.depth.shape
    u, v = np.rint(column).astype(np.intp), np.rint(row).astype(np.intp)
    inside = (u >= 0) & (u < width) & (v >= 0) & (v < height) & (depth > 0)
    points, depth, u, v = points[inside], depth[inside], u[inside], v[inside]
    now = view.depth[v, u].astype(np.float64)
    tolerance, told = _tolerance(points, depth, view, base)
    bare = (now > 0) & (depth - now <= HIDDEN * view.noise)
    seen = told & bare
    past = seen & (now - depth > tolerance)
    # In bad light hardly a pixel on glass is measured, and those that are lie on what stands behind it.
    lost = int((now <= 0).sum()) if thing.transparent and view.noise > 1.0 else 0
    return _Count(int(past.sum()), int((seen & ~past).sum()), lost)


def _tolerance(
    points: NDArray[np.float64], depth: NDArray[np.float64], view: CalibratedView, base: float
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Excess depth [m] from which a ray has passed a point, and whether it has the room to show that much."""
    eye = float(view.pose[2, 3])
    room = depth * (eye - base) / np.maximum(eye - points[:, 2], 1e-3) - depth
    least = LEAST * view.noise
    return np.clip(ROOM_SHARE * room, least, max(least, MOST)), ROOM_SHARE * room >= least


def rests_on(thing: PerceivedObject, carrier: PerceivedObject) -> bool:
    """Whether a thing stood on or in another, so that it leaves its place with it."""
    reach = 0.5 * math.hypot(carrier.size[0], carrier.size[1])
    return thing.base_z > carrier.base_z + LOW and math.dist(thing.position[:2], carrier.position[:2]) < reach
