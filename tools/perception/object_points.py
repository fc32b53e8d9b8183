"""All measured points above the table, from every view, with their voxels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tools.perception.calibrate_view import CalibratedView
from tools.perception.connected import connected
from tools.perception.table_plane import TABLE_LOWER, TABLE_UPPER
from tools.perception.transparency import clear_share

Array = NDArray[np.float64]
Index = NDArray[np.intp]

LOWEST = 0.0045
"""Points lower than this are table [m]: four standard deviations of a filtered, corrected pixel."""

DEEPEST = 0.020
"""Points farther below the table than this are not its noise; so far from its edges its heights are looked at [m]."""

HIGHEST = 0.33
"""Higher points are the arm or noise [m]; the tallest thing that the hand can lift off the table is lower."""

MARGIN = 0.014
"""How far beyond the table's edge a point may hang over [m]; the bin's wall stands at 20 mm."""

VOXEL = 0.004
"""Edge of a voxel [m] (perception.md)."""

REACH = 2
"""Voxels up to this many steps apart along each axis are linked (8-12 mm: holes at edges and in glass)."""

_GRID = np.array([180, 240, 96])
"""Voxels of the working volume; strides with room for `REACH` at both ends."""

_ORIGIN = np.array([TABLE_LOWER[0] - 0.04, TABLE_LOWER[1] - 0.06, -0.012])
"""Corner of the working volume [m]."""


@dataclass(frozen=True)
class ObjectPoints:
    """Points above the table, world frame."""

    xyz: Array
    """Positions (N, 3) [m]."""
    rgb: Array
    """Colours (N, 3) in [0, 1]."""
    view: NDArray[np.int8]
    """Number of the view (N,)."""
    pixel: Index
    """Flat pixel index in that view (N,)."""
    clear: Array
    """Share of unmeasured pixels around each point (N,), about one half on glass; NaN where there are only edges."""
    voxel: Index
    """Number of the point's voxel (N,)."""
    keys: Index
    """Flat grid index of each voxel (V,), ascending."""
    lowest: float = LOWEST
    """Height up to which points were taken for the table [m]."""

    def voxel_mean(self, values: Array) -> Array:
        """Mean over each voxel (V, k) of values (N, k)."""
        count = np.bincount(self.voxel, minlength=len(self.keys))
        sums = [np.bincount(self.voxel, weights=column, minlength=len(self.keys)) for column in values.T]
        return np.column_stack(sums) / count[:, None]

    def voxel_counts(self) -> Index:
        """Points per voxel (V,)."""
        return np.bincount(self.voxel, minlength=len(self.keys))


def object_points(views: tuple[CalibratedView, ...]) -> ObjectPoints:
    """Gathers what stands on the table from all views."""
    xyz: list[Array] = []
    rgb: list[Array] = []
    which: list[NDArray[np.int8]] = []
    pixels: list[Index] = []
    clear: list[Array] = []
    lowest = max(_table_ends(view) for view in views)
    for number, view in enumerate(views):
        p = view.points
        inside = view.measured & (p[..., 2] > lowest) & (p[..., 2] < HIGHEST)
        for axis in (0, 1):
            inside &= (p[..., axis] > TABLE_LOWER[axis] - MARGIN) & (p[..., axis] < TABLE_UPPER[axis] + MARGIN)
        chosen = np.flatnonzero(inside)
        xyz.append(p.reshape(-1, 3)[chosen].astype(np.float64))
        rgb.append(view.rgb.reshape(-1, 3)[chosen] / 255.0)
        which.append(np.full(len(chosen), number, np.int8))
        pixels.append(chosen)
        clear.append(clear_share(view.raw, view.noise).reshape(-1)[chosen])
    points = np.concatenate(xyz)
    cells = np.floor((points - _ORIGIN) / VOXEL).astype(np.intp)
    flat = (cells[:, 0] * _GRID[1] + cells[:, 1]) * _GRID[2] + cells[:, 2]
    keys, voxel = np.unique(flat, return_inverse=True)
    return ObjectPoints(
        xyz=points,
        rgb=np.concatenate(rgb),
        view=np.concatenate(which),
        pixel=np.concatenate(pixels),
        clear=np.concatenate(clear),
        voxel=voxel.reshape(-1),
        keys=keys,
        lowest=lowest,
    )


def _table_ends(view: CalibratedView) -> float:
    """Height up to which points of this view are table [m]: four standard deviations of its heights.

    They are measured below the table's plane, where nothing else is; an ordinary picture has the known value.
    """
    if view.noise <= 1.0:
        return LOWEST
    x, y, z = view.points[..., 0], view.points[..., 1], view.points[..., 2]
    inner = view.measured & (z < 0) & (z > -DEEPEST)
    inner &= (x > TABLE_LOWER[0] + DEEPEST) & (x < TABLE_UPPER[0] - DEEPEST)
    inner &= (y > TABLE_LOWER[1] + DEEPEST) & (y < TABLE_UPPER[1] - DEEPEST)
    if inner.sum() < 200:
        return LOWEST * view.noise
    return max(LOWEST, 4.0 * float(np.median(-z[inner])) / 0.6745)


def _half_neighbourhood(reach: int) -> Index:
    """Flat offsets of half of the cells within `reach` steps, each pair once."""
    steps = np.arange(-reach, reach + 1)
    x, y, z = np.meshgrid(steps, steps, steps, indexing="ij")
    flat = ((x * _GRID[1] + y) * _GRID[2] + z).ravel()
    return flat[flat > 0]


def neighbour_pairs(keys: Index, reach: int = REACH) -> tuple[Index, Index]:
    """Pairs (first, second) of voxel numbers whose cells lie within `reach` steps along each axis."""
    number = np.full(int(np.prod(_GRID)) + 1, -1, np.int32)
    number[keys] = np.arange(len(keys))
    first: list[Index] = []
    second: list[Index] = []
    for offset in _half_neighbourhood(reach):
        other = number[np.minimum(keys + offset, len(number) - 1)]
        found = np.flatnonzero(other >= 0)
        first.append(found)
        second.append(other[found].astype(np.intp))
    return np.concatenate(first), np.concatenate(second)


def clusters(points: ObjectPoints, pairs: tuple[Index, Index]) -> Index:
    """Spatial cluster of each voxel (V,)."""
    return connected(len(points.keys), *pairs)
