"""What a depth camera adds to the truth (benchmark.md section 2): jitter, a smooth field, holes at edges and in glass."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

PIXEL_SIGMA = 0.002
"""Standard deviation of the depth of one pixel [m]."""
FIELD_SIGMA = 0.0015
"""Standard deviation of the smooth part of the depth error [m]."""
FIELD_CELLS = 8
"""Cells of the smooth field over the image's height: errors are alike over about 60 of 480 pixels."""
EDGE_STEP = 0.012
"""Step in depth between neighbouring pixels [m] from which a pixel counts as an edge."""
EDGE_DROP, CLEAR_DROP = 0.5, 0.5
"""Share of the pixels that are lost at edges, and on transparent surfaces."""
COLOUR_SIGMA = 0.012
"""Standard deviation of one colour channel, of the full scale."""


def noisy_depth(
    depth: NDArray[np.float32], through: NDArray[np.bool_], rng: np.random.Generator, scale: float
) -> NDArray[np.float32]:
    """Measured depth [m] (H, W), 0 where nothing is measured.

    Args:
        depth: True depth [m] (H, W), 0 where nothing was met.
        through: Pixels on transparent surfaces (H, W).
        rng: Source of the noise.
        scale: Scale of all parts; 0 gives the truth back, probabilities are capped at 1.
    """
    if scale <= 0.0:
        return depth.astype(np.float32)
    seen = depth > 0
    measured = depth + rng.standard_normal(depth.shape, dtype=np.float32) * np.float32(scale * PIXEL_SIGMA)
    measured += smooth_field(depth.shape, rng) * np.float32(scale * FIELD_SIGMA)
    chance = np.zeros(depth.shape, np.float32)
    chance[_edges(depth)] = min(1.0, scale * EDGE_DROP)
    chance[through] = np.maximum(chance[through], min(1.0, scale * CLEAR_DROP))
    lost = rng.random(depth.shape, dtype=np.float32) < chance
    measured[lost | ~seen] = 0.0
    return np.maximum(measured, 0.0)


def noisy_colour(rgb: NDArray[np.float32], rng: np.random.Generator, scale: float) -> NDArray[np.uint8]:
    """Colour (H, W, 3) as bytes, from [0, 1] with mild noise."""
    if scale > 0.0:
        noise = rng.standard_normal(rgb.shape, dtype=np.float32) * np.float32(scale * COLOUR_SIGMA)
        return np.clip((rgb + noise) * 255.0 + 0.5, 0, 255).astype(np.uint8)
    return np.clip(rgb * 255.0 + 0.5, 0, 255).astype(np.uint8)


def smooth_field(shape: tuple[int, int], rng: np.random.Generator) -> NDArray[np.float32]:
    """A smooth random field (H, W) of zero mean and unit variance: bilinear between random knots."""
    height, width = shape
    rows, columns = FIELD_CELLS, max(2, round(FIELD_CELLS * width / height))
    knots = rng.standard_normal((rows + 1, columns + 1), dtype=np.float32)
    field = _interpolated(_interpolated(knots, height).T, width).T
    return (field - field.mean()).astype(np.float32)


def _interpolated(knots: NDArray[np.float32], count: int) -> NDArray[np.float32]:
    """Linear interpolation along axis 0 to `count` samples; weights are scaled so that the variance is one."""
    place = np.linspace(0, len(knots) - 1.001, count, dtype=np.float32)
    low = place.astype(int)
    share = (place - low)[:, None]
    blend = (1 - share) * knots[low] + share * knots[low + 1]
    return (blend / np.sqrt((1 - share) ** 2 + share**2)).astype(np.float32)


def _edges(depth: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Pixels next to a step in depth (H, W)."""
    edge = np.zeros(depth.shape, bool)
    across = np.abs(np.diff(depth, axis=1)) > EDGE_STEP
    down = np.abs(np.diff(depth, axis=0)) > EDGE_STEP
    edge[:, 1:] |= across
    edge[:, :-1] |= across
    edge[1:] |= down
    edge[:-1] |= down
    return edge
