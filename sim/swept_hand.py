"""How close the Panda hand, as boxes, comes to points while it grasps: its sweep over stand-off, grasp and lift.

Points come from whoever has seen or placed them; the hand's frame is that of `sim.hand`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kb.grasp import Grasp
from sim.hand import FINGER_BOXES, FINGER_OFFSET, FULL_LIFT, PALM_BOXES, TCP_OFFSET

Array = NDArray[np.float64]

VERTICAL = 0.9999
"""Cosine from which an approach counts as straight down: the lift then strays by less than 3 mm."""
LIFT_STEP = 0.0175
"""Largest step between checked heights of the lifted hand [m]: less than a pad's thickness, so nothing is missed."""

_ALL = [((0.0, 0.0, c[2]), half) for c, half in PALM_BOXES]
_ALL += [((0.0, c[1], c[2] + FINGER_OFFSET), half) for c, half in FINGER_BOXES]
_MIDDLES, _HALVES = (np.array([box[k] for box in _ALL]).T[:, :, None] for k in (0, 1))
_OPENS = np.array([0.0 for _ in PALM_BOXES] + [0.5 for _ in FINGER_BOXES])[:, None]
"""The boxes in the quadrant of |x|, |y|: middles and half sizes, by axis and box (3, 5, 1) [m]."""


@lru_cache(maxsize=256)
def _stretched(aperture: float, standoff: float) -> tuple[Array, Array]:
    """Middles from the tool point and half sizes (3, 5, 1) [m] of the open hand's boxes, stretched back by `standoff`."""
    middles, halves = _MIDDLES.copy(), _HALVES.copy()
    middles[1] += _OPENS * aperture
    middles[2] = middles[2] - TCP_OFFSET - standoff / 2.0
    halves[2] += standoff / 2.0
    return middles, halves


def _distances(folded: Array, aperture: float, standoff: float) -> Array:
    """Signed distance of points to the hand stretched back along its approach by `standoff`, shape (..., N).

    Coordinates |x|, |y|, z, (3, ..., N), are in the hand's axes about the tool point. The hand is its own mirror image in
    x and y, so five boxes in the quadrant of |x|, |y| stand for all eight.
    """
    middles, halves = _stretched(aperture, standoff)
    if folded.ndim > 2:
        middles, halves = middles[:, None], halves[:, None]
    outside = folded[..., None, :] - middles
    np.abs(outside, out=outside)
    outside -= halves
    return _nearest(outside)


def _nearest(outside: Array) -> Array:
    """Smallest signed distance (..., N) [m] to boxes from how far points are outside of them by axis, (3, ..., B, N)."""
    squared = np.maximum(outside, 0.0)
    squared *= squared
    total = squared[0] + squared[1]
    total += squared[2]
    out = np.sqrt(np.minimum.reduce(total, axis=-2))
    if out.size and not np.minimum.reduce(out, axis=None):
        # Only what is in a box, or on its face, has a depth.
        out += np.minimum(np.minimum.reduce(np.maximum.reduce(outside, axis=0), axis=-2), 0.0)
    return out


def _folded(points: Array) -> Array:
    """Coordinates (3, ...) with x and y without their signs."""
    out = np.abs(points)
    out[2] = points[2]
    return out


def _boxed(centres_halves: Sequence[tuple[tuple[float, float, float], tuple[float, float, float]]]) -> Array:
    """Lower and upper corner (2, 3) of the box around boxes [m]."""
    corners = [(np.array(c) - half, np.array(c) + half) for c, half in centres_halves]
    return np.array([np.min([low for low, _ in corners], axis=0), np.max([high for _, high in corners], axis=0)])


