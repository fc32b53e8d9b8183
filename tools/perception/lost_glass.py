"""Glass of which no pixel is measured: the shape of its holes in both depth pictures, as an upright round thing.

A depth camera in bad light loses all pixels on glass. What is left is a hole with the thing's outline. Where the holes of
the front and the top picture agree with one upright solid of revolution, its surface is put in their place. At ordinary
noise half of the pixels remain, no such hole exists, and nothing is done.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tools.perception.calibrate_view import CalibratedView
from tools.perception.connected import connected
from tools.perception.filter_depth import box_sum
from tools.perception.table_plane import TABLE_LOWER, TABLE_UPPER

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

CORE = 2
"""Half-window [px] all of which must be lost in the core of a hole: lines of lost edges are narrower."""
SMALLEST = 150
"""Pixels of the front picture that a hole needs."""
SLICE = 0.004
"""Height of a slice [m]."""
TALLEST = 0.30
"""Highest slice [m]."""
AGREEMENT = 0.72
"""Overlap over union with the holes of both pictures from which the thing is taken to be there."""
STEPS = (0.012, 0.004, 0.0015)
"""Steps of the search for its place, coarse to fine [m]."""
AROUND = 320
"""Points around each slice of the surface."""
STRIDE = 2
"""Every so many pixels are compared [px]."""


@dataclass(frozen=True)
class Upright:
    """An upright solid of revolution on the table."""

    x: float
    y: float
    radii: Array
    """Radius of each slice from the table upwards (S,) [m]."""
    agreement: float
    """Smaller one of the overlaps over unions with the holes of the two pictures."""


def restore_glass(views: tuple[CalibratedView, ...]) -> tuple[CalibratedView, ...]:
    """The views with the surfaces of upright round things where both pictures have a hole of their outline.

    Args:
        views: Calibrated pictures, among them "front" and "top".
    """
    if max(view.noise for view in views) <= 1.0:
        return views
    names = [view.name for view in views]
    front, top = views[names.index("front")], views[names.index("top")]
    holes, above = hole_mask(front), hole_mask(top)
    found: list[Upright] = []
    for part in _parts(holes, SMALLEST):
        thing = fit_upright(part, front, above, top)
        if thing is not None:
            found.append(thing)
    if not found:
        return views
    return tuple(_with_surface(view, found, hole_mask(view)) for view in views)


def hole_mask(view: CalibratedView) -> Mask:
    """Pixels (H, W) of holes that are wider than the lines that are lost at edges, less the rim that edges add."""
    lost = view.depth <= 0
    size = (2 * CORE + 1) ** 2
    core = box_sum(lost.astype(np.float32), CORE) > size - 0.5
    grown = box_sum(core.astype(np.float32), CORE) > 0.5
    inner = lost.copy()
    inner[1:] &= lost[:-1]
    inner[:-1] &= lost[1:]
    inner[:, 1:] &= lost[:, :-1]
    inner[:, :-1] &= lost[:, 1:]
    return grown & inner


def _parts(mask: Mask, least: int) -> list[Mask]:
    """Connected parts of a mask with at least so many pixels, largest first."""
    number = np.full(mask.shape, -1)
    number[mask] = np.arange(int(mask.sum()))
    beside, below = mask[:, 1:] & mask[:, :-1], mask[1:] & mask[:-1]
    first = np.concatenate([number[:, :-1][beside], number[:-1][below]])
    second = np.concatenate([number[:, 1:][beside], number[1:][below]])
    label = np.full(mask.shape, -1)
    label[mask] = connected(int(mask.sum()), first, second)
    sizes = np.bincount(label[mask])
    return [label == k for k in sorted(range(len(sizes)), key=lambda k: (-int(sizes[k]), k)) if sizes[k] >= least]


def fit_upright(hole: Mask, front: CalibratedView, above: Mask, top: CalibratedView) -> Upright | None:
    """The upright round thing whose outlines are the hole of the front picture and one of the top picture.

    Args:
        hole: One hole of the front picture (H, W).
        front: The front picture.
        above: All holes of the top picture (H, W).
        top: The top picture.

    Returns:
        The best fit, or None where it does not agree with both pictures.
    """
    rows, columns = np.nonzero(hole)
    lowest = int(rows.max())
    middle = float(columns[rows > lowest - 3].mean())
    start = _on_table(front, middle, float(lowest))
    if not (TABLE_LOWER[0] < start[0] < TABLE_UPPER[0] and TABLE_LOWER[1] < start[1] < TABLE_UPPER[1]):
        return None
    away = start - front.pose[:2, 3]
    away /= np.linalg.norm(away)
    aside = np.array([-away[1], away[0]])
    # The lowest pixel shows the near edge of the base, so the axis lies behind it.
    best, place = None, np.array([0.030, 0.0])
    for step, reach in zip(STEPS, (3, 3, 3), strict=True):
        for i in range(-reach, reach + 1):
            for j in range(-2, 3):
                along, across = place + step * np.array([i, j])
                if along <= 0.0:
                    continue
                x, y = start + along * away + across * aside
                tried = _profile(float(x), float(y), hole, front, above, top)
                if tried is not None and (best is None or tried[0].agreement > best[0].agreement):
                    best = (tried[0], np.array([along, across]))
        if best is None:
            return None
        place = best[1]
    return best[0] if best is not None and best[0].agreement >= AGREEMENT else None


def _on_table(view: CalibratedView, u: float, v: float) -> Array:
    """Where the ray of a pixel meets the table (2,) [m]."""
    ray = np.array([
        (u + view.corner[1] - (view.whole[1] - 1) / 2) / view.focal,
        (v + view.corner[0] - (view.whole[0] - 1) / 2) / view.focal,
        1.0,
    ])  # fmt: skip
    direction = view.pose[:3, :3] @ ray
    eye = view.pose[:3, 3]
    return (eye - direction * eye[2] / direction[2])[:2]


def _profile(
    x: float, y: float, hole: Mask, front: CalibratedView, above: Mask, top: CalibratedView
) -> tuple[Upright, int] | None:
    """The thing with its axis at (x, y) whose widths are those of the hole, of the height that agrees best."""
    heights = SLICE * (np.arange(int(TALLEST / SLICE)) + 0.5)
    axis = np.column_stack([np.full(len(heights), x), np.full(len(heights), y), heights])
    u, v, depth = front.project(axis)
    radii = np.zeros(len(heights))
    for k, (column, row) in enumerate(zip(np.rint(u).astype(int), np.rint(v).astype(int), strict=True)):
        if not (0 <= row < hole.shape[0] and 0 <= column < hole.shape[1]) or not hole[row, column]:
            break
        radii[k] = _half_width(hole[row], u[k]) * depth[k] / front.focal
    count = int(np.count_nonzero(radii))
    if count < 4:
        return None
    outline = _Outline(front, top, hole, above, axis, radii)
    # The rim's far side is seen above its middle, so that the hole reaches higher than the thing.
    best, cut = max((outline.agreement(n), n) for n in range(max(3, int(0.5 * count)), count + 1, 2))
    return Upright(x, y, radii[:cut], best), cut


def _half_width(line: Mask, u: float) -> float:
    """Half the length [px] of the run of a row that contains column u; hidden sides are not made up for."""
    column = round(u)
    left = column
    while left > 0 and line[left - 1]:
        left -= 1
    right = column
    while right < len(line) - 1 and line[right + 1]:
        right += 1
    return max(0.5, (right - left + 1) / 2.0)


class _Outline:
    """Outlines of a stack of discs in both pictures, slice by slice."""

    def __init__(
        self, front: CalibratedView, top: CalibratedView, hole: Mask, above: Mask, axis: Array, radii: Array
    ) -> None:
        self._pictures = [_cover(view, mask, axis, radii) for view, mask in ((front, hole), (top, above))]

    def agreement(self, count: int) -> float:
        """Smaller one of the overlaps over unions of the lowest `count` slices."""
        return min(_overlap(first < count, wanted) for first, wanted in self._pictures)


def _cover(view: CalibratedView, mask: Mask, axis: Array, radii: Array) -> tuple[NDArray[np.intp], Mask]:
    """Per looked-at pixel the lowest slice that covers it, and whether it belongs to the hole."""
    u, v, depth = view.project(axis)
    wide = np.maximum(radii, 1e-4) * view.focal / depth
    # A level disc is foreshortened by the sine of the angle under which it is seen.
    sight = axis - view.pose[:3, 3]
    flat = wide * np.abs(sight[:, 2]) / np.linalg.norm(sight, axis=1)
    used = radii > 0
    margin = 12
    rows = _every(
        max(0, int((v - flat)[used].min()) - margin), min(mask.shape[0], int((v + flat)[used].max()) + margin)
    )
    columns = _every(
        max(0, int((u - wide)[used].min()) - margin), min(mask.shape[1], int((u + wide)[used].max()) + margin)
    )
    first = np.full((len(rows), len(columns)), len(radii), np.intp)
    for k in np.flatnonzero(used)[::-1]:
        inside = ((columns - u[k]) / wide[k])[None, :] ** 2 + ((rows - v[k]) / flat[k])[:, None] ** 2 <= 1.0
        first[inside] = k
    # What is measured nearer than the thing hides it: such pixels say nothing.
    patch = mask[np.ix_(rows, columns)]
    seen = view.depth[np.ix_(rows, columns)]
    hidden = (seen > 0) & (seen < float(depth[used].max()))
    first[hidden & (first < len(radii))] = len(radii)
    return first, patch


def _every(start: int, end: int) -> NDArray[np.intp]:
    """The compared ones of pixels `start` to `end`."""
    return np.asarray(range(start, end, STRIDE), np.intp)


def _overlap(covered: Mask, wanted: Mask) -> float:
    union = int((covered | wanted).sum())
    return int((covered & wanted).sum()) / union if union else 0.0


def _with_surface(view: CalibratedView, things: list[Upright], holes: Mask) -> CalibratedView:
    """The view with the things' surfaces at the pixels of its holes."""
    points = np.concatenate([_surface(thing) for thing in things])
    u, v, depth = view.project(points)
    row, column = np.rint(v).astype(int), np.rint(u).astype(int)
    height, width = view.depth.shape
    inside = (row >= 0) & (row < height) & (column >= 0) & (column < width)
    row, column, depth, points = row[inside], column[inside], depth[inside], points[inside]
    inside = holes[row, column]
    pixel, depth, points = (row * width + column)[inside], depth[inside], points[inside]
    order = np.lexsort((depth, pixel))
    pixel, depth, points = pixel[order], depth[order], points[order]
    nearest = np.append(True, np.diff(pixel) > 0) if len(pixel) else np.zeros(0, bool)
    seen, told = view.depth.copy(), view.points.copy()
    seen.reshape(-1)[pixel[nearest]] = depth[nearest]
    told.reshape(-1, 3)[pixel[nearest]] = points[nearest]
    return replace(view, depth=seen, points=told)


def _surface(thing: Upright) -> Array:
    """Points all over the wall, which is open above as vessels are, shape (N, 3) [m]."""
    angle: Array = np.linspace(0.0, 2 * np.pi, AROUND, endpoint=False)
    fine: Array = np.arange(0.0, len(thing.radii) * SLICE, SLICE / 3)
    radius = np.interp(fine, SLICE * (np.arange(len(thing.radii)) + 0.5), thing.radii)
    return np.column_stack([
        (thing.x + radius[:, None] * np.cos(angle)).reshape(-1),
        (thing.y + radius[:, None] * np.sin(angle)).reshape(-1),
        np.repeat(fine, AROUND),
    ])  # fmt: skip
