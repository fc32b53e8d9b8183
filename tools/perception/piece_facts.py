"""Where a look's colour pieces lie and what colour they have, measured once and remembered."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tools.perception.blob import CLEAR_LOSS, Blob, covered_top
from tools.perception.contents import has_rim, is_ring
from tools.perception.look import Look
from tools.perception.measure import measure
from tools.perception.segment import BRIGHTNESS_RADIUS, chromaticity

Array = NDArray[np.float64]

LOOKS_OUT, NESTED_BASE = 0.008, 0.002
"""What stands in a bowl reaches this far above its rim and below it [m], and this far below its lowest seen points."""

FOOT_POINTS = 25
"""What this many points of a piece reach down to is where it ends: its front may hide behind something nearer."""


@dataclass(frozen=True)
class Span:
    """Where a group of pieces lies."""

    low: Array
    """2-% quantiles of x, y, z (3,) [m]."""
    high: Array
    """98-% quantiles of x, y, z (3,) [m]."""
    top: float
    """Height of its top, should something stand on it [m]."""
    from_top: float
    """Share of the points that the top camera sees."""
    foot: float
    """Height that its `FOOT_POINTS` lowest points reach down to [m]."""

    def mirrored(self, about: Array) -> Span:
        """The extents of what carries something: its back is as far from the load's middle (2,) [m] as its front."""
        low, high = self.low.copy(), self.high.copy()
        low[:2], high[:2] = np.minimum(low[:2], 2 * about - high[:2]), np.maximum(high[:2], 2 * about - low[:2])
        return replace(self, low=low, high=high)


class PieceFacts:
    """What is known about a look's pieces and groups of them, measured once each."""

    def __init__(self, look: Look) -> None:
        self.look = look
        self.hung: set[tuple[int, int]] = set()
        """Pairs of pieces of which one hangs above the other."""
        self.same: set[tuple[int, int]] = set()
        """Pairs of pieces of one colour that something covers between."""
        self._spans: dict[tuple[int, ...], Span] = {}
        self._nests: dict[tuple[tuple[int, ...], tuple[int, ...]], bool] = {}
        self._hues: dict[int, Array] = {}
        self._blobs: dict[tuple[int, ...], Blob] = {}

    def span(self, group: tuple[int, ...]) -> Span:
        """Extents of a group without its outermost points, from the cache."""
        if group not in self._spans:
            blob = self.blob(group)
            ordered = np.sort(blob.xyz, axis=0)
            count = len(ordered)
            low, high = ordered[int(0.02 * (count - 1))], ordered[int(np.ceil(0.98 * (count - 1)))]
            foot = float(ordered[min(FOOT_POINTS, int(0.02 * (count - 1))), 2])
            self._spans[group] = Span(low, high, covered_top(blob), float(blob.from_top.mean()), foot)
        return self._spans[group]

    def same_hue(self, a: int, b: int) -> bool:
        clear = max(self.blob((piece,)).lost() for piece in (a, b))
        return same_colour(self.hue(a), self.hue(b)) and clear < CLEAR_LOSS

    def hue(self, piece: int) -> Array:
        if piece not in self._hues:
            self._hues[piece] = chromaticity(np.median(self.blob((piece,)).rgb, axis=0)[None])[0]
        return self._hues[piece]

    def blob(self, group: tuple[int, ...]) -> Blob:
        if group not in self._blobs:
            self._blobs[group] = self.look.maker.blob(group)
        return self._blobs[group]

    def split(self, group: tuple[int, ...], part: NDArray[np.bool_]) -> list[tuple[int, ...]]:
        """Makes two groups of one by a mask (N,) over its points; every piece gets new numbers on both sides."""
        label = self.look.maker.label.copy()
        chosen = np.flatnonzero(np.isin(label, group))
        fresh = int(label.max()) + 1
        sides: list[tuple[int, ...]] = []
        for side in (part, ~part):
            mine = chosen[side]
            names, place = np.unique(label[mine], return_inverse=True)
            label[mine] = fresh + place.reshape(-1)
            sides.append(tuple(range(fresh, fresh + len(names))))
            fresh += len(names)
        self.look = replace(self.look, maker=replace(self.look.maker, label=label))
        return sides

    def nested(self, group: tuple[int, ...], other: tuple[int, ...]) -> bool:
        """The group stands in the hollow of the other one and looks out of it."""
        mine, around = self.span(group), self.span(other)
        within = np.all(mine.low > around.low + 0.004) and np.all(mine.high[:2] < around.high[:2] - 0.004)
        if not within or mine.high[2] < around.high[2] + LOOKS_OUT or mine.low[2] > around.high[2] - LOOKS_OUT:
            return False
        if (group, other) not in self._nests:
            holder = measure(self.blob(other))
            reach = np.hypot(*(self.blob(group).xyz[:, :2] - holder.centre).T)
            inside = holder.is_round and np.quantile(reach, 0.9) < 0.96 * holder.radius
            self._nests[group, other] = bool(inside and has_rim(holder) and not is_ring(holder))
        return self._nests[group, other]


def gap(one: Span, two: Span) -> float:
    """Free distance of two groups' bounding rectangles seen from above [m], negative if they overlap."""
    return float(np.max(np.maximum(one.low[:2], two.low[:2]) - np.minimum(one.high[:2], two.high[:2])))


def same_colour(one: Array, two: Array) -> bool:
    """Whether two chromaticities (3,) are one colour under uneven light."""
    reach = max(0.026, 0.012 / float(np.exp(min(one[2], two[2]))))  # dark colours are noisy
    return bool(np.hypot(*(one - two)[:2]) < reach and abs(one[2] - two[2]) < BRIGHTNESS_RADIUS / 2)
