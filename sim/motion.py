"""Free joint-space motions: smooth, within the Panda's limits, and clear of what has been perceived.

Obstacles are upright boxes around perceived objects. A motion is a cubic spline through via points, run by a quintic time
law, so position, velocity and acceleration are continuous and both ends are at rest.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kb.base import Vec3
from sim.arm_shape import RADII, carried_points, own_arm_clearance, setting_clearance, spheres
from sim.curve import cubic_spline, path_time, quintic
from sim.kinematics import forward, tcp_poses
from sim.panda import Q_MAX, Q_MIN, READY
from sim.reach import line

Array = NDArray[np.float64]

MARGIN = 0.015
"""Distance kept from obstacles where start and goal allow it [m]."""
SLACK = 1e-3
"""How much closer than start and goal a path may come to an obstacle that these are already near to [m]."""
CARRIED_RADIUS = 0.03
"""Radius given to the points of a held object, whose outline the robot does not feel [m]."""
CHECKS = 28
"""Checked configurations per path."""
QUICK = 2.0
"""A detour that takes less than this is taken without looking for a quicker one [s]."""
RAISES = (0.06, 0.12, 0.22, 0.32)
"""Heights of via points above start and goal [m]."""

ASIDE_SPREAD = 0.6
"""How far aside of the direct path via points are strewn in each joint [rad]."""
ASIDE_SEED = 5
LIMIT_ROOM = 0.05
"""Distance of such a via point from the joint limits [rad]."""


@dataclass(frozen=True)
class Obstacle:
    """An upright box around something perceived."""

    centre: Vec3
    """[m]"""
    yaw: float
    """Azimuth of its first axis [rad]."""
    half: Vec3
    """Half sizes along first axis, second axis and z [m]."""


@dataclass(frozen=True)
class Transit:
    """A free motion between two configurations at rest."""

    path: Array
    """Evenly spaced samples of the spline, shape (K, 7) [rad]."""
    duration: float
    """[s]"""
    clearance: float
    """Smallest distance to anything on the way [m]."""
    vias: int
    """Number of via points that were needed."""

    def samples(self, timestep: float, slow: float = 1.0) -> Array:
        """Joint positions per time step, shape (T, 7), `slow` <= 1 scaling the speed."""
        count = max(2, math.ceil(self.duration / slow / timestep))
        return cubic_spline(np.linspace(0, 1, len(self.path)), self.path, quintic(count))


def clearances(joints: Array, obstacles: Sequence[Obstacle], carried: Array | None = None) -> Array:
    """Smallest distance [m] of configurations (N, 7) to the setting (column 0) and to each obstacle; (N, 1 + B).

    `carried` are points (P, 3) of a held object in the hand frame, given the radius `CARRIED_RADIUS`; with them a last
    column tells how far they are from the robot's own arm, (N, 2 + B).
    """
    centres, radii, own = spheres(joints), RADII, None
    out = np.empty((len(centres), 1 + len(obstacles)))
    out[:, 0] = setting_clearance(centres)
    if carried is not None and len(carried):
        load = carried_points(joints, carried)
        out[:, 0] = np.minimum(out[:, 0], load[..., 2].min(axis=1))
        centres = np.concatenate([centres, load], axis=1)
        radii = np.concatenate([radii, np.full(load.shape[1], CARRIED_RADIUS)])
        own = own_arm_clearance(joints, load, CARRIED_RADIUS)
    for column, box in enumerate(obstacles, start=1):
        cos, sin = math.cos(box.yaw), math.sin(box.yaw)
        x, y = centres[..., 0] - box.centre[0], centres[..., 1] - box.centre[1]
        dx = np.abs(cos * x + sin * y) - box.half[0]
        dy = np.abs(cos * y - sin * x) - box.half[1]
        dz = np.abs(centres[..., 2] - box.centre[2]) - box.half[2]
        inside = np.minimum(np.maximum(np.maximum(dx, dy), dz), 0.0)
        outside = np.sqrt(np.maximum(dx, 0) ** 2 + np.maximum(dy, 0) ** 2 + np.maximum(dz, 0) ** 2)
        out[:, column] = (outside + inside - radii).min(axis=1)
    return out if own is None else np.column_stack([out, own])


def plan_transit(
    start: Array,
    goal: Array,
    obstacles: Sequence[Obstacle] = (),
    *,
    carried: Array | None = None,
    margin: float = MARGIN,
    tilt: float | None = None,
    aside: int = 0,
) -> Transit | None:
    """A free path from start to goal, or None if neither the direct one nor any with via points above is free.

    Args:
        start: Joint angles at rest [rad], shape (7,).
        goal: Joint angles to arrive at [rad], shape (7,).
        obstacles: What to keep away from; table and the robot's own base are always kept away from.
        carried: Points of a held object in the hand frame [m], shape (P, 3).
        margin: Distance to keep [m]. Where start or goal are closer than that to an obstacle, the path may be too.
        tilt: How far the way may tip what hangs upright at the start [rad]; None: as far as it likes.
        aside: How many via points anywhere near the direct path are tried where those above are of no use; the first that
            is free is taken.
    """
    required = _required(start, goal, obstacles, carried, margin)
    direct = _free(np.stack([start, goal]), required, obstacles, carried, tilt)
    if direct is not None:
        return direct
    best: Transit | None = None
    for vias in via_points(start, goal):
        found = _free(np.stack([start, *vias, goal]), required, obstacles, carried, tilt)
        if found is not None and (best is None or found.duration < best.duration):
            best = found
        if best is not None and (best.duration < QUICK or len(vias) > best.vias):
            return best
    if best is None:
        ways = (
            _free(np.stack([start, via, goal]), required, obstacles, carried, tilt)
            for via in _aside(start, goal, aside)
        )
        best = next((way for way in ways if way is not None), None)
    return best


def plan_direct(
    start: Array, goal: Array, obstacles: Sequence[Obstacle] = (), *, margin: float = MARGIN
) -> Transit | None:
    """The direct path if it is free: cheap, to choose among several goals."""
    required = _required(start, goal, obstacles, None, margin)
    return _free(np.stack([start, goal]), required, obstacles, None)


def free_motion(
    knots: Array, obstacles: Sequence[Obstacle], *, carried: Array | None, margin: float, tilt: float | None
) -> Transit | None:
    """The motion through joint knots (K, 7) if it is free; the other arguments as those of `plan_transit`."""
    required = _required(knots[0], knots[-1], obstacles, carried, margin)
    return _free(knots, required, obstacles, carried, tilt)


def _required(start: Array, goal: Array, obstacles: Sequence[Obstacle], carried: Array | None, margin: float) -> Array:
    """Distance to keep from the setting and from each obstacle (1 + B,) [m]."""
    ends = clearances(np.stack([start, goal]), obstacles, carried)
    return np.minimum(margin, ends.min(axis=0) - SLACK)


def _free(
    knots: Array,
    required: Array,
    obstacles: Sequence[Obstacle],
    carried: Array | None,
    tilt: float | None = None,
) -> Transit | None:
    """The motion through the knots if it keeps the required distances and tips the load by no more than `tilt` [rad].

    A spline may swing beyond its knots, and so beyond the joints' limits.
    """
    path = _spline(knots)
    if (path < np.minimum(Q_MIN, knots.min(axis=0))).any() or (path > np.maximum(Q_MAX, knots.max(axis=0))).any():
        return None
    if tilt is not None and float(tilts(path).max()) > tilt:
        return None
    distance = clearances(path, obstacles, carried)
    if (distance < required).any():
        return None
    return Transit(path, path_time(path), float(distance.min()), len(knots) - 2)


def tilts(path: Array) -> Array:
    """How far something held upright at the first of the configurations (K, 7) is tipped at each of them [rad], (K,)."""
    turns = tcp_poses(path)[:, :3, :3]
    return np.arccos(np.clip(turns[:, 2] @ turns[0, 2], -1.0, 1.0))


def _spline(knots: Array) -> Array:
    """`CHECKS` samples of the spline through the knots, spaced by joint distance."""
    steps = np.maximum(np.linalg.norm(np.diff(knots, axis=0), axis=1), 1e-6)
    at = np.concatenate([[0.0], np.cumsum(steps)])
    return cubic_spline(at, knots, np.linspace(0.0, at[-1], CHECKS))


def via_points(start: Array, goal: Array) -> Iterator[tuple[Array, ...]]:
    """Sequences of via points, from none to detours: above the goal, above both, by way of the ready pose, and aside."""
    yield ()
    above_goal = [raised for raised in (_raised(goal, height) for height in RAISES) if raised is not None]
    above_start = [raised for raised in (_raised(start, height) for height in RAISES) if raised is not None]
    for via in above_goal:
        yield (via,)
    for via in above_start:
        yield (via,)
    for first, second in zip(above_start, above_goal, strict=False):
        yield (first, second)
    middle = READY.copy()
    middle[0] = 0.5 * (start[0] + goal[0])
    yield (middle,)
    for via in above_goal[-1:]:
        yield (middle, via)
        for first in above_start[-1:]:
            yield (first, middle, via)


def _aside(start: Array, goal: Array, count: int) -> Array:
    """Via points (count, 7) [rad] strewn about the direct path, the same ones for the same ends."""
    rng = np.random.default_rng(ASIDE_SEED)
    between = start + rng.uniform(0.0, 1.0, (count, 1)) * (goal - start)
    return np.clip(
        between + rng.uniform(-ASIDE_SPREAD, ASIDE_SPREAD, (count, 7)), Q_MIN + LIMIT_ROOM, Q_MAX - LIMIT_ROOM
    )


def _raised(joints: Array, height: float) -> Array | None:
    """The configuration with the tool `height` [m] higher and the same orientation, continuous with `joints`."""
    offsets = np.linspace(0.0, height, 6)[:, None] * np.array([0.0, 0.0, 1.0])
    path = line(forward(joints), offsets, joints)
    return None if path is None else path[-1]
