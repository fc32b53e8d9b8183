"""Clean one depth picture: a 3x3 median over measured pixels, and means of a picture's neighbourhoods."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Image = NDArray[np.float32]

_SORT_9 = (
    *((1, 2), (4, 5), (7, 8), (0, 1), (3, 4), (6, 7), (1, 2), (4, 5), (7, 8), (0, 3)),
    *((5, 8), (4, 7), (3, 6), (1, 4), (2, 5), (4, 7), (4, 2), (6, 4), (4, 2)),
)
"""Exchanges that bring the median of nine values to place 4 (Paeth's network)."""


def median_depth(depth: Image) -> Image:
    """Median of each 3x3 neighbourhood [m].

    Unmeasured neighbours (0) count as the pixel itself, so that holes do not spread; a hole with at least five measured
    neighbours is filled by the nearest of them.
    """
    padded = np.pad(depth, 1, mode="edge")
    height, width = depth.shape
    planes: list[Image] = []
    for dv in range(3):
        for du in range(3):
            part = padded[dv : dv + height, du : du + width]
            planes.append(np.where(part > 0, part, depth))
    low = np.empty_like(depth)
    for i, j in _SORT_9:
        np.minimum(planes[i], planes[j], out=low)
        np.maximum(planes[i], planes[j], out=planes[j])
        planes[i], low = low, planes[i]
    return planes[4]


def box_sum(image: NDArray[Any], half: int) -> NDArray[np.float64]:
    """Sum over windows of (2 half + 1) squared pixels, cut at the border; same shape as `image` (H, W)."""
    total = np.zeros((image.shape[0] + 1, image.shape[1] + 1))
    np.cumsum(np.cumsum(image, axis=0, dtype=np.float64), axis=1, out=total[1:, 1:])
    height, width = int(image.shape[0]), int(image.shape[1])
    rows, columns = np.arange(height, dtype=np.int64), np.arange(width, dtype=np.int64)
    top, bottom = np.maximum(rows - half, 0), np.minimum(rows + half + 1, height)
    left, right = np.maximum(columns - half, 0), np.minimum(columns + half + 1, width)
    return total[bottom][:, right] - total[top][:, right] - total[bottom][:, left] + total[top][:, left]
