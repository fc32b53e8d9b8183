"""Can the arm make a grasp's straight approach and vertical lift, and with which joint angles?

One grasp costs a few milliseconds. Both ways round of the hand, up to four arm configurations and samples of the last
joint are tried; a solution must reach the pre-grasp, every point of the approach and of the lift without a jump, keep the
limits, and keep the arm's links off the table.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from kb.grasp import Grasp
from sim.arm_shape import stands_free, table_clearance
from sim.hand import FULL_LIFT
from sim.kinematics import (
    LIMIT_MARGIN,
    closed_forms,
    flanges,
    flipped,
    forward,
    grasp_pose,
    inverse_many,
    pose_error,
    refine,
)
from sim.panda import Q_MAX, Q_MIN, READY

Array = NDArray[np.float64]

Q7_SAMPLES = np.linspace(-2.75, 2.75, 23)
"""Sampled last joint angles [rad]."""
APPROACH_KNOTS, LIFT_KNOTS = 9, 9
MAX_JUMP = 0.30
"""Largest change of a joint between neighbouring path samples [rad]."""
START_MARGIN = 0.08
"""Distance from the joint limits that a grasp configuration keeps [rad]."""
LEAST_LIFT = 0.13
"""Lift that is accepted where the arm can do no more [m]: success asks for 10 cm, and an object may slip 2 cm."""
TRIES = 24
"""Configurations whose lines are followed before giving up, best cost first."""
LINK_CLEARANCE = 0.005
"""Distance that the arm's links keep from the table [m]."""
COST = np.array([1.0, 1.0, 1.0, 1.0, 0.5, 0.5, 0.3])
"""Weights of joint distances: the wrist is cheap to turn."""


@dataclass(frozen=True)
class Reach:
    """Joint angles for one grasp, from the pre-grasp through the grasp to the top of the lift."""

    joints: Array
    """At the grasp [rad], shape (7,)."""
    approach: Array
    """From the pre-grasp to the grasp, evenly spaced along the line, shape (K, 7)."""
    lift: Array
    """From the grasp straight up, evenly spaced, shape (K, 7)."""
    height: float
    """Height of the lift [m]."""
    cost: float
    """Weighted squared joint distance from the start and the ready pose [rad^2]."""
    residual: float = 0.0
    """Error of the closed-form solution at the grasp [m]."""

    @property
    def pregrasp(self) -> Array:
        """Joint angles at the pre-grasp (7,)."""
        return self.approach[0]


@dataclass(frozen=True)
class Unreachable:
    """No configuration makes the motion."""

    measured: float | Callable[[], float]
    """`residual`, or what reckons it."""
    reason: str
    """"grasp", "approach" or "lift": the first part that cannot be reached; "table": an arm link would touch it."""

    @cached_property
    def residual(self) -> float:
        """Distance of the nearest possible tool pose from the wanted one [m] (0 if only the path is impossible); planning
        never asks for it."""
        return self.measured() if callable(self.measured) else self.measured


def solve_reach(grasp: Grasp, start: Array | None = None, *, lift: float = FULL_LIFT) -> Reach | Unreachable:
    """The best way to make a grasp, or why there is none.

    Args:
        grasp: The grasp.
        start: Joint angles from which the arm comes [rad], shape (7,); the ready pose if left out.
        lift: Height of the lift [m].
    """
    found = solve_reaches(grasp, start, lift=lift, options=1)
    return found[0] if isinstance(found, tuple) else found


def solve_reaches(
    grasp: Grasp, start: Array | None = None, *, lift: float = FULL_LIFT, options: int = 3
) -> tuple[Reach, ...] | Unreachable:
    """Up to `options` ways to make a grasp, best first and different from each other, or why there is none.

    Where the arm cannot lift as high as wanted, `LEAST_LIFT` is enough.
    """
    start = READY if start is None else np.asarray(start, float)
    # Whatever else a grasp says, only these decide; planning, its alternatives and the robot ask for the same ways again.
    key = (grasp.position, grasp.approach, grasp.yaw, grasp.standoff, start.tobytes(), lift, options)
    known = _known.get(key)
    if known is None:
        while len(_known) >= KEPT:
            _known.pop(next(iter(_known)), None)
        known = _known[key] = _solve(grasp, start, lift, options)
    return known


