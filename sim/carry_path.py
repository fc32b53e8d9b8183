"""Ways to carry what is held without tipping it, and the way down to where it is put."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.arm_shape import stands_free
from sim.kinematics import forward, inverse, within_limits
from sim.motion import MARGIN, Obstacle, Transit, free_motion, plan_transit
from sim.reach import MAX_JUMP, descents, line_any

Array = NDArray[np.float64]

CARRY_HEIGHTS = (0.15, 0.10, 0.06)
"""Heights above the set-down pose from which it is lowered [m], the first possible one."""
OVERSHOOT = 0.012
"""How far a set-down feels for the ground below the wanted height [m]."""
UPRIGHT = math.radians(10.0)
"""Tilt of what is carried that the way keeps to where it can [rad]."""
Stages = tuple[tuple[float | None, float], ...]
"""Largest tilt [rad] (None: any) and distance to keep [m] of ways that are looked for, in this order."""
GENTLE: Stages = ((UPRIGHT, MARGIN), (math.radians(25.0), MARGIN), (UPRIGHT, 0.0))
"""Ways on which nothing slips: a wine glass held with 3.6 N slid out of the hand on ways that tipped it by 90 degrees."""
STAGES: Stages = (*GENTLE, (None, MARGIN), (None, 0.0))
"""All ways, the gentle ones first."""
ARC_RAISES = (0.0, 0.06, 0.12)
"""How much higher than its ends an arc is in its middle [m]."""
ARC_KNOTS = 14
WRIST_BENDS = (0.0, 0.5, -0.5)
"""Detours of the last joint in the middle of an arc [rad]."""
WRIST_TURNS = (0.0, 0.4, -0.4, 0.8, -0.8, 1.2, -1.2, 1.7, -1.7, 2.3, -2.3)
"""Changes of the last joint over an arc whose end may be any arm posture [rad]."""
SAME_POSTURE = 0.15
"""Largest difference of a joint between an arc's end and the posture it was to end in [rad]."""
LONG_TURN = 2.6
"""Turns beyond this are tried the other way round, too [rad]."""
TWIST = math.radians(6.0)
"""Two hand poses that differ by more than this besides a turn about the vertical are not joined by an arc [rad]."""


@dataclass(frozen=True)
class WayDown:
    """A free way to above a set-down pose, and the straight way down from there."""

    transit: Transit
    path: Array
    """Joint angles of the way down, evenly spaced, shape (K, 7)."""
    length: float
    """Length of the way down [m], with what it feels for below the pose."""


def carry_way(
    start: Array,
    goal: Array,
    obstacles: Sequence[Obstacle],
    load: Array | None,
    stages: Sequence[tuple[float | None, float]] = STAGES,
) -> Transit | None:
    """A free way between two configurations (7,) that tips what is held as little as can be, or None.

    Args:
        start: Joint angles at rest, holding [rad].
        goal: Joint angles to arrive at [rad].
        obstacles: What to keep away from.
        load: Points of what is held in the hand frame [m], shape (P, 3).
        stages: Tilt and distance of the ways that are tried, in order.
    """
    arcs: list[Array] | None = None
    for tilt, margin in stages:
        direct = free_motion(np.stack([start, goal]), obstacles, carried=load, margin=margin, tilt=tilt)
        if direct is not None:
            return direct
        arcs = list(upright_arcs(start, goal)) if arcs is None else arcs
        for knots in arcs:
            arc = free_motion(knots, obstacles, carried=load, margin=margin, tilt=tilt)
            if arc is not None:
                return arc
        detour = plan_transit(start, goal, obstacles, carried=load, margin=margin, tilt=tilt)
        if detour is not None:
            return detour
    return None


def way_down(
    pose: Array,
    start: Array,
    obstacles: Sequence[Obstacle],
    load: Array | None,
    *,
    calm: bool = False,
    stages: Stages = STAGES,
) -> WayDown | None:
    """The way to above a tool pose (4, 4) and straight down onto it; the calmest one there is, or None.

    With `calm` only ways on which the hand does nothing but turn about the vertical are looked for; else those of
    `stages`, in order.
    """
    arcs = [*arcs_above(pose, start)]
    if calm and not arcs:
        return None
    downs: list[tuple[Array, float]] = []
    for stage in stages:
        for knots, path, length in arcs:
            transit = free_motion(knots, obstacles, carried=load, margin=stage[1], tilt=stage[0])
            if transit is not None:
                return WayDown(transit, path, length)
        if calm:
            return None
        if not downs:
            downs = [
                (path, height + OVERSHOOT)
                for height in CARRY_HEIGHTS
                for path in descents(pose, start, height, OVERSHOOT)
            ]
        for path, length in downs:
            transit = carry_way(start, path[0], obstacles, load, (stage,))
            if transit is not None:
                return WayDown(transit, path, length)
    return None


