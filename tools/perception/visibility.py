"""How much of each object's silhouette the front camera sees: the share that nothing nearer hides."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tools.perception.calibrate_view import CalibratedView
from tools.perception.measure import Measured
from tools.perception.sections import LEVELS

Array = NDArray[np.float64]

CELL = 5
"""Edge of the cells in which silhouettes are compared [px]."""

NEARER = 0.012
"""A pixel hides the object if what it shows is nearer by more than this [m]."""


def visible_fraction(measured: Measured, front: CalibratedView) -> float:
    """Share in [0, 1] of the object's silhouette that the front camera sees.

    The silhouette is that of the measured shape (a body of revolution or the upright box), hidden parts included.
    """
    u, v, depth = front.project(_hull_points(measured))
    height, width = front.depth.shape
    inside = (u >= 0) & (u < width) & (v >= 0) & (v < height) & (depth > 0)
    if not inside.any():
        return 0.0
    columns, rows = (u[inside] / CELL).astype(int), (v[inside] / CELL).astype(int)
    keys, place = np.unique(rows * 10000 + columns, return_inverse=True)
    nearest = np.full(len(keys), np.inf)
    np.minimum.at(nearest, place.reshape(-1), depth[inside])
    hidden = 0
    for key, limit in zip(keys.tolist(), nearest.tolist(), strict=True):
        top, left = key // 10000 * CELL, key % 10000 * CELL
        patch = front.depth[top : top + CELL, left : left + CELL]
        seen = patch[patch > 0]
        hidden += len(seen) > 0 and float(np.median(seen)) < limit - NEARER
    return 1.0 - hidden / len(keys)


def _hull_points(m: Measured) -> Array:
    """Points on the measured shape (N, 3), about 4 mm apart."""
    if m.is_ball:
        k = np.arange(400) + 0.5
        z, turn = 1 - 2 * k / 400, np.pi * (1 + 5**0.5) * k
        r = np.sqrt(1 - z * z)
        return m.sphere.centre + m.radius * np.column_stack([r * np.cos(turn), r * np.sin(turn), z])
    if m.is_round:
        seen = np.flatnonzero(np.isfinite(m.profile))
        levels = np.linspace(m.base, m.top, max(8, int((m.top - m.base) / 0.004)))
        place = (levels - m.base) / max(m.top - m.base, 1e-3) * LEVELS - 0.5
        radii = np.interp(place, seen, m.profile[seen]) if len(seen) else np.full(len(levels), m.radius)
        turn = np.arange(48) * (2 * np.pi / 48)
        circle = np.stack([np.cos(turn), np.sin(turn)])
        xy = m.centre[None, None] + np.minimum(radii, m.radius)[:, None, None] * circle.T[None]
        return np.concatenate([xy, np.broadcast_to(levels[:, None, None], (len(levels), 48, 1))], axis=-1).reshape(
            -1, 3
        )
    counts = np.maximum(2, np.minimum(40, (m.box.size / 0.004).astype(int)))
    grids = [np.linspace(-0.5, 0.5, int(n)) * s for n, s in zip(counts, m.box.size, strict=True)]
    faces: list[Array] = []
    for axis in range(3):
        others = [grids[i] for i in range(3) if i != axis]
        a, b = np.meshgrid(*others)
        for end in (grids[axis][0], grids[axis][-1]):
            columns = [a.ravel(), b.ravel()]
            columns.insert(axis, np.full(a.size, end))
            faces.append(np.column_stack(columns))
    return np.concatenate(faces) @ m.box.axes() + m.box.centre
