"""Sections of an object: radii over its height, widths along its length, the hollow inside, the footprint."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tools.perception.blob import Blob
from tools.perception.upright_box import UprightBox

Array = NDArray[np.float64]

LEVELS = 12
"""Heights at which the profile of an object is measured."""

STATIONS = 12
"""Places along an object's longer axis at which its width is measured."""


def profile(blob: Blob, centre: Array, base: float, height: float) -> Array:
    """Outer radius at each relative height, from the points on the front camera's side of the axis."""
    side = blob.xyz[:, :2] - centre
    to_eye = blob.eyes[0, :2] - centre
    distance = np.hypot(side[:, 0], side[:, 1])
    facing = side @ to_eye > 0.4 * distance * np.hypot(*to_eye)
    level = np.clip(((blob.xyz[:, 2] - base) / height * LEVELS).astype(int), 0, LEVELS - 1)
    return ranks_by_group(distance[facing], level[facing], LEVELS, (0.8,), 4)[0]


def ranks_by_group(
    values: Array, group: NDArray[np.intp], count: int, shares: tuple[float, ...], fewest: int
) -> list[Array]:
    """Per share, the value at that rank within each group (count,); NaN for groups with too few values.

    Args:
        values: (N,).
        group: Group of each value (N,), in [0, count).
        count: Number of groups.
        shares: Ranks in [0, 1].
        fewest: Least number of values.
    """
    order = np.lexsort((values, group))
    sizes = np.bincount(group, minlength=count)
    starts = np.concatenate([[0], np.cumsum(sizes)[:-1]])
    found: list[Array] = []
    for share in shares:
        place = starts + np.round(share * np.maximum(sizes - 1, 0)).astype(int)
        picked = values[order[np.minimum(place, len(values) - 1)]] if len(values) else np.full(count, np.nan)
        found.append(np.where(sizes >= fewest, picked, np.nan))
    return found


def hollow(blob: Blob, centre: Array, radius: float, base: float, top: float) -> tuple[float, float, float]:
    """Depth of the hollow over the height, thickness and radius of the wall's top."""
    reach = np.hypot(*(blob.xyz[:, :2] - centre).T)
    height = max(top - base, 1e-3)
    ring = reach[blob.from_top & (blob.xyz[:, 2] > top - 0.006) & (reach < radius + 0.004)]
    if len(ring) < 15:
        return 0.0, np.nan, np.nan
    inner, outer = np.quantile(ring, 0.06), np.quantile(ring, 0.94)
    z = np.concatenate(
        [
            blob.xyz[blob.from_top & (reach < 0.6 * inner), 2],
            blob.low[np.hypot(*(blob.low[:, :2] - centre).T) < 0.6 * inner, 2],
        ]
    )
    if len(z) < 12:
        # Something else hides the inside: a ring without a middle is a rim, of a hollow of unknown depth.
        ring_shaped = np.quantile(ring, 0.3) > 0.7 * radius
        return (0.5, float(outer - inner), float(outer + inner) / 2) if ring_shaped else (0.0, np.nan, np.nan)
    z = z[z <= np.quantile(z, 0.5)]  # the lower half: the other one may be the far wall, seen at a slant
    floor = float(np.median(z))
    depth = (top - floor) / height
    if depth < 0.06 or top - floor < 0.006:
        return 0.0, np.nan, np.nan
    return depth, float(outer - inner), float(outer + inner) / 2


def widths_along(blob: Blob, box: UprightBox) -> tuple[Array, float]:
    """Width at each station of the longer axis, and the bend of the centre line over the length."""
    local = box.local(blob.xyz)
    station = np.clip(((local[:, 0] / box.size[0] + 0.5) * STATIONS).astype(int), 0, STATIONS - 1)
    low, high = ranks_by_group(local[:, 1], station, STATIONS, (0.02, 0.98), 5)
    widths, middles = high - low, (high + low) / 2
    seen = np.isfinite(middles)
    if seen.sum() < 4:
        return widths, 0.0
    x = (np.arange(STATIONS) + 0.5) / STATIONS - 0.5
    bend = float(np.polyfit(x[seen], middles[seen], 2)[0]) / 4  # sagitta of a x^2 over half the length: a / 4
    return widths, abs(bend) / float(box.size[0])


def footprint(above: Array, hull_area: float) -> float:
    """Area of the 3-mm cells hit from above over the hull's area."""
    cells = np.unique(np.floor(above[:, :2] / 0.003).astype(np.int64) @ np.array([100003, 1]))
    return float(len(cells) * 9e-6 / max(hull_area, 1e-5))
