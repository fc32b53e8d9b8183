"""The points taken to be one object, and how high it reaches."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

HIDDEN = 0.15
"""A thing of which less than this share of the points is seen from above is hidden by what it carries."""

CLEAR_LOSS = 0.20
"""Things around whose points more than this share of the pixels is unmeasured are transparent."""


@dataclass(frozen=True)
class Blob:
    """The points taken to be one object."""

    xyz: Array
    """(N, 3) [m], world."""
    rgb: Array
    """(N, 3) in [0, 1]."""
    from_top: Mask
    """Seen by the top camera (N,)."""
    clear: Array
    """Share of unmeasured pixels around each point (N,); NaN where there are only edges."""
    pieces: tuple[int, ...]
    """Colour pieces it consists of."""
    second_share: float
    """Share of the points that do not belong to the largest piece."""
    eyes: Array
    """Positions of the front and top camera (2, 3) [m]."""
    pixel: NDArray[np.intp]
    """Flat pixel index of each point in its view (N,)."""
    low: Array
    """Points too low to count as object (K, 3) that the top camera sees within the blob's outline: a hollow's floor."""

    def lost(self) -> float:
        """Mean share of unmeasured pixels, edges left aside; 0 if there are only edges."""
        known = np.isfinite(self.clear)
        return float(self.clear[known].mean()) if known.sum() >= 10 else 0.0

    def all_edge(self) -> bool:
        """Nearly all points lie at edges, so that nothing tells whether the thing is clear."""
        return bool(np.isfinite(self.clear).mean() < 0.15)


def top_height(z: Array) -> float:
    """Height of the top [m] of points at heights z (N,), free of the upward bias of the largest of many noisy ones."""
    count = len(z)
    rank = max(3, int(0.01 * count))
    high = float(np.partition(z, count - rank)[count - rank]) if count > rank else float(z.max())
    return float(np.mean(z[z > high - 0.0015]))


def covered_top(blob: Blob) -> float:
    """Height of the top [m] of a blob that carries something, whose lowest points may have strayed into it."""
    high = blob.xyz[blob.from_top, 2]
    if len(high) < max(25, HIDDEN * len(blob.xyz)):
        return float(np.quantile(blob.xyz[:, 2], 0.96))
    return float(np.quantile(high, 0.75))
