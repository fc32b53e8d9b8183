"""The Panda hand as boxes, and how close it comes to points while it grasps.

Hand frame: origin at the flange, x across the fingers, y closing axis, z approach. The tool centre point lies at
z = `TCP_OFFSET`. Sizes were measured on the hand and finger meshes of the `rtb-data` package. This module knows no
objects: points come from whoever has seen or placed them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kb.grasp import FULL_SPEED, Grasp

Array = NDArray[np.float64]

TCP_OFFSET = 0.1034
"""Flange to tool centre point along z [m] (Franka hand manual: F_T_EE of the standard hand)."""
FINGER_OFFSET = 0.0584
"""Flange to the origin of the fingers along z [m] (Franka hand description)."""
TIP_BEYOND_TCP = FINGER_OFFSET + 0.0538 - TCP_OFFSET
"""The fingertips reach this far beyond the tool centre point [m]."""
PALM_ABOVE_TCP = TCP_OFFSET - 0.066
"""The palm's lower face stands this far back from the tool centre point [m]; the tips are 46 mm below it (ledger G39)."""

PALM_BOXES: tuple[tuple[tuple[float, float, float], tuple[float, float, float]], ...] = (
    ((0.0, 0.0, -0.003), (0.0315, 0.102, 0.023)),
    ((0.0, 0.0, 0.043), (0.0235, 0.102, 0.023)),
)
"""Centre and half size [m] in the hand frame: the wide rear part and the slim front part of the palm (ledger G2)."""
FINGER_BOXES: tuple[tuple[tuple[float, float, float], tuple[float, float, float]], ...] = (
    ((0.0, 0.01895, 0.0100), (0.0105, 0.00735, 0.0100)),
    ((0.0, 0.0130, 0.0280), (0.0095, 0.0080, 0.0080)),
    ((0.0, 0.0072, 0.0449), (0.0089, 0.0072, 0.0089)),
)
"""Root, middle and pad of the left finger in the finger's frame, whose y axis points away from the other finger. The
pad's inner face is y = 0. The right finger is the left one turned by pi about z."""
PAD = 2
"""Index of the pad in `FINGER_BOXES`."""

FULL_LIFT = 0.17
"""How far the tool point rises in a grasp motion [m]: 10 cm demanded by success, and room for the shake."""
VERTICAL = 0.9999
"""Cosine from which an approach counts as straight down: the lift then strays by less than 3 mm."""
LIFT_STEP = 0.0175
"""Largest step between checked heights of the lifted hand [m]: less than a pad's thickness, so nothing is missed."""


def hand_boxes(aperture: float) -> list[tuple[Array, Array]]:
    """Centres (3,) and half sizes (3,) [m] of the hand's boxes in the hand frame at an opening `aperture` [m]."""
    boxes = [(np.array(centre), np.array(half)) for centre, half in PALM_BOXES]
    for sign in (1.0, -1.0):
        for centre, half in FINGER_BOXES:
            y = sign * (centre[1] + aperture / 2.0)
            boxes.append((np.array([centre[0], y, centre[2] + FINGER_OFFSET]), np.array(half)))
    return boxes


def approach_time(distance: float, speed: float) -> float:
    """Duration [s] of a straight quintic motion over `distance` [m] whose peak speed is `speed` x FULL_SPEED.

    The peak of a quintic time law is 15/8 of its mean speed.
    """
    return max(0.25, 15.0 / 8.0 * distance / (FULL_SPEED * speed))


def _distances(x: Array, y: Array, z: Array, aperture: float, standoff: float) -> Array:
    """Signed distance of points to the hand stretched back along its approach by `standoff`, same shape as x, y, z.

    Coordinates are in the hand's axes about the tool point. The hand is its own mirror image in x and y, so five boxes
    in the quadrant of |x|, |y| stand for all eight.
    """
    x, y = np.abs(x), np.abs(y)
    boxes = [(0.0, centre[2], half) for centre, half in PALM_BOXES]
    boxes += [(centre[1] + aperture / 2.0, centre[2] + FINGER_OFFSET, half) for centre, half in FINGER_BOXES]
    outside = np.full(x.shape, np.inf)
    inside = np.zeros(x.shape)
    for beside, along, half in boxes:
        dx = x - half[0]
        dy = (y if beside == 0.0 else np.abs(y - beside)) - half[1]
        dz = np.abs(z - (along - TCP_OFFSET - standoff / 2.0)) - (half[2] + standoff / 2.0)
        np.minimum(inside, np.maximum(np.maximum(dx, dy), dz), out=inside)
        np.maximum(dx, 0.0, out=dx)
        np.maximum(dy, 0.0, out=dy)
        np.maximum(dz, 0.0, out=dz)
        np.minimum(outside, dx * dx + dy * dy + dz * dz, out=outside)
    return np.sqrt(outside) + inside


def swept_distances(grasp: Grasp, points_w: Array, *, lift: float = FULL_LIFT) -> Array:
    """Signed distance of each point [m] to the hand swept over stand-off, grasp and vertical lift, shape (N,).

    Args:
        grasp: The grasp; its aperture is the opening of the sweep, which is conservative once it has closed.
        points_w: Points in the world frame [m], shape (N, 3).
        lift: Height of the lift [m]; 0 leaves the lift out.
    """
    points = np.asarray(points_w, float).reshape(-1, 3)
    if not len(points):
        return np.zeros(0)
    rotation = grasp.rotation()
    x, y, z = ((points - np.asarray(grasp.position)) @ rotation).T
    up = rotation[2]
    if up[2] < -VERTICAL:
        # The lift goes back along the approach: one stretched hand covers both.
        return _distances(x, y, z, grasp.aperture, max(grasp.standoff, lift))
    best = _distances(x, y, z, grasp.aperture, grasp.standoff)
    if lift > 0.0:
        # Raising the hand by h is lowering the points by h.
        heights = np.linspace(0.0, lift, math.ceil(lift / LIFT_STEP) + 1)[1:, None]
        raised = _distances(x - heights * up[0], y - heights * up[1], z - heights * up[2], grasp.aperture, 0.0)
        np.minimum(best, raised.min(axis=0), out=best)
    return best


def swept_clearance(grasp: Grasp, points_w: Array, *, lift: float = FULL_LIFT) -> float:
    """Smallest signed distance [m] between the swept hand and the points (N, 3); inf without points.

    Points that cannot come within `CULL_MARGIN` of the hand are not measured: they count as that far away.
    """
    return float(swept_clearances([grasp], points_w, lift=lift)[0])


def swept_clearances(grasps: Sequence[Grasp], points_w: Array, *, lift: float = 0.0) -> Array:
    """`swept_clearance` of many grasps against the same points, shape (G,); inf without points."""
    points = np.asarray(points_w, float).reshape(-1, 3)
    out = np.full(len(grasps), np.inf)
    if not len(points):
        return out
    for index, grasp in enumerate(grasps):
        offset = points - np.asarray(grasp.position)
        squared = np.einsum("ij,ij->i", offset, offset)
        # No hand point is farther from the tool point's way than this.
        reach = HAND_RADIUS + max(grasp.standoff, lift)
        near = squared < (reach + CULL_MARGIN) ** 2
        if near.any():
            out[index] = swept_distances(grasp, points[near], lift=lift).min()
        if not near.all():
            out[index] = min(out[index], CULL_MARGIN)
    return out


HAND_RADIUS = 0.17
"""Every point of the hand lies within this distance of the tool point [m]: sqrt(.1294^2 + .102^2 + .0315^2)."""
CULL_MARGIN = 0.10
"""Clearances up to this are exact [m]; larger ones may be reported as this."""