def arcs_above(pose: Array, start: Array) -> Iterator[tuple[Array, Array, float]]:
    """Arcs (K, 7) to above a tool pose (4, 4), each with the straight way down (M, 7) from its end and its length [m].

    From each height, those that move the joints least come first.
    """
    first = forward(start)
    turns = _turns(first, pose)
    up = np.array([0.0, 0.0, 1.0])
    for height in CARRY_HEIGHTS:
        above = pose.copy()
        above[2, 3] += height
        offsets = np.linspace(0.0, -height - OVERSHOOT, 11)[:, None] * up
        found: list[tuple[float, Array]] = []
        for turn in turns:
            for change in WRIST_TURNS:
                knots = _arc(start, (first, above), float(start[6]) + change, turn, 0.0, 0.0)
                if knots is not None:
                    found.append((float(np.abs(np.diff(knots, axis=0)).max(axis=1).sum()), knots))
        for _, knots in sorted(found, key=lambda pair: pair[0]):
            path = line_any(above, offsets, knots[-1])
            if path is not None and stands_free(path):
                yield knots, path, height + OVERSHOOT


def upright_arcs(start: Array, goal: Array) -> Iterator[Array]:
    """Joint knots (K, 7) of arcs about the robot's column on which the hand only turns about the vertical."""
    first, last = forward(start), forward(goal)
    for raised in ARC_RAISES:
        for turn in _turns(first, last):
            for bend in WRIST_BENDS:
                knots = _arc(start, (first, last), float(goal[6]), turn, raised, bend)
                if knots is not None and float(np.abs(knots[-1] - goal).max()) < SAME_POSTURE:
                    knots[-1] = goal
                    yield knots
                    break


def _turns(first: Array, last: Array) -> tuple[float, ...]:
    """Turns about the vertical that bring one hand pose to the other [rad]; none if more than a turn is needed."""
    change = last[:3, :3] @ first[:3, :3].T
    if math.acos(max(-1.0, min(1.0, float(change[2, 2])))) > TWIST:
        return ()
    turn = math.atan2(change[1, 0] - change[0, 1], change[0, 0] + change[1, 1])
    return (turn, turn - math.copysign(2 * math.pi, turn)) if abs(turn) > LONG_TURN else (turn,)


def _arc(
    start: Array, ends: tuple[Array, Array], last_q7: float, turn: float, raised: float, bend: float
) -> Array | None:
    """Knots of one arc, or None where the arm cannot follow it without a jump."""
    (x0, y0, z0), (x1, y1, z1) = ends[0][:3, 3], ends[1][:3, 3]
    azimuth = math.atan2(y0, x0)
    swing = math.remainder(math.atan2(y1, x1) - azimuth, 2 * math.pi)
    radius, radius_change = math.hypot(x0, y0), math.hypot(x1, y1) - math.hypot(x0, y0)
    knots = np.empty((ARC_KNOTS, 7))
    knots[0] = last = np.asarray(start, float)
    target = ends[0].copy()
    for number in range(1, ARC_KNOTS):
        share = number / (ARC_KNOTS - 1)
        bump = math.sin(math.pi * share)
        angle, r = azimuth + share * swing, radius + share * radius_change
        cos, sin = math.cos(share * turn), math.sin(share * turn)
        target[:3, :3] = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]]) @ ends[0][:3, :3]
        target[:3, 3] = r * math.cos(angle), r * math.sin(angle), z0 + share * (z1 - z0) + raised * bump
        q7 = float(start[6] + share * (last_q7 - start[6]) + bend * bump)
        solutions = inverse(target, q7, last)
        if not len(solutions):
            return None
        jumps = np.abs(solutions - last).max(axis=1)
        if jumps.min() > 2 * MAX_JUMP:
            return None
        knots[number] = last = solutions[int(jumps.argmin())]
    return knots if within_limits(knots).all() else None
