"""Even samples of the surfaces of simple solids."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def rotation_of(quaternion: tuple[float, float, float, float]) -> Array:
    """Rotation matrix (3, 3) of a unit quaternion (w, x, y, z)."""
    w, x, y, z = (np.asarray(quaternion, float) / np.linalg.norm(quaternion)).tolist()
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def sphere_points(count: int) -> Array:
    """Evenly spread unit vectors (count, 3): a Fibonacci spiral."""
    i = np.arange(count) + 0.5
    z = 1 - 2 * i / count
    turn = np.pi * (1 + 5**0.5) * i
    r = np.sqrt(1 - z * z)
    return np.column_stack([r * np.cos(turn), r * np.sin(turn), z])


def tube_points(radius: float, half: float, count: int, *, caps: bool) -> Array:
    """Points on a cylinder's side, and on its two ends."""
    pitch = np.sqrt(max(2 * np.pi * radius * 2 * half + 2 * np.pi * radius**2 * caps, 1e-9) / max(count, 1))
    n_z, n_t = max(2, int(2 * half / pitch) + 1), max(12, int(2 * np.pi * radius / pitch))
    z, t = np.meshgrid(np.linspace(-half, half, n_z), np.arange(n_t) * 2 * np.pi / n_t, indexing="ij")
    side = np.column_stack([radius * np.cos(t).ravel(), radius * np.sin(t).ravel(), z.ravel()])
    if not caps:
        return side
    n_disc = max(8, int(np.pi * radius**2 / pitch**2))
    k = np.arange(n_disc) + 0.5
    r, a = radius * np.sqrt(k / n_disc), np.pi * (1 + 5**0.5) * k
    disc = np.column_stack([r * np.cos(a), r * np.sin(a), np.full(n_disc, half)])
    return np.concatenate([side, disc, disc * [1, 1, -1]])


def box_points(half: Array, count: int) -> Array:
    """A grid on each face of a box, edges included."""
    area = 8 * (half[0] * half[1] + half[1] * half[2] + half[2] * half[0])
    pitch = np.sqrt(max(area, 1e-9) / max(count, 1))
    faces: list[Array] = []
    for axis in range(3):
        u, v = [i for i in range(3) if i != axis]
        nu, nv = max(2, int(2 * half[u] / pitch) + 1), max(2, int(2 * half[v] / pitch) + 1)
        along_u: Array = np.linspace(-float(half[u]), float(half[u]), nu)
        along_v: Array = np.linspace(-float(half[v]), float(half[v]), nv)
        face = np.zeros((nu * nv, 3))
        face[:, u], face[:, v] = np.tile(along_u, nv), np.repeat(along_v, nu)
        for sign in (-1, 1):
            face[:, axis] = sign * half[axis]
            faces.append(face.copy())
    return np.concatenate(faces)


def hull_points(vertices: Array, count: int) -> Array:
    """Vertices of a convex piece and points on its hull, spread by area."""
    # Only the oracle, and only for meshes: not on the default path.
    from scipy.spatial import ConvexHull  # pyright: ignore[reportMissingTypeStubs]

    hull: Any = ConvexHull(vertices)
    triangles: Array = vertices[np.asarray(hull.simplices)]
    areas: Array = 0.5 * np.linalg.norm(
        np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1
    )
    shares = (np.arange(count, dtype=np.float64) + 0.5) / count
    chosen: NDArray[np.intp] = np.searchsorted(np.cumsum(areas), shares * float(areas.sum()))
    i = np.arange(count)
    a, b = (i * 0.7548776662466927) % 1, (i * 0.5698402909980532) % 1  # the plastic number's low-discrepancy pair
    flip = a + b > 1
    a, b = np.where(flip, 1 - a, a), np.where(flip, 1 - b, b)
    corner = triangles[np.minimum(chosen, len(triangles) - 1)]
    inner = corner[:, 0] + a[:, None] * (corner[:, 1] - corner[:, 0]) + b[:, None] * (corner[:, 2] - corner[:, 0])
    return np.concatenate([vertices[np.asarray(hull.vertices)], inner])