KEPT = 256
"""Answers that are kept."""
_known: dict[tuple[object, ...], tuple[Reach, ...] | Unreachable] = {}


def _solve(grasp: Grasp, start: Array, lift: float, options: int) -> tuple[Reach, ...] | Unreachable:
    poses = (grasp_pose(grasp), flipped(grasp_pose(grasp)))
    ranked = list(_ranked(poses, start))
    if not ranked:
        return Unreachable(lambda: _residual(poses, start), "grasp")
    result: tuple[Reach, ...] | Unreachable = Unreachable(0.0, "lift")
    for height in _heights(lift):
        if any(_exists(pose, height, start) for pose in poses):
            result = _search(grasp, ranked, height, options)
            if not isinstance(result, Unreachable) or result.reason != "lift":
                return result
    return result


def _heights(lift: float) -> list[float]:
    """Lifts that are tried, highest first [m]: what is wanted, the usual one, and the least."""
    return list(dict.fromkeys((lift, min(lift, FULL_LIFT), min(lift, LEAST_LIFT))))


def _exists(pose: Array, height: float, start: Array) -> bool:
    """Whether the tool pose `height` [m] above `pose` can be reached at all: rules out most hopeless searches."""
    raised = pose.copy()
    raised[2, 3] += height
    # The last joint's middle range reaches most poses.
    return any(len(inverse_many(raised, Q7_SAMPLES[part], start)) for part in (slice(8, 15), slice(8), slice(15, None)))


def _search(
    grasp: Grasp, ranked: list[tuple[float, Array, Array]], lift: float, options: int
) -> tuple[Reach, ...] | Unreachable:
    """Follows the lines of the ranked configurations until `options` ways are found."""
    found: list[Reach] = []
    failures: list[str] = []
    for cost, joints, pose in ranked[:TRIES]:
        if any(np.abs(other.joints - joints).max() < 0.5 for other in found):
            continue
        result = _follow(grasp, pose, joints, cost, lift)
        if isinstance(result, Reach):
            found.append(result)
            if len(found) >= options:
                break
        else:
            failures.append(result)
    if found:
        return tuple(found)
    return Unreachable(0.0, max(set(failures), key=failures.count))


def reach_from(grasp: Grasp, joints: Array, *, lift: float = FULL_LIFT) -> Reach | Unreachable:
    """The motion through given joint angles at the grasp, as a plan stored them (shape (7,))."""
    joints = np.asarray(joints, float)
    pose = forward(joints)
    wanted = grasp_pose(grasp)
    error = min(
        (pose_error(option, pose) for option in (wanted, flipped(wanted))), key=lambda e: float(np.abs(e).max())
    )
    distance = float(np.linalg.norm(error[:3]))
    if distance > 1e-3 or float(np.linalg.norm(error[3:])) > 1e-2:
        return Unreachable(distance, "grasp")
    result: Reach | str = "lift"
    for height in _heights(lift):
        if (result := _follow(grasp, pose, joints, 0.0, height)) != "lift":
            break
    return result if isinstance(result, Reach) else Unreachable(0.0, result)


def line(pose: Array, offsets: Array, joints: Array, *, q7_drift: float = 0.0) -> Array | None:
    """Joint angles along a straight line of tool positions with a fixed orientation, or None.

    Args:
        pose: Tool pose at the line's beginning (4, 4).
        offsets: Displacements from it in the world frame [m], shape (K, 3), the first one usually zero.
        joints: Configuration to be continuous with at the beginning (7,).
        q7_drift: Change of the last joint over the line [rad]: opens lines that no constant angle allows.
    """
    path = np.empty((len(offsets), 7))
    targets = np.repeat(pose[None], len(offsets), axis=0)
    targets[:, :3, 3] = pose[:3, 3] + offsets
    last = joints
    for index, flange in enumerate(flanges(targets)):
        q7 = joints[6] + q7_drift * index / (len(offsets) - 1)
        solutions = closed_forms(flange, float(q7), last)
        best, least = -1, np.inf
        # A row that is no solution is not a number, which is less than nothing.
        for number, jump in enumerate(np.maximum.reduce(np.abs(solutions - last), axis=1).tolist()):
            if jump < least:
                best, least = number, jump
        if least > MAX_JUMP:
            return None
        path[index] = last = solutions[best]
        if not all(map(_inside, last.tolist(), _LOWEST, _HIGHEST)):
            return None
    return path