_PALM, _FINGER = _boxed(PALM_BOXES), _boxed(FINGER_BOXES)
_AROUND_LOW = np.array([[-np.inf, -np.inf], [_PALM[0, 1], _FINGER[0, 1]], [_PALM[0, 2], _FINGER[0, 2] + FINGER_OFFSET]])
_AROUND_HIGH = np.array(
    [
        [_PALM[1, 0], _FINGER[1, 0]],
        [_PALM[1, 1], _FINGER[1, 1]],
        [_PALM[1, 2], _FINGER[1, 2] + FINGER_OFFSET],
    ]
)
_AROUND_OPENS = np.array([0.0, 0.5])
"""Boxes around the palm and around a finger: least and greatest |x|, |y| and z [m], one a column."""


@lru_cache(maxsize=256)
def _around(aperture: float, standoff: float) -> tuple[Array, Array]:
    """Lower and upper corners (3, 2, 1) [m] about the tool point of boxes around palm and finger."""
    low, high = _AROUND_LOW.copy(), _AROUND_HIGH.copy()
    for corners in (low, high):
        corners[1] += _AROUND_OPENS * aperture
        corners[2] -= TCP_OFFSET
    low[2] -= standoff
    return low[:, :, None], high[:, :, None]


@dataclass(frozen=True)
class _Sweep:
    """Points in the axes of a hand about its tool point, and how that hand moves."""

    points: Array
    """Coordinates across, closing and along the approach (3, N) [m]."""
    folded: Array
    """The same with x and y without their signs."""
    aperture: float
    standoff: float
    lift: float
    """Height of a lift that does not go back along the approach [m]; 0 if there is none."""
    up: Array
    """Straight up in the hand's axes, (3,)."""

    @classmethod
    def of(cls, grasp: Grasp, offset_w: Array, lift: float) -> _Sweep:
        """The sweep of a grasp against points that lie at `offset_w` (N, 3) [m] from its tool point."""
        rotation = grasp.rotation()
        points = np.ascontiguousarray((offset_w @ rotation).T)
        up = rotation[2]
        if up[2] < -VERTICAL:
            # The lift goes back along the approach: one stretched hand covers both.
            return cls(points, _folded(points), grasp.aperture, max(grasp.standoff, lift), 0.0, up)
        return cls(points, _folded(points), grasp.aperture, grasp.standoff, max(0.0, lift), up)

    def distances(self, which: NDArray[np.intp] | None = None) -> Array:
        """Signed distances [m] of the points chosen by index, or of all."""
        folded = self.folded if which is None else self.folded.take(which, axis=1)
        best = _distances(folded, self.aperture, self.standoff)
        if self.lift > 0.0 and len(best):
            # Raising the hand by h is lowering the points by h.
            points = self.points if which is None else self.points.take(which, axis=1)
            raised = points[:, None] - _heights(self.lift) * self.up[:, None, None]
            np.minimum(best, _distances(_folded(raised), self.aperture, 0.0).min(axis=0), out=best)
        return best

    def bounds(self) -> Array:
        """Lower bounds of the distances [m], shape (N,): the distances to the boxes around palm and fingers."""
        low, high = _around(self.aperture, self.standoff)
        folded = self.folded[:, None]
        outside = np.maximum(low - folded, folded - high)
        out = _nearest(outside)
        if self.lift > 0.0:
            by_x, by_y, by_z = (self.lift * value for value in self.up.tolist())
            x, _, z = self.points
            low, high = _around(self.aperture, 0.0)
            outside[0] = np.maximum(min(0.0, by_x) - x, x - max(0.0, by_x)) - high[0]
            outside[1] -= abs(by_y)
            outside[2] = np.maximum(low[2] + min(0.0, by_z) - z, z - (high[2] + max(0.0, by_z)))
            np.minimum(out, _nearest(outside), out=out)
        return out

    def count(self, limit: float) -> int:
        """How many points come nearer than `limit` [m]."""
        near = np.flatnonzero(self.bounds() < limit + ROUNDING)
        return int(np.count_nonzero(self.distances(near) < limit)) if len(near) else 0


@lru_cache(maxsize=64)
def _heights(lift: float) -> Array:
    """Heights of the lifted hand that are checked [m], shape (H, 1)."""
    heights = np.linspace(0.0, lift, math.ceil(lift / LIFT_STEP) + 1)[1:, None]
    heights.setflags(write=False)
    return heights


