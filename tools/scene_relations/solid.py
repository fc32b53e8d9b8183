"""A perceived object as a few upright solids: discs, rectangles and balls whose distances have closed forms.

A piece is an upright rectangle in the horizontal plane (possibly a point), rounded by `radius`, extended over a range of
heights, and grown by a ball. So a box, a cylinder and a sphere are one kind of thing, and the distance of two pieces
is exact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kb.percept import Part, PerceivedObject

Array = NDArray[np.float64]

ROUND = 0.85
"""Least ratio of the horizontal extents for a compound thing to count as round: vases and glasses have 1, a loop
handle gives a cup 0.75."""
MOUTH = 1.3
"""Radius of the mouth above a neck over the neck's own."""


@dataclass(frozen=True)
class Piece:
    """One upright convex solid in the world frame."""

    centre: tuple[float, float]
    """Horizontal centre [m]."""
    half: tuple[float, float]
    """Half extents along and across `yaw` [m]."""
    yaw: float
    """Azimuth of the first extent [rad]."""
    radius: float
    """Horizontal rounding [m]: a disc has half (0, 0)."""
    low: float
    high: float
    """Range of heights [m], before growing by the ball."""
    ball: float = 0.0
    """Radius of the ball by which the whole is grown [m]."""

    def corners(self) -> Array:
        """Corners of the unrounded rectangle, in order, shape (4, 2)."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        a, b = self.half
        local = np.array([(a, b), (-a, b), (-a, -b), (a, -b)])
        return local @ np.array([[c, s], [-s, c]]) + np.asarray(self.centre)

    def local(self, points: Array) -> Array:
        """World points (N, 2) in the rectangle's own axes, shape (N, 2)."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        return (points - np.asarray(self.centre)) @ np.array([[c, -s], [s, c]])

    def reach(self) -> float:
        """Horizontal rounding plus ball [m]."""
        return self.radius + self.ball

    def horizontal_distance(self, points: Array) -> Array:
        """Distance of world points (N, 2) to the footprint, 0 inside, shape (N,)."""
        outside = np.maximum(np.abs(self.local(points)) - np.asarray(self.half), 0.0)
        return np.maximum(np.hypot(outside[:, 0], outside[:, 1]) - self.reach(), 0.0)

    def distance(self, points: Array) -> Array:
        """Distance of world points (N, 3) to the solid, 0 inside, shape (N,)."""
        outside = np.maximum(np.abs(self.local(points[:, :2])) - np.asarray(self.half), 0.0)
        flat = np.maximum(np.hypot(outside[:, 0], outside[:, 1]) - self.radius, 0.0)
        z = points[:, 2]
        tall = np.maximum(np.maximum(self.low - z, z - self.high), 0.0)
        return np.maximum(np.hypot(flat, tall) - self.ball, 0.0)


@dataclass(frozen=True)
class Solid:
    """An object as a union of pieces."""

    pieces: tuple[Piece, ...]

    @property
    def low(self) -> float:
        return min(piece.low - piece.ball for piece in self.pieces)

    @property
    def high(self) -> float:
        return max(piece.high + piece.ball for piece in self.pieces)

    def contains_horizontally(self, points: Array, slack: float = 0.0) -> NDArray[np.bool_]:
        """Which world points (N, 2) lie over the footprint, grown by `slack` [m], shape (N,)."""
        return np.min([piece.horizontal_distance(points) for piece in self.pieces], axis=0) <= slack

    def distance(self, points: Array) -> Array:
        """Distance of world points (N, 3) to the union, shape (N,)."""
        return np.min([piece.distance(points) for piece in self.pieces], axis=0)


def largest(solid: Solid) -> Piece:
    """The piece with the largest footprint: a handle's owner, not the handle."""
    return max(solid.pieces, key=lambda piece: (piece.half[0] + piece.reach()) * (piece.half[1] + piece.reach()))


def solid_of(obj: PerceivedObject) -> Solid:
    """The pieces of a perceived object: ball, disc or rectangle, and a loop handle where one was seen."""
    low, high = obj.base_z, obj.top_z
    x, y, _ = obj.position
    handle = next((p for p in obj.parts if p.region == "handle" and p.outward is not None and p.radius), None)
    if obj.shape == "sphere":
        r = sum(obj.size) / 6.0
        return Solid((Piece((x, y), (0.0, 0.0), 0.0, 0.0, obj.position[2], obj.position[2], r),))
    if handle is not None:
        return _with_handle(obj, handle)
    is_round = obj.shape in ("cylinder", "bowl") or (
        obj.shape == "compound" and min(obj.size[:2]) > ROUND * max(obj.size[:2])
    )
    if is_round:
        return Solid(_discs(obj, (x, y), (obj.size[0] + obj.size[1]) / 4.0))
    return Solid((Piece((x, y), (obj.size[0] / 2.0, obj.size[1] / 2.0), obj.yaw, 0.0, low, high),))


def _discs(obj: PerceivedObject, centre: tuple[float, float], radius: float) -> tuple[Piece, ...]:
    """A round thing as discs: one, or three where a stem or neck makes it slim in between."""
    slim = obj.part("stem") or obj.part("neck")
    if slim is None or slim.width >= 1.8 * radius:
        return (Piece(centre, (0.0, 0.0), 0.0, radius, obj.base_z, obj.top_z),)
    low = min(max(slim.centre[2] - slim.length / 2.0, obj.base_z), obj.top_z)
    high = min(max(slim.centre[2] + slim.length / 2.0, low), obj.top_z)
    mouth = radius if slim.region == "stem" else min(radius, MOUTH * slim.width / 2.0)
    discs = ((radius, obj.base_z, low), (slim.width / 2.0, low, high), (mouth, high, obj.top_z))
    return tuple(Piece(centre, (0.0, 0.0), 0.0, r, z0, z1) for r, z0, z1 in discs if z1 > z0 + 1e-4)


def _with_handle(obj: PerceivedObject, handle: Part) -> Solid:
    """A round body and a box for the loop of its handle."""
    assert handle.outward is not None
    assert handle.radius is not None
    out = np.asarray(handle.outward[:2]) / (math.hypot(*handle.outward[:2]) or 1.0)
    body = min(obj.size[0], obj.size[1]) / 2.0
    axis = np.asarray(handle.centre[:2]) - handle.radius * out
    reach = max(handle.radius + handle.width / 2.0 - body, 0.002)
    middle = axis + out * (body + reach / 2.0)
    low = max(obj.base_z, handle.centre[2] - handle.length / 2.0)
    high = max(low + 0.005, min(obj.top_z, handle.centre[2] + handle.length / 2.0))
    loop = Piece(
        (float(middle[0]), float(middle[1])),
        (reach / 2.0, handle.width / 2.0),
        math.atan2(out[1], out[0]),
        0.0,
        low,
        high,
    )
    disc = Piece((float(axis[0]), float(axis[1])), (0.0, 0.0), 0.0, body, obj.base_z, obj.top_z)
    return Solid((disc, loop))
