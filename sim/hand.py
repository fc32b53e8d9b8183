"""The Panda hand as boxes, and how close it comes to points while it grasps.

Hand frame: origin at the flange, x across the fingers, y closing axis, z approach. The tool centre point lies at
z = `TCP_OFFSET`. Sizes were measured on the hand and finger meshes of the `rtb-data` package. This module knows no
objects: points come from whoever has seen or placed them.
"""

from __future__ import annotations

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
LIFT_SAMPLES = 4
SWEEP_STEP = 0.02
"""Largest step between checked poses of the hand on its way [m]; boxes are stretched along the step, nothing is missed."""


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


def _swept_boxes(aperture: float, standoff: float) -> tuple[Array, Array, Array, Array]:
    """The hand's boxes stretched over the approach, and as they stand at the grasp: centres and halves, each (8, 3)."""
    boxes = hand_boxes(aperture)
    centres = np.array([centre for centre, _ in boxes]) - [0.0, 0.0, TCP_OFFSET]
    halves = np.array([half for _, half in boxes])
    stretched = centres.copy(), halves.copy()
    stretched[0][:, 2] -= standoff / 2.0
    stretched[1][:, 2] += standoff / 2.0
    return stretched[0], stretched[1], centres, halves


def _box_distance(points: Array, centres: Array, halves: Array) -> Array:
    """Signed distance of points (..., 3) to the nearest of the boxes (B, 3), same frame; shape (...)."""
    best = np.full(points.shape[:-1], np.inf)
    for centre, half in zip(centres, halves, strict=True):
        outside = np.abs(points - centre) - half
        positive = np.maximum(outside, 0.0)
        inside = np.minimum(outside.max(axis=-1), 0.0)
        distance = np.sqrt(np.einsum("...i,...i->...", positive, positive)) + inside
        np.minimum(best, distance, out=best)
    return best


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
    local = (points - np.asarray(grasp.position)) @ rotation
    centres_a, halves_a, centres, halves = _swept_boxes(grasp.aperture, grasp.standoff)
    best = _box_distance(local, centres_a, halves_a)
    if lift > 0.0:
        # Raising the hand by h is lowering the points by h; samples every `lift / LIFT_SAMPLES`.
        up = rotation.T @ np.array([0.0, 0.0, 1.0])
        for height in np.linspace(0.0, lift, LIFT_SAMPLES + 1)[1:]:
            np.minimum(best, _box_distance(local - height * up, centres, halves), out=best)
    return best


def swept_clearance(grasp: Grasp, points_w: Array, *, lift: float = FULL_LIFT) -> float:
    """Smallest signed distance [m] between the swept hand and the points (N, 3); inf without points."""
    distances = swept_distances(grasp, points_w, lift=lift)
    return float(distances.min()) if len(distances) else float("inf")


def swept_clearances(grasps: Sequence[Grasp], points_w: Array, *, lift: float = 0.0) -> Array:
    """`swept_clearance` of many grasps against the same points, shape (G,); inf without points.

    A hand sphere around each grasp's path first drops the points that cannot decide anything below `CULL` metres.
    """
    points = np.asarray(points_w, float).reshape(-1, 3)
    out = np.full(len(grasps), np.inf)
    if not len(points):
        return out
    for index, grasp in enumerate(grasps):
        offset = points - np.asarray(grasp.position)
        near = np.einsum("ij,ij->i", offset, offset) < (CULL + grasp.standoff + lift) ** 2
        if near.any():
            out[index] = swept_clearance(grasp, points[near], lift=lift)
        else:
            out[index] = float(
                np.sqrt(np.einsum("ij,ij->i", offset, offset).min()) - HAND_RADIUS - grasp.standoff - lift
            )
    return out


HAND_RADIUS = 0.17
"""Every point of the hand lies within this distance of the tool centre point [m]: sqrt(.1294² + .102² + .0315²)."""
CULL = HAND_RADIUS + 0.05
"""Points farther from the tool point than this (plus the way) are not measured exactly [m]."""