def _least(sweep: _Sweep) -> float:
    """The smallest distance of a sweep's points [m].

    The points with the smallest bounds give a distance; only points whose bound is below it can be nearer.
    """
    if sweep.points.shape[1] <= (FEW if sweep.lift > 0.0 else MANY):
        return float(np.minimum.reduce(sweep.distances()))
    bounds = sweep.bounds()
    first = np.argpartition(bounds, FEW // 2)[: FEW // 2]
    least = float(np.minimum.reduce(sweep.distances(first)))
    near = bounds < least + ROUNDING
    near[first] = False
    rest = np.flatnonzero(near)
    return min(least, float(np.minimum.reduce(sweep.distances(rest)))) if len(rest) else least


FEW, MANY = 24, 120
"""Up to so many points are measured at once, with a lift and without."""
ROUNDING = 1e-9
"""Far more than distances and bounds are off by rounding [m]."""


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
    return _Sweep.of(grasp, points - np.asarray(grasp.position), lift).distances()


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
        all_near = bool(near.all())
        if all_near or near.any():
            out[index] = _least(_Sweep.of(grasp, offset[near], lift))
        if not all_near:
            out[index] = min(out[index], CULL_MARGIN)
    return out


class Passing:
    """The same points seen from one pose of the hand, for the clearances of several openings and lifts."""

    def __init__(self, grasp: Grasp, points_w: Array) -> None:
        """Points (N, 3) [m], N > 0, as they lie about the grasp's tool point."""
        self._grasp = grasp
        offset = points_w - np.asarray(grasp.position)
        self._farthest = math.sqrt(float(np.maximum.reduce(np.einsum("ij,ij->i", offset, offset))))
        self._sweep = _Sweep.of(grasp, offset, 0.0)

    def clearance(self, aperture: float, lift: float) -> float:
        """`swept_clearance` of the grasp with this opening and lift [m]."""
        grasp, seen = self._grasp, self._sweep
        straight = seen.up[2] < -VERTICAL
        standoff = max(grasp.standoff, lift) if straight else grasp.standoff
        sweep = _Sweep(seen.points, seen.folded, aperture, standoff, 0.0 if straight else max(0.0, lift), seen.up)
        least = _least(sweep)
        all_near = self._farthest < HAND_RADIUS + max(grasp.standoff, lift) + CULL_MARGIN
        return least if all_near else min(least, CULL_MARGIN)

    def count(self, limit: float, back: float = 0.0) -> int:
        """How many points come nearer than `limit` [m] to the hand on its way up to `back` [m] before the grasp, unlifted."""
        grasp, seen = self._grasp, self._sweep
        by = np.array([[0.0], [0.0], [back]])
        return _Sweep(seen.points + by, seen.folded + by, grasp.aperture, grasp.standoff, 0.0, seen.up).count(limit)


def swept_least(grasp: Grasp, points_w: Array, *, lift: float = FULL_LIFT) -> float:
    """The smallest of `swept_distances` [m], however large; inf without points."""
    points = np.asarray(points_w, float).reshape(-1, 3)
    return _least(_Sweep.of(grasp, points - np.asarray(grasp.position), lift)) if len(points) else math.inf


def swept_count(grasp: Grasp, points_w: Array, limit: float, *, lift: float = FULL_LIFT) -> int:
    """How many points (N, 3) the swept hand comes nearer to than `limit` [m]."""
    points = np.asarray(points_w, float).reshape(-1, 3)
    if not len(points):
        return 0
    return _Sweep.of(grasp, points - np.asarray(grasp.position), lift).count(limit)


HAND_RADIUS = 0.17
"""Every point of the hand lies within this distance of the tool point [m]: sqrt(.1294^2 + .102^2 + .0315^2)."""
CULL_MARGIN = 0.10
"""Clearances up to this are exact [m]; larger ones may be reported as this."""
