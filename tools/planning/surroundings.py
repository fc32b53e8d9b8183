"""What stands around the target, as points that the hand must not sweep over."""

from __future__ import annotations

import numpy as np

from kb.by_identity import ByIdentity
from kb.percept import PerceivedObject, Percept
from tools.planning.candidate import Array

REACH_OF_HAND = 0.32
"""Objects farther from the target than this can't be met by the hand [m]: half a hand, the lift and a margin."""
POINTS_PER_OBJECT = 300
"""Enough for 7-mm gaps on the surfaces of things this size; the clearance wanted covers the rest."""
OWN_POINTS = 400
"""Observed points of the target that the hand's way is checked against."""
BODY_MARGIN = 0.004
"""Points this far outside the rim's circle belong to a handle [m]."""


def surroundings(percept: Percept, target: str) -> Array:
    """Surface points of the target's neighbours, seen and mirrored, shape (N, 3) [m].

    A camera sees the near side only; things on tables are nearly always symmetric about their vertical axis, so the far
    side is taken as the near one turned by half a turn.
    """
    return _around.get(percept.objects, target, lambda: _surroundings(percept, target))


KEPT = 32
"""Targets whose points are kept."""
_around: ByIdentity[Array] = ByIdentity(KEPT)
_own: ByIdentity[Array] = ByIdentity(KEPT)
_whole: ByIdentity[Array] = ByIdentity(KEPT)


def _surroundings(percept: Percept, target: str) -> Array:
    centre = np.asarray(percept.object(target).position)
    clouds = [
        completed(other)
        for other in percept.objects
        if other.id != target and float(np.linalg.norm(np.asarray(other.position) - centre)) < reach(other)
    ]
    return _fixed(np.concatenate(clouds) if clouds else np.zeros((0, 3)))


def _fixed(points_w: Array) -> Array:
    """The points, which are shared from now on, closed to changes."""
    points_w.flags.writeable = False
    return points_w


def reach(other: PerceivedObject) -> float:
    """Distance of centres within which an object matters [m]."""
    return REACH_OF_HAND + max(other.size) / 2


def completed(other: PerceivedObject) -> Array:
    """Observed points of an object and the same turned half around its vertical axis, shape (N, 3) [m]."""
    return _whole.get((other,), None, lambda: _fixed(_completed(other)))


def _completed(other: PerceivedObject) -> Array:
    points_w = other.surface_points()
    if len(points_w) < 8:
        return box_points(other)
    points_w = thinned(points_w, POINTS_PER_OBJECT)
    turned = points_w.copy()
    turned[:, :2] = 2 * np.asarray(other.position)[:2] - turned[:, :2]
    return np.concatenate([points_w, turned])


def own_points(target: PerceivedObject) -> Array:
    """Observed points of the target, its round body turned to the sides that no camera saw, shape (N, 3) [m].

    Handles stick out of the body and are not turned.
    """
    return _own.get((target,), None, lambda: _fixed(_own_points(target)))


def _own_points(target: PerceivedObject) -> Array:
    points_w = thinned(target.surface_points(), OWN_POINTS)
    rim = target.part("rim")
    axis = rim if rim is not None and rim.radius is not None else None
    if axis is None or axis.radius is None or len(points_w) < 8:
        return points_w
    offset = points_w - np.asarray(axis.centre)
    body = offset[np.hypot(offset[:, 0], offset[:, 1]) < axis.radius + BODY_MARGIN]
    turned = [body @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) for c, s in ((0, 1), (-1, 0), (0, -1))]
    return np.concatenate([points_w, *(cloud + np.asarray(axis.centre) for cloud in turned)])


def thinned(points_w: Array, limit: int) -> Array:
    """At most `limit` evenly chosen points, shape (N, 3)."""
    if len(points_w) <= limit:
        return points_w
    return points_w[np.linspace(0, len(points_w) - 1, limit).astype(int)]


def box_points(other: PerceivedObject) -> Array:
    """Points on the sides and the top of the perceived box, about 15 mm apart, shape (N, 3) [m]."""
    counts = [max(2, int(np.ceil(extent / 0.015)) + 1) for extent in other.size]
    axes = [np.linspace(-0.5, 0.5, n) for n in counts]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    shell = grid[np.isclose(np.abs(grid[:, :2]), 0.5).any(axis=1) | np.isclose(grid[:, 2], 0.5)]
    local = shell * np.asarray(other.size)
    cosine, sine = np.cos(other.yaw), np.sin(other.yaw)
    turned = local.copy()
    turned[:, 0] = cosine * local[:, 0] - sine * local[:, 1]
    turned[:, 1] = sine * local[:, 0] + cosine * local[:, 1]
    return turned + np.asarray(other.position)
