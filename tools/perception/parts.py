"""The parts of an object that matter for grasping, measured: rim, loop handle, neck, stem, tool handle, body, edge."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kb.base import Vec3
from kb.percept import Part
from tools.perception.measure import Measured
from tools.perception.sections import LEVELS, STATIONS

Array = NDArray[np.float64]

UP: Vec3 = (0.0, 0.0, 1.0)

LOOP_BULGE = 0.009
"""What sticks out of a round outline further than this is a handle [m]."""

WALL_BIAS, THINNEST_WALL = 0.001, 0.002
"""A ring of pixels looks this much thicker than the wall; thinner walls than the second cannot be told [m]."""

LOOP = 1.5
"""A loop is this many times as tall as it is thick; what is not is a stub: a bulb's base, a pear's end."""

NARROW = 0.72
"""A neck's or stem's radius is below this share of the largest one."""

STEM_RADIUS = 0.011
"""Narrow places up to this radius are stems, wider ones necks [m]."""

THIN_END = 0.62
"""The thin half of a tool is at most this share as wide as its thick half."""


def find_parts(measured: Measured) -> tuple[Part, ...]:
    """All parts that were seen, the body last."""
    parts: list[Part] = []
    if measured.is_round and not measured.is_ball:
        parts += [*_handle(measured), *_rim(measured), *_narrow(measured)]
    elif not measured.is_ball:
        parts += _tool_handle(measured)
    parts.append(_body(measured))
    return tuple(parts)


def _handle(m: Measured) -> list[Part]:
    """A loop handle: what sticks out of the round outline."""
    if m.bulge < LOOP_BULGE:
        return []
    outward = np.array([np.cos(m.bulge_azimuth), np.sin(m.bulge_azimuth)])
    side = m.blob.xyz[:, :2] - m.centre
    along, across = side @ outward, side @ np.array([-outward[1], outward[0]])
    mine = (along > m.radius + 0.35 * m.bulge) & (np.abs(across) < 0.6 * m.radius)
    if mine.sum() < 12:
        return []
    low, high = np.quantile(across[mine], [0.04, 0.96])
    shift = (low + high) / 2
    outward = outward * m.radius + np.array([-outward[1], outward[0]]) * shift * 0.7  # towards the bar's own middle
    outward /= np.linalg.norm(outward)
    width = float(np.clip(high - low, 0.004, 0.04))
    reach = m.radius + m.bulge - min(width, 0.010) / 2
    z = m.blob.xyz[mine, 2]
    bottom, top = np.quantile(z, [0.02, 0.98])
    shadowed = top - bottom < LOOP * width and _behind(m, centre=m.centre + outward * reach)
    if shadowed or np.sum(mine & ~m.blob.from_top) < 10:  # only its top is seen: a loop is about as far from both ends
        bottom = m.base + max(m.top - top, 0.0)
    centre = m.centre + outward * reach
    return [
        Part(
            region="handle",
            centre=(float(centre[0]), float(centre[1]), float(bottom + top) / 2),
            axis=UP,
            width=width,
            length=float(max(top - bottom, width)),
            radius=float(reach),
            outward=(float(outward[0]), float(outward[1]), 0.0),
            confidence=float(np.clip(mine.sum() / 60, 0.3, 1.0)),
        )
    ]


def _behind(m: Measured, centre: Array) -> bool:
    """Whether the round body hides what is at `centre` (2,) [m] from the front camera."""
    away = m.centre - m.blob.eyes[0, :2]
    away /= np.linalg.norm(away)
    x, y = centre - m.centre
    return bool(x * away[0] + y * away[1] > 0.0 and abs(x * away[1] - y * away[0]) < m.radius)


def _rim(m: Measured) -> list[Part]:
    """The top edge of a hollow thing."""
    if m.hollow <= 0 or np.isnan(m.wall):
        return []
    return [
        Part(
            region="rim",
            centre=(float(m.centre[0]), float(m.centre[1]), m.top),
            axis=UP,
            width=float(np.clip(m.wall - WALL_BIAS, THINNEST_WALL, 0.03)),
            length=float(m.hollow * (m.top - m.base)),
            radius=float(m.rim_radius),
        )
    ]


def _narrow(m: Measured) -> list[Part]:
    """A neck or a stem: a narrow stretch of the profile with something wider below it, or above and below."""
    radii = m.profile
    seen = np.flatnonzero(np.isfinite(radii))
    if len(seen) < 5:
        return []
    largest = max(float(np.nanmax(radii)), m.radius)
    inner = [k for k in seen if k >= 1 and radii[k] < NARROW * largest]
    if not inner:
        return []
    least = min(inner, key=lambda k: radii[k])
    wider_below = any(radii[k] > 1.3 * radii[least] for k in seen if k < least) or least <= 2
    if not wider_below:
        return []
    stretch = [k for k in inner if radii[k] < max(1.3 * radii[least], radii[least] + 0.002)]
    stretch = _run_around([int(k) for k in stretch], int(least))
    step = (m.top - m.base) / LEVELS
    bottom, top = m.base + stretch[0] * step, m.base + (stretch[-1] + 1) * step
    radius = _silhouette_radius(m, bottom + 0.15 * step, top - 0.15 * step)
    wider_above = any(radii[k] > 2.0 * radii[least] for k in seen if k > stretch[-1])
    stem = radius < STEM_RADIUS and wider_above
    if len(stretch) < 2 or (not stem and least < LEVELS // 3):
        return []
    return [
        Part(
            region="stem" if stem else "neck",
            centre=(float(m.centre[0]), float(m.centre[1]), float(bottom + top) / 2),
            axis=UP,
            width=2 * radius,
            length=float(top - bottom),
            radius=radius,
            confidence=float(np.clip(len(stretch) / 3, 0.3, 1.0)),
        )
    ]


def _run_around(levels: list[int], start: int) -> list[int]:
    """The consecutive levels around `start`."""
    run = [start]
    while run[-1] + 1 in levels:
        run.append(run[-1] + 1)
    while run[0] - 1 in levels:
        run.insert(0, run[0] - 1)
    return run


def _silhouette_radius(m: Measured, bottom: float, top: float) -> float:
    """Half the width of the silhouette between two heights, as the front camera sees it [m].

    Perpendicular to the viewing direction, where depth noise does not reach (a point cloud of a stem gives half of it).
    """
    to_eye = m.blob.eyes[0, :2] - m.centre
    lateral = np.array([-to_eye[1], to_eye[0]]) / np.linalg.norm(to_eye)
    z = m.blob.xyz[:, 2]
    mine = ~m.blob.from_top & (z > bottom) & (z < top)
    offset = (m.blob.xyz[mine, :2] - m.centre) @ lateral
    if len(offset) < 12:
        k = int(np.clip(((bottom + top) / 2 - m.base) / max(m.top - m.base, 1e-3) * LEVELS, 0, LEVELS - 1))
        return float(m.profile[k]) if np.isfinite(m.profile[k]) else m.radius
    slices = ((z[mine] - bottom) / 0.006).astype(int)
    spans = [np.ptp(offset[slices == k]) for k in np.unique(slices) if (slices == k).sum() >= 4]
    pixel = float(np.linalg.norm(to_eye)) / 625.0
    return float(np.median(spans) + pixel) / 2 if spans else m.radius


def _tool_handle(m: Measured) -> list[Part]:
    """The thick half of a long slim thing that is thin at the other end, and that thin half as a body."""
    longer, shorter, _ = m.box.size
    widths = m.widths
    seen = np.isfinite(widths)
    if longer < 3.0 * shorter or seen.sum() < STATIONS - 3:
        return []
    filled = np.interp(np.arange(STATIONS), np.flatnonzero(seen), widths[seen])
    half = STATIONS // 2
    first, second = float(np.median(filled[:half])), float(np.median(filled[half:]))
    thick, thin = max(first, second), min(first, second)
    if thin > THIN_END * thick:
        return []
    side = -1.0 if first > second else 1.0
    ordered = filled if side < 0 else filled[::-1]
    limit = (thick + thin) / 2
    count = next((k for k in range(STATIONS) if ordered[k] < limit and k >= 2), half)
    axis = m.box.axes()[0]
    parts: list[Part] = []
    for region, start, end, width in (("handle", 0, count, thick), ("body", count, STATIONS, thin)):
        middle = side * (0.5 - (start + end) / 2 / STATIONS) * float(longer)
        centre = m.box.centre + axis * middle
        parts.append(
            Part(
                region="handle" if region == "handle" else "body",
                centre=(float(centre[0]), float(centre[1]), float(centre[2])),
                axis=(float(axis[0]), float(axis[1]), 0.0),
                width=width,
                length=float((end - start) / STATIONS * longer),
                confidence=1.0 if region == "handle" else 0.5,
            )
        )
    return parts


def _body(m: Measured) -> Part:
    """The body of the object, or the edge of a flat one."""
    longer, shorter, height = (float(value) for value in m.box.size)
    if m.is_ball:
        centre = (float(m.centre[0]), float(m.centre[1]), (m.base + m.top) / 2)
        return Part(region="body", centre=centre, axis=UP, width=2 * m.radius, length=height, radius=m.radius)
    if m.is_round:
        wide = np.flatnonzero(np.nan_to_num(m.profile) > 0.85 * m.radius)
        step = height / LEVELS
        low, high = (wide[0] * step, (wide[-1] + 1) * step) if len(wide) else (0.0, height)
        centre = (float(m.centre[0]), float(m.centre[1]), float(m.base + (low + high) / 2))
        return Part(
            region="body", centre=centre, axis=UP, width=2 * m.radius, length=float(high - low), radius=m.radius
        )
    axes = m.box.axes()
    local = m.box.local(m.blob.xyz)
    near = np.abs(local[:, 0]) < 0.08 * longer
    middle, width = 0.0, shorter
    if m.sagitta > 0.05 and near.sum() >= 10:
        left, right = np.quantile(local[near, 1], [0.02, 0.98])
        middle, width = float(left + right) / 2, float(right - left)
    spot = m.box.centre + axes[1] * middle
    flat = height < 0.022 and shorter > 0.03
    return Part(
        region="edge" if flat else "body",
        centre=(float(spot[0]), float(spot[1]), float(spot[2])),
        axis=(float(axes[0, 0]), float(axes[0, 1]), 0.0),
        width=width,
        length=longer,
    )
