"""Split the points above the table into pieces: near in space and alike in colour.

Shading changes how bright a surface is, not its chromaticity, so pieces are cut where the chromaticity changes, or where
brightness changes by more than light can explain. `tools.perception.merge` then decides which pieces are one object.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tools.perception.connected import connected
from tools.perception.object_points import ObjectPoints, neighbour_pairs

Array = NDArray[np.float64]
Index = NDArray[np.intp]

FEWEST_POINTS = 30
"""Clusters with fewer points are noise at edges."""

CHROMA_RADIUS = 0.042
"""Largest distance of a voxel's chromaticity (r, g over the sum) from its colour mode."""

BRIGHTNESS_RADIUS = 1.5
"""Largest difference of log brightness within a colour mode: light alone explains a factor of 3 (ambient 0.35)."""

MOST_MODES = 8
"""Colours told apart in one cluster."""

SMALLEST_SHARE = 0.02
"""Pieces with a smaller share of their cluster's points are absorbed by a neighbour."""


GLASS = 0.28
"""Voxels around which more than this share of the pixels is lost are glass: their colour is that of what is behind."""


@dataclass(frozen=True)
class Pieces:
    """Pieces of uniform colour."""

    label: Index
    """Piece of each point (N,); -1 for noise."""
    cluster: Index
    """Spatial cluster of each piece (P,)."""
    links: dict[tuple[int, int], int]
    """Number of voxel links between two touching pieces (smaller number first)."""


def chromaticity(rgb: Array) -> Array:
    """(r, g) over the sum, and the log of the sum, shape (N, 3), of colours (N, 3) in [0, 1]."""
    total = np.maximum(rgb.sum(1), 0.03)
    return np.column_stack([rgb[:, 0] / total, rgb[:, 1] / total, np.log(total)])


def segment(points: ObjectPoints) -> Pieces:
    """Cuts the points into pieces; none of an empty table, of which clean pictures leave no point at all."""
    if not len(points.keys):
        nothing = np.zeros(0, np.intp)
        return Pieces(nothing, nothing, {})
    first, second = neighbour_pairs(points.keys)
    cluster = connected(len(points.keys), first, second)
    amount = points.voxel_counts()
    size = np.bincount(cluster, weights=amount)
    colour = points.voxel_mean(points.rgb)
    glass = _glass(points, first, second)
    mode = _colour_modes(chromaticity(colour), colour, amount, cluster, size, glass)
    mode = _smoothed(mode, amount, first, second)
    same = mode[first] == mode[second]
    piece = connected(len(points.keys), first[same], second[same])
    piece = _absorb_small(piece, amount, cluster, size, first, second)
    noise = size[cluster] < FEWEST_POINTS
    names, label = np.unique(piece, return_inverse=True)
    label = label.reshape(-1)
    label[noise] = -1
    kept = np.unique(label[label >= 0])
    renumber = np.full(len(names), -1)
    renumber[kept] = np.arange(len(kept))
    label = np.where(label >= 0, renumber[label], -1)
    owner = np.zeros(len(kept), np.intp)
    owner[label[label >= 0]] = cluster[label >= 0]
    links = _links(label, first, second)
    return Pieces(_sharpened(label, points, first, second), owner, links)


def _glass(points: ObjectPoints, first: Index, second: Index) -> NDArray[np.bool_]:
    """Which voxels (V,) are glass; where there are only edges, the neighbours decide."""
    known = np.isfinite(points.clear)
    count = len(points.keys)
    weight = np.bincount(points.voxel[known], minlength=count).astype(np.float64)
    share = np.bincount(points.voxel[known], weights=points.clear[known], minlength=count)
    sure = weight >= 3
    value = np.where(sure, share / np.maximum(weight, 1.0), 0.0)
    trust = sure.astype(np.float64)
    for _ in range(3):
        total = np.bincount(first, weights=(value * trust)[second], minlength=count)
        total += np.bincount(second, weights=(value * trust)[first], minlength=count)
        amount = np.bincount(first, weights=trust[second], minlength=count)
        amount += np.bincount(second, weights=trust[first], minlength=count)
        reached = (trust == 0) & (amount > 0)
        if not reached.any():
            break
        value[reached] = total[reached] / amount[reached]
        trust[reached] = 0.5
    return value > GLASS


def _colour_modes(
    chroma: Array, colour: Array, amount: Index, cluster: Index, size: NDArray[Any], glass: NDArray[np.bool_]
) -> Index:
    """Colour mode of each voxel (V,): per cluster, the commonest colour takes all voxels near it, then the next one.

    All glass of a cluster is one mode.
    """
    mode = np.zeros(len(cluster), np.intp)
    fresh = 0
    # Dark colours have noisy chromaticity: 0.012 of full scale per channel over a small sum.
    radius = np.maximum(CHROMA_RADIUS, 0.03 / np.maximum(colour.sum(1), 0.05))
    for number in np.flatnonzero(size >= FEWEST_POINTS):
        mode[(cluster == number) & glass] = fresh
        solid = np.flatnonzero((cluster == number) & ~glass)
        if len(solid):
            mode[solid] = fresh + 1 + _modes_of(chroma[solid], amount[solid], radius[solid])
        fresh = int(mode.max()) + 1
    return mode


