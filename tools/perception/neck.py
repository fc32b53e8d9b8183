"""Where a thing might be cut: heights at which its reach steps, and necks of its outline seen from above."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

LEVEL = 0.004
"""Thickness of the slices in which reach and width are measured [m]."""

MOST_STEPS, APART = 3, 2
"""Steps that are tried, and slices between two of them."""

LEAST_PART = 3
"""Slices on either side of a cut that nothing known is smaller than."""

TURNS = np.radians(np.arange(0.0, 180.0, 6.0))
"""Azimuths of the normals of upright cuts [rad]."""

MOST_NECKS, NECK, TURNED = 2, 0.85, 3
"""Necks that are tried, their width over the narrower side's at most, and the turns between two of them."""


def heights_of_steps(xyz: Array) -> list[float]:
    """Heights [m] at which the reach of points (N, 3) about their middle changes most, the largest change first."""
    level = np.floor(xyz[:, 2] / LEVEL).astype(np.intp)
    level -= (first := int(level.min()))
    count = int(level.max()) + 1
    if count < 2 * APART + 1:
        return []
    middle = np.median(xyz[:, :2], axis=0)
    reach = np.full(count, np.nan)
    distance = np.hypot(*(xyz[:, :2] - middle).T)
    for k in range(count):
        own = distance[level == k]
        if len(own) >= 8:
            reach[k] = np.quantile(own, 0.95)
    known = np.flatnonzero(np.isfinite(reach))
    if len(known) < 4:
        return []
    reach = np.interp(np.arange(count), known, reach[known])
    change = np.abs(reach[1:] - reach[:-1])
    heights: list[float] = []
    for _ in range(MOST_STEPS):
        k = int(np.argmax(change))
        if change[k] <= 0.002:
            break
        heights.append((first + k + 1) * LEVEL)
        change[max(0, k - APART + 1) : k + APART] = 0.0
    return heights


def necks(xyz: Array) -> list[Mask]:
    """One side (N,) of the narrowest necks of points (N, 3) seen from above, the narrowest first."""
    found: list[tuple[float, int, Mask]] = []
    xy = xyz[:, :2] - xyz[:, :2].mean(axis=0)
    for number, turn in enumerate(TURNS):
        along, across = xy @ np.array([np.cos(turn), np.sin(turn)]), xy @ np.array([-np.sin(turn), np.cos(turn)])
        slot = np.floor((along - along.min()) / LEVEL).astype(np.intp)
        count = int(slot.max()) + 1
        if count < 2 * LEAST_PART + 1:
            continue
        low, high = np.full(count, np.inf), np.full(count, -np.inf)
        np.minimum.at(low, slot, across)
        np.maximum.at(high, slot, across)
        width = np.maximum(high - low, 0.0)
        left, right = np.maximum.accumulate(width), np.maximum.accumulate(width[::-1])[::-1]
        inner = slice(LEAST_PART, count - LEAST_PART)
        ratio = width[inner] / np.maximum(np.minimum(left, right)[inner], LEVEL)
        k = int(np.argmin(ratio))
        found.append((float(ratio[k]), number, slot < LEAST_PART + k + 0.5))
    chosen: list[tuple[float, int, Mask]] = []
    for ratio, number, side in sorted(found, key=lambda item: item[:2]):
        turned = [min(abs(number - other), len(TURNS) - abs(number - other)) for _, other, _ in chosen]
        if ratio < NECK and len(chosen) < MOST_NECKS and all(turn > TURNED for turn in turned):
            chosen.append((ratio, number, side))
    return [side for _, _, side in chosen]
