"""OCCLUDES: how much of an object's outline another one hides from the front camera (ledger G51).

A solid is often wider than the thing: a bar for a tool, a disc for a bowl. So what hides is cut down to where its surface
was seen.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kb.viewpoint import EYE
from tools.scene_relations.solid import Piece, Solid, largest

Array = NDArray[np.float64]

HIDDEN_SHARE = 0.25
"""Share of the outline that must be hidden."""
GRID = 20
"""Rays per side of the window around the hidden object."""
SPACING, NARROWEST = 1.25, 0.004
"""A ray passes a thing if no seen point of it is nearer to the ray than so many times the points' mean spacing, and than
so much [rad] (4 mm at 1 m): in evenly strewn points a gap that wide is rare."""
FEWEST_POINTS = 30
"""With fewer seen points the solid alone tells."""


def hides(front: Solid, back: Solid, seen: Array) -> bool:
    """OCCLUDES: `front`, of whose surface the points `seen` (N, 3) are known, hides `HIDDEN_SHARE` of `back`."""
    if not _may_hide(front, back):
        return False
    rays, covered = _covered(front, back)
    return _share(covered) >= HIDDEN_SHARE and _share(_seen_to_cover(rays, covered, seen)) >= HIDDEN_SHARE


def hidden_share(front: Solid, back: Solid, points: Array | None = None) -> float:
    """Share of the rays from the front camera to `back` that meet `front` before, in [0, 1].

    Args:
        front: What may hide.
        back: What may be hidden.
        points: Seen points of the surface of `front` (N, 3) [m]: only rays near to one of them meet it.
    """
    if not _may_hide(front, back):
        return 0.0
    rays, covered = _covered(front, back)
    return _share(covered if points is None else _seen_to_cover(rays, covered, points))


def _covered(front: Solid, back: Solid) -> tuple[Array, NDArray[np.bool_]]:
    """The rays (N, 3) from the front camera to `back`, and which of them the solid of `front` meets before."""
    rays, behind = _rays_to(back)
    return rays, first_hit(front, rays) < behind


@lru_cache(maxsize=64)
def _rays_to(solid: Solid) -> tuple[Array, Array]:
    """Unit rays (N, 3) from the front camera that meet the solid, and where [m]: each other thing may stand before it."""
    rays = _window(solid)
    behind = first_hit(solid, rays)
    seen = np.isfinite(behind)
    return rays[seen], behind[seen]


def _seen_to_cover(rays: Array, covered: NDArray[np.bool_], points: Array) -> NDArray[np.bool_]:
    """Which of the covered rays pass near a seen point (N, 3); all of them where too few were seen."""
    if len(points) < FEWEST_POINTS or not covered.any():
        return covered
    near = covered.copy()
    near[covered] = _near_points(rays[covered], points)
    return near


def _share(covered: NDArray[np.bool_]) -> float:
    return float(covered.mean()) if len(covered) else 0.0


def _near_points(rays: Array, points: Array) -> NDArray[np.bool_]:
    """Which unit rays (N, 3) from the front camera pass near one of the points (M, 3), shape (N,)."""
    along = points - np.asarray(EYE)
    seen = _angles(along / np.linalg.norm(along, axis=1, keepdims=True))
    width, height = np.ptp(seen, axis=0)
    reach = max(NARROWEST, SPACING * math.sqrt(width * height / len(points)))
    apart = _angles(rays)[:, None] - seen[None]
    return np.asarray((apart**2).sum(axis=2).min(axis=1) <= reach**2)


def _angles(rays: Array) -> Array:
    """Bearing and dip (N, 2) [rad] of unit rays (N, 3) from the front camera."""
    return np.column_stack([np.arctan2(rays[:, 1], -rays[:, 0]), np.arcsin(rays[:, 2])])


def first_hit(solid: Solid, rays: Array) -> Array:
    """Distance at which unit rays (N, 3) from the front camera enter the solid, infinite if never, shape (N,) [m]."""
    return np.min([_enter(piece, rays) for piece in solid.pieces], axis=0)


def _enter(piece: Piece, rays: Array) -> Array:
    eye = np.asarray(EYE)
    if piece.ball > 0.0:
        return _roots(eye - np.array([*piece.centre, piece.low]), rays, piece.ball)[0]
    z0, z1 = _slab(eye[2], rays[:, 2], piece.low, piece.high)
    if piece.half == (0.0, 0.0):
        x0, x1 = _roots(eye[:2] - np.asarray(piece.centre), rays[:, :2], piece.radius)
        return _common((z0, x0), (z1, x1))
    start = piece.local(eye[None, :2])[0]
    along = piece.local(rays[:, :2] + np.asarray(piece.centre))
    u0, u1 = _slab(start[0], along[:, 0], -piece.half[0], piece.half[0])
    v0, v1 = _slab(start[1], along[:, 1], -piece.half[1], piece.half[1])
    return _common((z0, u0, v0), (z1, u1, v1))


def _common(entries: tuple[Array, ...], exits: tuple[Array, ...]) -> Array:
    """Entry into the intersection of convex sets, infinite where it is empty."""
    first, last = np.max(entries, axis=0), np.min(exits, axis=0)
    return np.where(last > np.maximum(first, 0.0), first, np.inf)


def _slab(origin: float, along: Array, low: float, high: float) -> tuple[Array, Array]:
    """Parameters at which origin + t along enters and leaves [low, high]."""
    safe = np.where(np.abs(along) < 1e-12, 1e-12, along)
    first, second = (low - origin) / safe, (high - origin) / safe
    return np.minimum(first, second), np.maximum(first, second)


def _roots(offset: Array, rays: Array, radius: float) -> tuple[Array, Array]:
    """Parameters at which offset + t rays has the length `radius`; (infinite, minus infinite) if never."""
    a = np.maximum((rays**2).sum(axis=1), 1e-12)
    b, c = rays @ offset, float(offset @ offset) - radius**2
    square = b**2 - a * c
    root = np.sqrt(np.maximum(square, 0.0))
    hit = square >= 0.0
    return np.where(hit, (-b - root) / a, np.inf), np.where(hit, (-b + root) / a, -np.inf)


def _window(solid: Solid) -> Array:
    """Unit rays from the front camera that fill the angular window of the object, shape (N, 3)."""
    bearing, half = _sector(solid)
    piece = largest(solid)
    near = math.hypot(EYE[0] - piece.centre[0], EYE[1] - piece.centre[1])
    reach = math.hypot(*piece.half) + piece.reach()
    dips = [math.atan2(z - EYE[2], near + side * reach) for z in (solid.low, solid.high) for side in (-1.0, 1.0)]
    steps = (np.arange(GRID) + 0.5) / GRID
    across = bearing + half * (2.0 * steps - 1.0)
    dip = min(dips) + (max(dips) - min(dips)) * steps
    u, v = (grid.ravel() for grid in np.meshgrid(across, dip))
    return np.column_stack([-np.cos(u) * np.cos(v), np.sin(u) * np.cos(v), np.sin(v)])


def _may_hide(front: Solid, back: Solid) -> bool:
    """A quick look: seen from the front camera, the two lie in overlapping sectors of the horizon."""
    (a, half_a), (b, half_b) = _sector(front), _sector(back)
    return abs(a - b) <= half_a + half_b


def _sector(solid: Solid) -> tuple[float, float]:
    """Bearing of the largest piece from the front camera and half its angular width, handle included [rad]."""
    piece = largest(solid)
    x, y = EYE[0] - piece.centre[0], piece.centre[1] - EYE[1]
    reach = math.hypot(*piece.half) + piece.reach() + (0.03 if len(solid.pieces) > 1 else 0.0)
    return math.atan2(y, x), math.asin(min(1.0, reach / math.hypot(x, y)))
