"""Measure one object from its points: box, outline, ball, profile over height, hollow, widths along its length.

Nothing here knows categories: what is reported as size and position is measured. The numbers become features
(`tools.perception.features`), parts (`tools.perception.parts`) and the percept's box.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tools.perception.outline import Outline, outline
from tools.perception.sphere import Sphere, fit_sphere
from tools.perception.upright_box import UprightBox, wrap_half_turn

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

LEVELS = 12
"""Heights at which the profile of an object is measured."""

STATIONS = 12
"""Places along an object's longer axis at which its width is measured."""

ROUND = (0.035, 0.055)
"""Outlines with less roughness are round; opaque, and clear (noisier)."""

BALL_RESIDUAL = 0.0022
"""Points of a ball lie this near to the fitted one [m]."""

TOP_BIAS = (0.0007, 0.0018)
"""The mean of the highest points lies this far above the top, for opaque and for clear things (noisier) [m]."""

CROWN = 0.007
"""Height of the topmost slice of a round thing [m]."""

SPARE_WHOLE = (6, 8)
"""Farthest points left out of an outline that includes the front view, whose noise points outwards; opaque, clear."""

HIDDEN = 0.15
"""A thing of which less than this share of the points is seen from above is hidden by what it carries."""

CLEAR_LOSS = 0.20
"""Things around whose points more than this share of the pixels is unmeasured are transparent."""


@dataclass(frozen=True)
class Blob:
    """The points taken to be one object."""

    xyz: Array
    """(N, 3) [m], world."""
    rgb: Array
    """(N, 3) in [0, 1]."""
    from_top: Mask
    """Seen by the top camera (N,)."""
    clear: Array
    """Share of unmeasured pixels around each point (N,); NaN where there are only edges."""
    pieces: tuple[int, ...]
    """Colour pieces it consists of."""
    second_share: float
    """Share of the points that do not belong to the largest piece."""
    eyes: Array
    """Positions of the front and top camera (2, 3) [m]."""
    pixel: NDArray[np.intp]
    """Flat pixel index of each point in its view (N,)."""
    low: Array
    """Points too low to count as object (K, 3) that the top camera sees within the blob's outline: a hollow's floor."""

    def lost(self) -> float:
        """Mean share of unmeasured pixels, edges left aside; 0 if there are only edges."""
        known = np.isfinite(self.clear)
        return float(self.clear[known].mean()) if known.sum() >= 10 else 0.0

    def all_edge(self) -> bool:
        """Nearly all points lie at edges, so that nothing tells whether the thing is clear."""
        return bool(np.isfinite(self.clear).mean() < 0.15)


@dataclass(frozen=True)
class Measured:
    """All measurements of one object; lengths in metres, world frame."""

    blob: Blob
    box: UprightBox
    outline: Outline
    sphere: Sphere
    is_ball: bool
    is_round: bool
    """The outline (but for a bulge) is a circle."""
    centre: Array
    """Vertical axis (2,): of the circle if round, of the box otherwise."""
    radius: float
    """Radius of the outline's circle."""
    bulge: float
    """How far something sticks out of the circle."""
    bulge_azimuth: float
    """Where it does [rad]."""
    base: float
    """Height of the lowest point."""
    top: float
    """Height of the highest point."""
    profile: Array
    """Outer radius at LEVELS relative heights (LEVELS,), from the side that faces the front camera; NaN unseen."""
    hollow: float
    """Depth of the hollow seen from above over the height."""
    floor_spread: float
    """Median absolute deviation of the heights inside the hollow: contents are bumpy."""
    wall: float
    """Radial thickness of the top edge; NaN if there is no hollow."""
    rim_radius: float
    """Radius of the top edge's middle; NaN if there is no hollow."""
    widths: Array
    """Width across the longer axis at STATIONS places (STATIONS,); NaN where nothing was seen."""
    sagitta: float
    """Bend of the centre line over the length."""
    lost: float
    """Mean share of unmeasured pixels around the points, edges left aside."""
    footprint: float
    """Area seen from above over the hull's area."""


