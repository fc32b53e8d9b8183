"""Whether a thing lies where it was to go, at the end of a motion."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from sim.placed import PlacedScene
from sim.pose import Array
from sim.verdict_damage import tilt
from sim.verdict_grip import TOUCH, Grip

REST_ROWS = 10
"""A thing is at rest that did not move for so many rows (0.2 s) ..."""
REST_MOVE = 0.002
"""... by more than this [m]."""
BESIDE = 0.20
"""Middle-to-middle distance within which one thing is beside another [m]."""
RETURNED = 0.04
"""A thing is back where it was within this distance [m]."""
LANE = 0.15
"""Width of a sorting lane [m] (LH-b)."""
UPRIGHT = math.radians(15.0)
"""A stemmed or fragile thing must stand this upright [rad]."""
ON_TABLE = ((0.25, 0.85), (-0.40, 0.40))
"""Table in x and y [m]."""


def placed_well(
    grip: Grip, upright: Array, start: Array, placed: PlacedScene, placement: Any, other: Grip | None
) -> bool:
    """Whether the thing was let go, is at rest, stands as it should and is where the placement says.

    Args:
        grip: The thing in the placing motion.
        upright: Its vertical axis at the start of the trial (3,).
        start: Its pose at the start of the trial (7,).
        placed: The scene.
        placement: Anything with `kind` and, as far as the kind needs them, `side`, `relation` and `lane`; or None for
            any place on the table.
        other: The reference, for "beside" and "on".
    """
    track, column = grip.track, grip.column
    last = grip.centre[-1]
    resting = np.linalg.norm(grip.centre[-REST_ROWS:] - last, axis=1).max() < REST_MOVE
    if bool(grip.touched[-1]) or not resting:
        return False
    if grip.thing.affordance.region in ("stem", "neck") and float(tilt(grip, upright)[-1]) > UPRIGHT:
        return False
    kind = "aside" if placement is None else str(placement.kind)
    if kind == "bin":
        return in_bin(last, placed, grip.thing.size[2])
    if not _on_table(last) and kind != "on":
        return False
    if kind == "side":
        return _on_side(last, getattr(placement, "side", None))
    if kind == "back":
        return float(np.linalg.norm(track.pose[-1, column, :2] - start[:2])) < RETURNED
    if kind == "lane" and placement is not None:
        number, count = placement.lane
        return abs(last[1] - lane_centre(number, count)) <= LANE / 2
    if kind in ("beside", "on"):
        return other is not None and _relative(grip, other, kind, getattr(placement, "relation", None))
    return True


def in_bin(point: Array, placed: PlacedScene, height: float) -> bool:
    """Whether a thing's middle is between the walls of the bin, and low enough to lie in it."""
    if placed.bin is None:
        return False
    low, high = np.asarray(placed.bin[0]), np.asarray(placed.bin[1])
    inside = bool((point[:2] > low[:2]).all() and (point[:2] < high[:2]).all())
    return inside and low[2] - 0.01 < point[2] < high[2] + height / 2


def lane_centre(number: int, count: int) -> float:
    """Middle of a sorting lane along y [m]; number 0 is the leftmost of `count`."""
    return ((count - 1) / 2 - number) * LANE


def _on_table(point: Array) -> bool:
    (x0, x1), (y0, y1) = ON_TABLE
    return x0 <= point[0] <= x1 and y0 <= point[1] <= y1 and point[2] > 0.0


def _on_side(point: Array, side: str | None) -> bool:
    """Sides as the robot sees them from its base: left is +y, the front is near it, the back far from it."""
    middle_x = (ON_TABLE[0][0] + ON_TABLE[0][1]) / 2
    return {
        "left": point[1] > 0.05,
        "right": point[1] < -0.05,
        "front": point[0] < middle_x,
        "back": point[0] > middle_x,
        "middle": abs(point[1]) < 0.15,
    }.get(side or "", True)


def _relative(grip: Grip, other: Grip, kind: str, relation: str | None) -> bool:
    here, there = grip.centre[-1], other.centre[-1]
    if kind == "on":
        touching = any(
            grip.track.pair[-1, number] > TOUCH
            for number, pair in enumerate(grip.layout.pairs)
            if set(pair) == {grip.thing.id, other.thing.id}
        )
        return touching and here[2] > there[2]
    offset = here - there
    if float(np.linalg.norm(offset[:2])) > BESIDE:
        return False
    return {
        "left_of": offset[1] > 0.0,
        "right_of": offset[1] < 0.0,
        "behind": offset[0] > 0.0,
        "in_front_of": offset[0] < 0.0,
    }.get(relation or "", True)
