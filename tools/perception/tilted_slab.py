"""Find a flat thing that leans on something of its own colour: an inclined rectangle that stands on the table.

Colour tells them apart no more, but nothing known has a large inclined flat face: it is a phone or a book that leans.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tools.perception.connected import connected

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

TILTS = np.radians(np.arange(30.0, 81.0, 5.0))
"""Angles between the face and the table that are tried [rad]; what lies flat or stands upright does not lean."""

TURNS = np.radians(np.arange(0.0, 360.0, 5.0))
"""Azimuths of the face's normal that are tried [rad]."""

LEAST_TILT, MOST_TILT = np.radians(30.0), np.radians(82.0)
"""Angles between the refined face and the table [rad]."""

MOST_TRIED = 800
"""Points with which the directions are tried."""

BIN = 0.005
"""Thickness of the slices counted along each direction [m]."""

MOST_SLICES, FEWEST_TRIED, FEWEST = 5, 20, 250
"""Slices that are tried, and the points that one needs among the tried ones and among all: a box's own faces cut by an
inclined plane may fill the first ones."""

NEAR = 0.0025
"""Points this near to the face's plane belong to it [m]: two standard deviations at the far end of the table."""

CELL = 0.006
"""Edge of the cells in which the face's area is counted [m]."""

SHORTEST, LEAST_AREA, LEAST_FILL = 0.040, 0.0030, 0.7
"""Least side [m] and area [m^2] of the face, and the least share of it that is seen."""

THICK = 0.0145
"""What lies this deep under the face is part of the slab [m]."""

SMALLEST = 0.12
"""A slab and what it leans on are together longer than this [m]."""

STANDS = 0.022
"""Its lowest edge is lower than this [m]."""

MARGIN = 0.008
"""How far edge points stray around the face [m]."""


@dataclass(frozen=True)
class TiltedSlab:
    """An inclined flat thing."""

    part: Mask
    """Which points (N,) belong to it."""
    normal: Array
    """Unit normal of the upper face (3,), upwards."""
    sides: tuple[float, float]
    """Longer and shorter side of its face [m]."""


def tilted_slab(xyz: Array) -> TiltedSlab | None:
    """The inclined slab with most points among points (N, 3) [m] of one colour, world frame; None if there is none."""
    if float(np.hypot(*np.ptp(xyz[:, :2], axis=0))) < SMALLEST:
        return None
    few = xyz[:: max(1, len(xyz) // MOST_TRIED)]
    best: TiltedSlab | None = None
    for near in _slices(few):
        slab = _slab(xyz, few[near])
        if slab is not None and (best is None or slab.part.sum() > best.part.sum()):
            best = slab
    return best


def _slab(xyz: Array, seed: Array) -> TiltedSlab | None:
    """The slab whose upper face some points (M, 3) [m] lie near to, if it looks like one."""
    normal, offset = _fitted(seed)
    for reach in (2 * NEAR, NEAR, NEAR):
        near = np.abs(xyz @ normal - offset) < reach
        if near.sum() < FEWEST:
            return None
        normal, offset = _fitted(xyz[near])
    if not np.cos(MOST_TILT) < normal[2] < np.cos(LEAST_TILT):
        return None
    depth = xyz @ normal - offset
    across = np.array([-normal[1], normal[0], 0.0]) / float(np.hypot(normal[0], normal[1]))
    flat = np.column_stack([xyz @ across, xyz @ np.cross(normal, across)])
    face = np.abs(depth) < NEAR
    low, high, fill = _rectangle(flat[face])
    sides = high - low
    if sides.min() < SHORTEST or np.prod(sides) < LEAST_AREA or fill < LEAST_FILL:
        return None
    inside = np.all((flat > low - MARGIN) & (flat < high + MARGIN), axis=1)
    part = inside & (depth > -THICK) & (depth < 2 * NEAR)
    if float(np.quantile(xyz[part, 2], 0.01)) > STANDS:
        return None
    return TiltedSlab(part, normal, (float(sides.max()), float(sides.min())))


def _slices(few: Array) -> list[Mask]:
    """The fullest slices (M,) of points (M, 3) between inclined planes, each of other points than the ones before."""
    tilt, turn = (grid.ravel() for grid in np.meshgrid(TILTS, TURNS, indexing="ij"))
    normals = np.column_stack([np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), np.cos(tilt)])
    along = (few - few.mean(axis=0)) @ normals.T
    slot = np.floor((along - along.min()) / BIN).astype(np.intp)
    width = int(slot.max()) + 1
    flat = (slot + width * np.arange(len(normals))).ravel()
    left = np.ones(len(few), bool)
    slices: list[Mask] = []
    for _ in range(MOST_SLICES):
        weight = np.repeat(left.astype(np.float64), len(normals))
        which, place = divmod(int(np.argmax(np.bincount(flat, weights=weight))), width)
        near = left & (slot[:, which] == place)
        if near.sum() < FEWEST_TRIED:
            break
        slices.append(near)
        left &= ~near
    return slices


def _fitted(points: Array) -> tuple[Array, float]:
    """Least-squares plane through points (N, 3): upward unit normal (3,) and offset [m]."""
    middle = points.mean(axis=0)
    _, axes = np.linalg.eigh(np.cov((points - middle).T))
    normal = axes[:, 0] * (1.0 if axes[2, 0] >= 0 else -1.0)
    return normal, float(normal @ middle)


def _rectangle(flat: Array) -> tuple[Array, Array, float]:
    """Corners (2,), (2,) [m] of the largest patch among points (N, 2) in the face's plane, and the share of it seen.

    Where the plane runs on through the other thing it cuts off a thin strip: only cells with neighbours on all sides
    count.
    """
    origin = flat.min(axis=0) - 2 * CELL
    cells = np.floor((flat - origin) / CELL).astype(np.intp)
    grid = np.zeros(tuple(cells.max(axis=0) + 3), bool)
    grid[cells[:, 0], cells[:, 1]] = True
    full = grid.copy()
    for axis in (0, 1):
        for step in (-1, 1):
            full &= np.roll(grid, step, axis=axis)
    rows, columns = np.nonzero(full)
    if not len(rows):
        return np.zeros(2), np.zeros(2), 0.0
    number = np.full(full.shape, -1)
    number[rows, columns] = np.arange(len(rows))
    pairs = [(number[rows, columns], other) for other in (number[rows + 1, columns], number[rows, columns + 1])]
    first = np.concatenate([mine[other >= 0] for mine, other in pairs])
    second = np.concatenate([other[other >= 0] for _, other in pairs])
    patch = connected(len(rows), first, second)
    chosen = patch == int(np.argmax(np.bincount(patch)))
    low = np.array([rows[chosen].min() - 1, columns[chosen].min() - 1])
    high = np.array([rows[chosen].max() + 2, columns[chosen].max() + 2])
    fill = float(grid[low[0] : high[0], low[1] : high[1]].mean())
    return origin + low * CELL, origin + high * CELL, fill