def measure(blob: Blob, support: float = 0.0, load: Measured | None = None) -> Measured:
    """Measures a blob.

    Args:
        blob: Its points.
        support: Height at which it stands [m].
        load: What stands on it, if anything does.
    """
    xyz = blob.xyz
    above = xyz[blob.from_top] if blob.from_top.sum() >= 40 else xyz
    clear = int(blob.lost() > CLEAR_LOSS)
    top = top_height(xyz[:, 2]) - TOP_BIAS[clear]
    if load is not None:
        top = covered_top(blob)
        if blob.from_top.mean() < HIDDEN:  # what hides it from above stands on its middle
            top = load.base if top < load.base < top + 0.035 else top
            above = np.concatenate([xyz, np.column_stack([2 * load.centre - xyz[:, :2], xyz[:, 2]])])
    high = above[above[:, 2] > min(support + 0.009, support + 0.4 * (top - support))]
    view = outline(high if len(high) >= 20 else above)
    ball = fit_sphere(xyz if len(xyz) < 3000 else xyz[:: len(xyz) // 1500])
    if view.roughness >= ROUND[clear]:  # from above, a lip may hide the far side of a belly
        solid = xyz[xyz[:, 2] > min(support + 0.009, support + 0.4 * (top - support))]
        whole = outline(solid, SPARE_WHOLE[clear])
        view = whole if whole.roughness < ROUND[clear] else view
    is_ball = _is_ball(ball, support, top, view)
    is_round = view.roughness < ROUND[clear]
    bulge, azimuth = view.bulge, view.bulge_azimuth
    if is_ball:
        centre, radius, base, top = (
            ball.centre[:2],
            ball.radius,
            ball.centre[2] - ball.radius,
            ball.centre[2] + ball.radius,
        )
    else:
        centre, radius, base = *_crowned(above, view, top), support
        if is_round:
            bulge, azimuth = _bulge(view, centre, radius)
    box = _box(view, is_ball, is_round, (centre, radius, bulge, azimuth), base, top)
    if not is_round and not is_ball:
        centre = box.centre[:2]
    height = max(top - base, 1e-3)
    hollow, spread, wall, rim = _hollow(blob, centre, radius, base, top) if is_round else (0.0, 0.0, np.nan, np.nan)
    widths, sagitta = _along(blob, box)
    return Measured(
        blob=blob,
        box=box,
        outline=view,
        sphere=ball,
        is_ball=is_ball,
        is_round=is_round,
        centre=centre,
        radius=radius,
        bulge=bulge,
        bulge_azimuth=azimuth,
        base=base,
        top=top,
        profile=_profile(blob, centre, base, height),
        hollow=hollow,
        floor_spread=spread,
        wall=wall,
        rim_radius=rim,
        widths=widths,
        sagitta=sagitta,
        lost=blob.lost(),
        footprint=_footprint(above, view.hull_area),
    )


def top_height(z: Array) -> float:
    """Height of the top [m] of points at heights z (N,), free of the upward bias of the largest of many noisy ones."""
    count = len(z)
    rank = max(3, int(0.01 * count))
    high = float(np.partition(z, count - rank)[count - rank]) if count > rank else float(z.max())
    return float(np.mean(z[z > high - 0.0015]))


def covered_top(blob: Blob) -> float:
    """Height of the top [m] of a blob that carries something, whose lowest points may have strayed into it."""
    high = blob.xyz[blob.from_top, 2]
    if len(high) < max(25, HIDDEN * len(blob.xyz)):
        return float(np.quantile(blob.xyz[:, 2], 0.96))
    return float(np.quantile(high, 0.75))


def _crowned(above: Array, view: Outline, top: float) -> tuple[Array, float]:
    """Centre (2,) and radius of a round thing by its top edge.

    The top's circle is seen whole from above, while a lip or a shoulder hides the far side of what is wider below it:
    there the outline falls short, so that the radius is the reach in the directions where it does not.
    """
    high = above[above[:, 2] > top - CROWN]
    if len(high) < 25 or view.roughness >= ROUND[1]:
        return view.centre, view.radius
    crown = outline(high)
    if crown.roughness > ROUND[1] or not 0.005 < crown.radius < 1.05 * view.radius:
        return view.centre, view.radius
    if np.hypot(*(crown.centre - view.centre)) > 0.25 * view.radius:
        return view.centre, view.radius
    reach = view.excess(crown.centre)
    near = np.abs(reach - np.median(reach)) < 0.15 * view.radius  # without a handle
    return crown.centre, float(np.quantile(reach[near], 0.7))


def _is_ball(ball: Sphere, support: float, top: float, view: Outline) -> bool:
    rests = abs(ball.centre[2] - ball.radius - support) < 0.006 and abs(ball.centre[2] + ball.radius - top) < 0.006
    near = np.hypot(*(ball.centre[:2] - view.centre)) < 0.008
    return bool(ball.residual < BALL_RESIDUAL and rests and near and 0.008 < ball.radius < 0.08)


def _bulge(view: Outline, centre: Array, radius: float) -> tuple[float, float]:
    """Largest excess of the outline over the circle [m] and its azimuth [rad]."""
    excess = view.excess(centre) - radius
    far = int(np.argmax(excess))
    return float(excess[far]), float(far * 2 * np.pi / len(excess))


def _box(
    view: Outline, is_ball: bool, is_round: bool, circle: tuple[Array, float, float, float], base: float, top: float
) -> UprightBox:
    """The upright box: around the ball, around the circle and what sticks out of it, or the smallest rectangle.

    `circle` is the centre (2,), the radius and the bulge [m], and the bulge's azimuth [rad].
    """
    centre, radius, bulge, azimuth = circle
    z, height = (base + top) / 2, max(top - base, 1e-3)
    if is_ball or (is_round and bulge < 0.10 * radius + 0.003):
        return UprightBox(np.array([*centre, z]), 0.0, np.array([2 * radius, 2 * radius, height]))
    if is_round:
        along = np.array([np.cos(azimuth), np.sin(azimuth)])
        middle = np.array([*(centre + along * bulge / 2), z])
        return UprightBox(middle, wrap_half_turn(azimuth), np.array([2 * radius + bulge, 2 * radius, height]))
    middle, yaw, longer, shorter = view.rectangle()
    return UprightBox(np.array([*middle, z]), yaw, np.array([longer, shorter, height]))


def _profile(blob: Blob, centre: Array, base: float, height: float) -> Array:
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


def _hollow(blob: Blob, centre: Array, radius: float, base: float, top: float) -> tuple[float, float, float, float]:
    """Depth of the hollow over the height, bumpiness of its floor, thickness and radius of the wall's top."""
    reach = np.hypot(*(blob.xyz[:, :2] - centre).T)
    height = max(top - base, 1e-3)
    ring = reach[blob.from_top & (blob.xyz[:, 2] > top - 0.006) & (reach < radius + 0.004)]
    if len(ring) < 15:
        return 0.0, 0.0, np.nan, np.nan
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
        return (0.5, 0.0, float(outer - inner), float(outer + inner) / 2) if ring_shaped else (0.0, 0.0, np.nan, np.nan)
    z = z[z <= np.quantile(z, 0.5)]  # the lower half: the other one may be the far wall, seen at a slant
    floor = float(np.median(z))
    depth = (top - floor) / height
    if depth < 0.06 or top - floor < 0.006:
        return 0.0, 0.0, np.nan, np.nan
    return depth, float(np.median(np.abs(z - floor))), float(outer - inner), float(outer + inner) / 2


def _along(blob: Blob, box: UprightBox) -> tuple[Array, float]:
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


def _footprint(above: Array, hull_area: float) -> float:
    """Area of the 3-mm cells hit from above over the hull's area."""
    cells = np.unique(np.floor(above[:, :2] / 0.003).astype(np.int64) @ np.array([100003, 1]))
    return float(len(cells) * 9e-6 / max(hull_area, 1e-5))