def _modes_of(chroma: Array, amount: Index, radius: Array) -> Index:
    """Colour mode (n,) of the voxels of one cluster."""
    centres: list[Array] = []
    left = np.arange(len(chroma))
    while len(left) and amount[left].sum() > 0.01 * amount.sum() and len(centres) < MOST_MODES:
        centre = _densest(chroma[left], amount[left])
        near = np.zeros(len(left), bool)
        for _ in range(3):
            near = _distance(chroma[left], centre, radius[left]) < 1.0
            if not near.any():
                break
            centre = np.average(chroma[left][near], axis=0, weights=amount[left][near])
        if not near.any():
            break
        centres.append(centre)
        left = left[~near]
    mode = np.zeros(len(chroma), np.intp)
    for _ in range(3 if centres else 0):
        mode = np.argmin([_distance(chroma, centre, radius) for centre in centres], axis=0)
        centres = [
            np.average(chroma[mode == k], axis=0, weights=amount[mode == k]) if (mode == k).any() else centre
            for k, centre in enumerate(centres)
        ]
    return mode


def _distance(chroma: Array, centre: Array, radius: Array) -> Array:
    """Distance of colours (N, 3) from a mode's centre, 1 at its border."""
    plane = np.hypot(chroma[:, 0] - centre[0], chroma[:, 1] - centre[1]) / radius
    return np.hypot(plane, (chroma[:, 2] - centre[2]) / BRIGHTNESS_RADIUS)


def _densest(chroma: Array, amount: Index) -> Array:
    """The commonest colour: centre of the fullest cell of a coarse histogram."""
    cells = np.floor(chroma / np.array([0.03, 0.03, 0.5])).astype(np.int64)
    keys = (cells[:, 0] * 1000 + cells[:, 1]) * 1000 + cells[:, 2] + 500
    names, place = np.unique(keys, return_inverse=True)
    best = int(np.argmax(np.bincount(place.reshape(-1), weights=amount, minlength=len(names))))
    chosen = place.reshape(-1) == best
    return np.average(chroma[chosen], axis=0, weights=amount[chosen])


def _smoothed(mode: Index, amount: Index, first: Index, second: Index) -> Index:
    """Each voxel takes the commonest mode among itself and its neighbours, weighted by points: removes mixed edges."""
    nodes = np.concatenate([first, second, np.arange(len(mode))])
    votes = np.concatenate([mode[second], mode[first], mode])
    weight = np.concatenate([amount[second], amount[first], 2 * amount])
    width = int(mode.max()) + 1
    keys, place = np.unique(nodes * width + votes, return_inverse=True)
    total = np.bincount(place.reshape(-1), weights=weight)
    order = np.lexsort((total, keys // width))
    node = keys[order] // width
    last = np.append(np.flatnonzero(np.diff(node)), len(node) - 1)
    smoothed = mode.copy()
    smoothed[node[last]] = keys[order][last] % width
    return smoothed


def _absorb_small(
    piece: Index, amount: Index, cluster: Index, size: NDArray[Any], first: Index, second: Index
) -> Index:
    """Small pieces go to the neighbouring piece of their cluster with the most links, smallest pieces first."""
    piece = piece.copy()
    for _ in range(4):
        count = np.bincount(piece, weights=amount)
        whole = np.zeros(len(count))
        whole[piece] = size[cluster]
        small = count < np.maximum(FEWEST_POINTS, SMALLEST_SHARE * whole)
        cross = (piece[first] != piece[second]) & (small[piece[first]] | small[piece[second]])
        if not cross.any():
            break
        a, b = piece[first[cross]], piece[second[cross]]
        a, b = np.concatenate([a, b]), np.concatenate([b, a])
        from_small = small[a] & (~small[b] | (count[b] > count[a]))
        pairs, links = np.unique(a[from_small] * len(count) + b[from_small], return_counts=True)
        if not len(pairs):
            break
        order = np.argsort(links, kind="stable")
        goal = np.arange(len(count))
        goal[pairs[order] // len(count)] = pairs[order] % len(count)
        piece = goal[piece]
    return piece


def _sharpened(label: Index, points: ObjectPoints, first: Index, second: Index) -> Index:
    """Piece of each point (N,): at borders between two pieces every point goes by its own colour and transparency."""
    rival = np.full(len(label), -1)
    cross = (label[first] != label[second]) & (label[first] >= 0) & (label[second] >= 0)
    rival[first[cross]] = label[second[cross]]
    rival[second[cross]] = label[first[cross]]
    mine = label[points.voxel]
    other = rival[points.voxel]
    torn = np.flatnonzero(other >= 0)
    if not len(torn):
        return mine
    count = int(label.max()) + 1
    sure = (mine >= 0) & (other < 0)
    weight = np.maximum(np.bincount(mine[sure], minlength=count), 1)[:, None]
    feel = np.column_stack([chromaticity(points.rgb) * np.array([1.0, 1.0, 0.08]), 0.3 * np.nan_to_num(points.clear)])
    mean = np.column_stack([np.bincount(mine[sure], weights=c, minlength=count) for c in feel[sure].T]) / weight
    lone = np.bincount(mine[sure], minlength=count) < 10  # a piece that is all border keeps its points
    to_mine = np.linalg.norm(feel[torn] - mean[mine[torn]], axis=1)
    to_other = np.linalg.norm(feel[torn] - mean[other[torn]], axis=1)
    switch = (to_other < to_mine) & ~lone[mine[torn]] & ~lone[other[torn]]
    sharp = mine.copy()
    sharp[torn[switch]] = other[torn[switch]]
    return sharp


def _links(label: Index, first: Index, second: Index) -> dict[tuple[int, int], int]:
    a, b = label[first], label[second]
    cross = (a != b) & (a >= 0) & (b >= 0)
    low, high = np.minimum(a[cross], b[cross]), np.maximum(a[cross], b[cross])
    width = int(label.max(initial=0)) + 1
    keys, counts = np.unique(low * width + high, return_counts=True)
    return {(int(key // width), int(key % width)): int(count) for key, count in zip(keys, counts, strict=True)}
