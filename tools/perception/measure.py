"""Measure one object from its points: box, outline, ball, profile over height, hollow, widths along its length.

Nothing here knows categories: what is reported as size and position is measured. The numbers become features
(`tools.perception.features`), parts (`tools.perception.parts`) and the percept's box.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tools.perception import sections
from tools.perception.blob import CLEAR_LOSS, HIDDEN, Blob, covered_top, top_height
from tools.perception.outline import Outline, outline
from tools.perception.sphere import Sphere, fit_sphere
from tools.perception.upright_box import UprightBox, wrap_half_turn

Array = NDArray[np.float64]


ROUND = (0.035, 0.055)
"""Outlines with less roughness are round; opaque, and clear (noisier)."""

BALL_RESIDUAL = 0.0022
"""Points of a ball lie this near to the fitted one [m]."""

TOP_BIAS = (0.0007, 0.0018)
"""The mean of the highest points lies this far above the top, for opaque and for clear things (noisier) [m]."""

CROWN = 0.007
"""Height of the topmost slice of a round thing [m]."""

LEAST_EXTENT = 1e-3
"""Nothing is thinner [m]; a handful of points in one place has no extents of its own."""

FEWEST_OUTLINED = 20
"""Points that an outline needs; with fewer, all points of the thing are taken."""

SPARE_WHOLE = (6, 8)
"""Farthest points left out of an outline that includes the front view, whose noise points outwards; opaque, clear."""


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
    """Outer radius at sections.LEVELS relative heights (sections.LEVELS,), from the side that faces the front camera; NaN unseen."""
    hollow: float
    """Depth of the hollow seen from above over the height."""
    wall: float
    """Radial thickness of the top edge; NaN if there is no hollow."""
    rim_radius: float
    """Radius of the top edge's middle; NaN if there is no hollow."""
    widths: Array
    """Width across the longer axis at sections.STATIONS places (sections.STATIONS,); NaN where nothing was seen."""
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
    view = outline(high if len(high) >= FEWEST_OUTLINED else above)
    ball = fit_sphere(xyz if len(xyz) < 3000 else xyz[:: len(xyz) // 1500])
    if view.roughness >= ROUND[clear]:  # from above, a lip may hide the far side of a belly
        solid = xyz[xyz[:, 2] > min(support + 0.009, support + 0.4 * (top - support))]
        whole = outline(solid, SPARE_WHOLE[clear]) if len(solid) >= FEWEST_OUTLINED else view
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
    hollow, wall, rim = sections.hollow(blob, centre, radius, base, top) if is_round else (0.0, np.nan, np.nan)
    widths, sagitta = sections.widths_along(blob, box)
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
        profile=sections.profile(blob, centre, base, height),
        hollow=hollow,
        wall=wall,
        rim_radius=rim,
        widths=widths,
        sagitta=sagitta,
        lost=blob.lost(),
        footprint=sections.footprint(above, view.hull_area),
    )


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
        across = max(2 * radius, LEAST_EXTENT)
        return UprightBox(np.array([*centre, z]), 0.0, np.array([across, across, height]))
    if is_round:
        along = np.array([np.cos(azimuth), np.sin(azimuth)])
        middle = np.array([*(centre + along * bulge / 2), z])
        extents = np.maximum(np.array([2 * radius + bulge, 2 * radius, height]), LEAST_EXTENT)
        return UprightBox(middle, wrap_half_turn(azimuth), extents)
    middle, yaw, longer, shorter = view.rectangle()
    return UprightBox(np.array([*middle, z]), yaw, np.maximum(np.array([longer, shorter, height]), LEAST_EXTENT))
