"""Even samples of an object's true surface: of the union of its pieces, without what lies inside another piece."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sim.placed import Geom, PlacedObject
from tools.sample_solids import box_points, hull_points, rotation_of, sphere_points, tube_points

Array = NDArray[np.float64]


def surface_in_object(obj: PlacedObject, points: int) -> Array:
    """About `points` samples of the union's surface in the object's frame (N, 3), less those inside another piece."""
    areas = np.array([_area(geom) for geom in obj.geoms])
    shares = np.maximum(40, (points * areas / areas.sum())).astype(int)
    clouds: list[Array] = []
    middles, radii = np.array([geom.position for geom in obj.geoms], float), [_radius(geom) for geom in obj.geoms]
    turns = [rotation_of(geom.quaternion) for geom in obj.geoms]
    for i, (geom, count) in enumerate(zip(obj.geoms, shares, strict=True)):
        cloud = _sample(geom, int(count)) @ turns[i].T + np.asarray(geom.position)
        inside = np.zeros(len(cloud), bool)
        apart = np.linalg.norm(middles - middles[i], axis=1)
        for j, other in enumerate(obj.geoms):
            if i != j and apart[j] < radii[i] + radii[j]:
                inside |= _inside(other, turns[j], cloud)
        clouds.append(cloud[~inside])
    return np.concatenate(clouds)


def _area(geom: Geom) -> float:
    if geom.type == "mesh" and geom.vertices is not None:
        x, y, z = np.ptp(geom.vertices, axis=0)
        return float(2 * (x * y + y * z + z * x))
    s = geom.size
    if geom.type == "box":
        return 8 * (s[0] * s[1] + s[1] * s[2] + s[2] * s[0])
    if geom.type in ("cylinder", "capsule"):
        return 2 * np.pi * s[0] * (2 * s[1] + s[0] * (2 if geom.type == "capsule" else 1))
    return 4 * np.pi * max(s) ** 2


def _radius(geom: Geom) -> float:
    """Radius of a sphere about a piece's middle that holds it [m]."""
    s = geom.size
    if geom.vertices is not None:
        return float(np.linalg.norm(geom.vertices, axis=1).max())
    if geom.type == "capsule":
        return s[0] + s[1]
    return {"sphere": s[0], "ellipsoid": max(s)}.get(geom.type, float(np.linalg.norm(s)))


def _sample(geom: Geom, count: int) -> Array:
    """Even samples of one piece's surface in its own frame (about `count`, 3)."""
    if geom.type == "mesh" and geom.vertices is not None:
        return hull_points(geom.vertices, count)
    s = geom.size
    if geom.type == "sphere":
        return sphere_points(count) * s[0]
    if geom.type == "ellipsoid":
        return sphere_points(count) * np.asarray(s)
    if geom.type == "capsule":
        balls = sphere_points(count) * s[0]
        shaft = tube_points(s[0], s[1], count // 2, caps=False)
        return np.concatenate([balls + np.sign(balls[:, 2:]) * np.array([0, 0, s[1]]), shaft])
    if geom.type == "cylinder":
        return tube_points(s[0], s[1], count, caps=True)
    return box_points(np.asarray(s, float), count)


def _inside(geom: Geom, rotation: Array, points: Array, slack: float = 1e-6) -> NDArray[np.bool_]:
    """Which points (N, 3) of the object's frame lie strictly inside a piece turned by `rotation` (3, 3)."""
    s = geom.size
    if geom.type == "mesh":
        return np.zeros(len(points), bool)  # convex mesh pieces only touch one another
    p = (points - np.asarray(geom.position)) @ rotation
    if geom.type == "box":
        return np.all(np.abs(p) < np.asarray(s) - slack, axis=1)
    if geom.type == "sphere":
        return (p**2).sum(1) < (s[0] - slack) ** 2
    if geom.type == "ellipsoid":
        return ((p / np.asarray(s)) ** 2).sum(1) < 1 - 1e-4
    if geom.type == "cylinder":
        return (np.hypot(p[:, 0], p[:, 1]) < s[0] - slack) & (np.abs(p[:, 2]) < s[1] - slack)
    if geom.type == "capsule":
        beyond = np.maximum(np.abs(p[:, 2]) - s[1], 0)
        return p[:, 0] ** 2 + p[:, 1] ** 2 + beyond**2 < (s[0] - slack) ** 2
    raise ValueError(f"a piece of unknown type {geom.type!r}")
