"""Outlines of objects as seen from above, and the free distance between them."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sim.placed import Geom, PlacedObject

Array = NDArray[np.float64]
_ANGLES = np.arange(32) * (2 * np.pi / 32)
_SIGNS = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)], float)
_CIRCLE = np.column_stack([np.cos(_ANGLES), np.sin(_ANGLES)])


def rotation(quaternion: tuple[float, float, float, float]) -> Array:
    """Rotation matrix (3, 3) of a quaternion (w, x, y, z), which need not be of unit length."""
    w, x, y, z = (np.asarray(quaternion, float) / np.linalg.norm(quaternion)).tolist()
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def geom_points(geom: Geom) -> Array:
    """Points in the object's frame (N, 3) whose convex hull is the geom (circles as 32 points) [m]."""
    if geom.type == "mesh":
        local = np.asarray(geom.vertices, float)
    elif geom.type == "box":
        local = _SIGNS * np.asarray(geom.size)
    elif geom.type == "cylinder":
        radius, half = geom.size
        ring = np.column_stack([_CIRCLE * radius, np.zeros(32)])
        local = np.vstack([ring + np.array([0, 0, half]), ring - np.array([0, 0, half])])
    else:
        local = _rounded_points(geom)
    return local @ rotation(geom.quaternion).T + np.asarray(geom.position)


def _rounded_points(geom: Geom) -> Array:
    """Points on a sphere, ellipsoid or capsule (N, 3) in the geom's frame."""
    rings = [
        np.column_stack([_CIRCLE * np.cos(a), np.full(32, np.sin(a))]) for a in np.linspace(-np.pi / 2, np.pi / 2, 9)
    ]
    unit = np.vstack(rings)
    if geom.type == "capsule":
        radius, half = geom.size
        return np.vstack([unit * radius + np.array([0, 0, half]), unit * radius - np.array([0, 0, half])])
    if geom.type == "sphere":
        return unit * geom.size[0]
    return unit * np.asarray(geom.size)


def world_points(thing: PlacedObject) -> Array:
    """Points in the world (N, 3) whose pieces' hulls make up the object [m]."""
    local = np.vstack([geom_points(geom) for geom in thing.geoms])
    return local @ rotation(thing.quaternion).T + np.asarray(thing.position)


def hull(points: Array) -> Array:
    """Convex hull of points in the plane (N, 2), counter-clockwise (M, 2) (Andrew's monotone chain)."""
    order = _ordered(points).tolist()
    if len(order) < 3:
        return np.asarray(order)
    chains: list[list[list[float]]] = []
    for sequence in (order, order[::-1]):
        chain: list[list[float]] = []
        for point in sequence:
            x, y = point
            while len(chain) >= 2:
                (ax, ay), (bx, by) = chain[-2], chain[-1]
                # Only a turn to the left keeps the point between.
                if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0:
                    break
                chain.pop()
            chain.append(point)
        chains.append(chain[:-1])
    return np.asarray(chains[0] + chains[1])


def _ordered(points: Array) -> Array:
    """The points (N, 2) by x and then y, each once, to 9 decimals: as `numpy.unique` of rows, which takes thrice as long."""
    pairs = np.sort(np.ascontiguousarray(np.round(points, 9)).view(np.complex128)[:, 0])
    return pairs[np.append(True, pairs[1:] != pairs[:-1])].view(np.float64).reshape(-1, 2)


def outline(thing: PlacedObject) -> Array:
    """Convex outline of the object seen from above, world frame (N, 2) [m]; not to be written to."""
    known = _outlines.get(id(thing))
    if known is None or known[0] is not thing:
        known = thing, hull(world_points(thing)[:, :2])
        known[1].setflags(write=False)
        while len(_outlines) >= KEPT:
            _outlines.pop(next(iter(_outlines)), None)
        _outlines[id(thing)] = known
    return known[1]


KEPT = 64
"""Objects whose outlines are kept: each is asked for whenever another one is to be placed."""
_outlines: dict[int, tuple[PlacedObject, Array]] = {}
"""Identity of an object -> the object itself, which keeps its identity its own, and its outline."""


def surely_apart(one: Array, two: Array, least: float) -> bool:
    """Whether the boxes around two outlines tell already that `gap` is at least `least`, which is not negative [m]."""
    (low_x, low_y), (high_x, high_y) = one.min(axis=0).tolist(), one.max(axis=0).tolist()
    (left, front), (right, back) = two.min(axis=0).tolist(), two.max(axis=0).tolist()
    return max(low_x - right, left - high_x, low_y - back, front - high_y) > least + SURELY


SURELY = 1e-9
"""Far more than gaps are off by rounding [m]."""


def gap(one: Array, two: Array) -> float:
    """Free distance between two convex outlines [m]; negative (the smallest overlap) where they overlap."""
    overlap = _overlap(one, two)
    if overlap > 0.0:
        return -overlap
    return min(_nearest(one, two), _nearest(two, one))


def _overlap(one: Array, two: Array) -> float:
    """Smallest overlap over all edge normals of both outlines; <= 0 if some line separates them."""
    edges = np.vstack([np.roll(one, -1, axis=0) - one, np.roll(two, -1, axis=0) - two])
    normals = np.column_stack([edges[:, 1], -edges[:, 0]])
    lengths = np.sqrt(normals[:, 0] * normals[:, 0] + normals[:, 1] * normals[:, 1])
    normals = normals[lengths > 1e-12] / lengths[lengths > 1e-12, None]
    a, b = one @ normals.T, two @ normals.T
    return float(np.minimum(a.max(0) - b.min(0), b.max(0) - a.min(0)).min())


def _nearest(points: Array, polygon: Array) -> float:
    """Smallest distance of points (N, 2) from the edges of a polygon (M, 2)."""
    # Written out by coordinate: numpy takes long for sums over two numbers.
    (x, y), (start_x, start_y) = points.T[:, :, None], polygon.T
    edge_x, edge_y = (np.roll(polygon, -1, axis=0) - polygon).T
    length = np.maximum(edge_x * edge_x + edge_y * edge_y, 1e-18)
    share = np.clip(((x - start_x) * edge_x + (y - start_y) * edge_y) / length, 0.0, 1.0)
    off_x, off_y = x - (start_x + share * edge_x), y - (start_y + share * edge_y)
    return math.sqrt((off_x * off_x + off_y * off_y).min())