_LOWEST, _HIGHEST = (Q_MIN + LIMIT_MARGIN).tolist(), (Q_MAX - LIMIT_MARGIN).tolist()


def _inside(angle: float, low: float, high: float) -> bool:
    return low < angle < high


DRIFTS = (0.0, 0.5, -0.5, 1.0, -1.0)
"""Changes of the last joint tried along a line [rad]."""


def line_any(pose: Array, offsets: Array, joints: Array) -> Array | None:
    """`line` with the last joint turning along the line as far as needed, or None."""
    for drift in DRIFTS:
        path = line(pose, offsets, joints, q7_drift=drift)
        if path is not None:
            return path
    return None


def descents(pose: Array, start: Array, height: float, below: float) -> Iterator[Array]:
    """Straight ways down (K, 7) from `height` [m] above a tool pose to `below` [m] under it, nearest to `start` first."""
    up = np.array([0.0, 0.0, 1.0])
    offsets = np.linspace(height, -below, LIFT_KNOTS + 2)[:, None] * up
    tried = 0
    for _, joints, wanted in _ranked((pose,), start):
        back = line_any(wanted, np.linspace(0.0, height, 6)[:, None] * up, joints)
        if back is None:
            continue
        if (path := line_any(wanted, offsets, back[-1])) is not None and stands_free(path):
            yield path
            tried += 1
            if tried >= 3:
                return


_APPROACH_SHARES, _LIFT_SHARES = np.linspace(0, 1, APPROACH_KNOTS)[:, None], np.linspace(0, 1, LIFT_KNOTS)[:, None]
_UP = np.array([0.0, 0.0, 1.0])


def _follow(grasp: Grasp, pose: Array, joints: Array, cost: float, lift: float) -> Reach | str:
    """The whole motion through one configuration, or the part that fails."""
    direction = np.asarray(grasp.approach) / np.linalg.norm(grasp.approach)
    back = line_any(pose, -grasp.standoff * _APPROACH_SHARES * direction, joints)
    if back is None:
        return "approach"
    up = line_any(pose, lift * _LIFT_SHARES * _UP, joints)
    if up is None:
        return "lift"
    if table_clearance(np.concatenate([back[[0, APPROACH_KNOTS // 2, -1]], up[:1]])) < LINK_CLEARANCE:
        return "table"
    residual = float(np.linalg.norm(forward(joints)[:3, 3] - pose[:3, 3]))
    return Reach(joints, back[::-1].copy(), up, lift, cost, residual)


def _ranked(poses: tuple[Array, ...], start: Array) -> Iterator[tuple[float, Array, Array]]:
    """Grasp configurations with their pose, cheapest first."""
    everything: list[tuple[float, Array, Array]] = []
    for pose in poses:
        solutions = inverse_many(pose, Q7_SAMPLES, start, START_MARGIN)
        if len(solutions):
            costs = _cost(solutions, start)
            everything.extend((float(cost), joints, pose) for cost, joints in zip(costs, solutions, strict=True))
    everything.sort(key=lambda item: item[0])
    yield from everything


def _cost(joints: Array, start: Array) -> Array:
    """Squared distance from the start and from the ready pose, plus a price for nearness to the limits; shape (K,)."""
    from_start = (COST * (joints - start) ** 2).sum(axis=1)
    from_ready = (COST * (joints - READY) ** 2).sum(axis=1)
    margin = np.minimum(joints - Q_MIN, Q_MAX - joints)
    return 0.5 * from_start + 0.5 * from_ready + (np.maximum(0.35 - margin, 0.0) ** 2).sum(axis=1) * 10.0


def _residual(poses: tuple[Array, ...], start: Array) -> float:
    """How far the nearest possible tool pose is from the wanted one [m], by descent from start and ready pose."""
    turned = start.copy()
    turned[0] = np.clip(np.arctan2(poses[0][1, 3], poses[0][0, 3]), Q_MIN[0] + 0.1, Q_MAX[0] - 0.1)
    return min(refine(pose, turned, steps=40)[1] for pose in poses)
