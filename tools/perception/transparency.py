"""Where a depth camera loses pixels although nothing ends there: glass (half of its pixels are lost)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tools.perception.filter_depth import box_sum

Array = NDArray[np.float64]
Image = NDArray[np.float32]

STEP = 0.010
"""Range of depths in a pixel's neighbourhood from which it counts as an edge [m]; edges lose pixels too."""

NEAR, WINDOW = 2, 3
"""Half-windows of the neighbourhood in which edges are looked for, and of the share that is lost [px]."""

FEWEST = 6
"""Pixels away from edges that a share needs."""


def clear_share(raw: Image, noise: float = 1.0) -> Array:
    """Share of unmeasured pixels (H, W) around each pixel, edges left aside; NaN at edges, 1 amid holes.

    With `noise` times the ordinary noise flat neighbourhoods range over that much more.
    """
    measured = raw > 0
    low = _extreme(np.where(measured, raw, np.float32(np.inf)), np.minimum)
    high = _extreme(np.where(measured, raw, np.float32(0.0)), np.maximum)
    flat = (high - low < STEP * noise) & (high > 0)
    total = box_sum(flat.astype(np.float32), WINDOW)
    lost = box_sum((flat & ~measured).astype(np.float32), WINDOW)
    share = np.where(flat & (total >= FEWEST), lost / np.maximum(total, 1.0), np.nan)
    # Where nothing at all is measured, everything is lost (`tools.perception.lost_glass`).
    return np.where(high > 0, share, 1.0)


def _extreme(image: Image, pick: np.ufunc) -> Image:
    """Smallest or largest value within NEAR pixels along both axes."""
    result = image.copy()
    for shift in range(1, NEAR + 1):
        pick(result[:, shift:], image[:, :-shift], out=result[:, shift:])
        pick(result[:, :-shift], image[:, shift:], out=result[:, :-shift])
    rows = result.copy()
    for shift in range(1, NEAR + 1):
        pick(result[shift:], rows[:-shift], out=result[shift:])
        pick(result[:-shift], rows[shift:], out=result[:-shift])
    return result
