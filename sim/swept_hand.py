"""How close the Panda hand, as boxes, comes to points while it grasps: its sweep over stand-off, grasp and lift.

Points come from whoever has seen or placed them; the hand's frame is that of `sim.hand`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from kb.grasp import Grasp
from sim.hand import FULL_LIFT
from sim.open_hand import around, distances, folded_of, from_boxes, nearest

Array = NDArray[np.float64]

VERTICAL = 0.9999
"""Cosine from which an approach counts as straight down: the lift then strays by less than 3 mm."""
LIFT_STEP = 0.0175
"""Largest step between checked heights of the lifted hand [m]: less than a pad's thickness, so nothing is missed."""


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
            return cls(points, folded_of(points), grasp.aperture, max(grasp.standoff, lift), 0.0, up)
        return cls(points, folded_of(points), grasp.aperture, grasp.standoff, max(0.0, lift), up)

    def distances(self, which: NDArray[np.intp] | None = None) -> Array:
        """Signed distances [m] of the points chosen by index, or of all."""
        folded = self.folded if which is None else self.folded.take(which, axis=1)
        best = distances(folded, self.aperture, self.standoff)
        if self.lift > 0.0 and len(best):
            # Raising the hand by h is lowering the points by h.
            points = self.points if which is None else self.points.take(which, axis=1)
            raised = points[:, None] - _heights(self.lift) * self.up[:, None, None]
            np.minimum(best, distances(folded_of(raised), self.aperture, 0.0).min(axis=0), out=best)
        return best

    def bounds(self) -> Array:
        """Lower bounds of the distances [m], shape (N,): the distances to the boxes around palm and fingers."""
        low, high = around(self.aperture, self.standoff)
        folded = self.folded[:, None]
        outside = np.maximum(low - folded, folded - high)
        out = nearest(outside)
        if self.lift > 0.0:
            np.minimum(out, self._lifted(outside), out=out)
        return out

    def _lifted(self, outside: Array) -> Array:
        """As `bounds`, for the hand on its lift; `outside` (3, 2, N) is how far points are outside of the boxes."""
        by_x, by_y, by_z = (self.lift * value for value in self.up.tolist())
        x, _, z = self.points
        low, high = around(self.aperture, 0.0)
        outside[0] = np.maximum(min(0.0, by_x) - x, x - max(0.0, by_x)) - high[0]
        outside[1] -= abs(by_y)
        outside[2] = np.maximum(low[2] + min(0.0, by_z) - z, z - (high[2] + max(0.0, by_z)))
        away = from_boxes(outside)
        # Across its way a box covers no more than its own breadth, which tells much where the way is aslant.
        flat = math.hypot(by_x, by_z)
        if flat > 0.0:
            n_x, n_z = -by_z / flat, by_x / flat
            middle, half = (low[2] + high[2]) / 2.0, (high[2] - low[2]) / 2.0
            aside = np.abs(n_x * x + n_z * z - n_z * middle) - (abs(n_x) * high[0] + abs(n_z) * half)
            np.maximum(away, aside, out=away)
        return np.minimum.reduce(away, axis=0)

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


def swept_leasts(grasp: Grasp, clouds_w: Sequence[Array], *, lift: float = FULL_LIFT) -> list[float]:
    """The smallest of `swept_distances` [m], however large, of each of some clouds of points (N, 3) [m], none empty."""
    sweep = _Sweep.of(grasp, np.concatenate(clouds_w) - np.asarray(grasp.position), lift)
    bounds, starts = sweep.bounds(), np.cumsum([0, *(len(cloud) for cloud in clouds_w)]).tolist()
    # As `_least`, for all clouds at once.
    first = [
        start + np.argpartition(bounds[start:end], min(FEW // 2, end - start - 1))[: FEW // 2]
        for start, end in pairwise(starts)
    ]
    offsets = np.cumsum([0, *(len(some) for some in first)])[:-1]
    chosen = np.concatenate(first)
    least = np.minimum.reduceat(sweep.distances(chosen), offsets)
    near = bounds < np.repeat(least + ROUNDING, np.diff(starts))
    near[chosen] = False
    rest = np.flatnonzero(near)
    if len(rest):
        np.minimum.at(least, np.searchsorted(starts, rest, side="right") - 1, sweep.distances(rest))
    return least.tolist()


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
