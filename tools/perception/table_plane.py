"""Put a camera right by the table: its plane and its four known edges (perception.md: 3-16 mm down to 0.1-1.2 mm).

The table is the robot's own set-up: top z = 0, x in [0.25, 0.85], y in [-0.40, 0.40] (ledger G40).
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Image = NDArray[np.float32]

TABLE_LOWER, TABLE_UPPER = np.array([0.25, -0.40]), np.array([0.85, 0.40])
"""Corners of the table's top in the robot's frame [m] (ledger G40)."""

PLANE_BAND = (0.030, 0.010, 0.006)
"""Half-width of the band of depth residuals [m] used in each round of the plane fit."""

EDGE_BAND = 0.020
"""Half-width of the strip around an edge in which the end of the table is sought [m]."""

EDGE_BIN = 0.010
"""Length of the pieces of an edge that are measured one by one [m]."""

SIDE_FACE = (-0.035, -0.008)
"""Heights at which a point just below the top belongs to the table's side [m]."""

FLOOR = -0.15
"""Points below this height lie beyond the table [m]."""


@lru_cache(maxsize=8)
def pixel_rays(height: int, width: int, focal: float) -> Image:
    """Viewing ray of each pixel in camera axes, scaled to z = 1, shape (H, W, 3)."""
    u, v = np.meshgrid(np.arange(width), np.arange(height))
    rays = np.stack([(u - (width - 1) / 2) / focal, (v - (height - 1) / 2) / focal, np.ones_like(u, float)], axis=-1)
    return rays.astype(np.float32)


def fit_plane(depth: Image, rays: Image, pose: Array) -> Array:
    """Pose camera-to-world (4, 4) whose tilt and height fit the table that is seen.

    A plane's inverse depth is linear in the pixel: 1/d = a . ray. Rounds with narrowing bands drop what stands on it.
    """
    step = 3
    d, r = depth[::step, ::step].reshape(-1).astype(np.float64), rays[::step, ::step].reshape(-1, 3).astype(np.float64)
    measured = d > 0
    d, r = d[measured], r[measured]
    world = r @ pose[:3, :3].T * d[:, None] + pose[:3, 3]
    on_table = np.all((world[:, :2] > TABLE_LOWER + 0.01) & (world[:, :2] < TABLE_UPPER - 0.01), axis=1)
    d, r = d[on_table], r[on_table]
    up = pose[:3, :3].T @ np.array([0.0, 0.0, 1.0])
    a = -up / pose[2, 3]  # world z = 0 in camera axes: up . (d r) = -height
    for band in PLANE_BAND:
        residual = d - 1.0 / (r @ a)
        near = np.abs(residual) < band
        if near.sum() < 200:
            return pose
        weight = d[near] ** 2  # least squares in depth, not in its inverse
        a = np.linalg.lstsq(r[near] * weight[:, None], weight / d[near], rcond=None)[0]
    return _upright(pose, -a / np.linalg.norm(a), 1.0 / float(np.linalg.norm(a)))


def _upright(pose: Array, up_camera: Array, height: float) -> Array:
    """The pose turned the shortest way so that `up_camera` points up in the world, at `height` [m] over the table."""
    up = pose[:3, :3] @ up_camera
    axis = np.cross(up, [0.0, 0.0, 1.0])
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    turn = np.eye(3) + cross + cross @ cross / (1.0 + up[2])  # Rodrigues for two unit vectors
    mended = pose.copy()
    mended[:3, :3] = turn @ pose[:3, :3]
    mended[2, 3] = height
    return mended


def fit_edges(depth: Image, rays: Image, pose: Array) -> Array:
    """Pose (4, 4) shifted and turned in the table's plane so that the table ends where its edges are known to be."""
    directions = rays @ pose[:3, :3].T.astype(np.float32)
    with np.errstate(divide="ignore", invalid="ignore"):
        reach = np.float32(-pose[2, 3]) / directions[..., 2]
    ground = directions[..., :2] * reach[..., None] + pose[:2, 3].astype(np.float32)
    height = directions[..., 2] * depth + np.float32(pose[2, 3])
    table = (depth > 0) & (np.abs(height) < 0.015)
    beyond = (depth > 0) & (height < FLOOR)
    side = np.flatnonzero(((depth > 0) & (height < SIDE_FACE[1]) & (height > SIDE_FACE[0])).ravel())
    face = directions.reshape(-1, 3)[side, :2] * depth.reshape(-1)[side, None] + pose[:2, 3].astype(np.float32)
    rows: list[Array] = []
    values: list[Array] = []
    weights: list[Array] = []
    for axis in (0, 1):
        for end in (TABLE_LOWER, TABLE_UPPER):
            for along, shift, weight in (
                _edge_shift(ground, table, beyond, axis, end),
                _face_shift(face, axis, end),
            ):
                jacobian = np.zeros((len(along), 3))
                jacobian[:, axis] = 1.0
                jacobian[:, 2] = -along if axis == 0 else along  # a turn moves x by -y and y by x
                rows.append(jacobian)
                values.append(shift)
                weights.append(weight)
    a, b, w = np.concatenate(rows), np.concatenate(values), np.concatenate(weights)
    if len(b) < 30:
        return pose
    solution = np.zeros(3)
    keep = np.ones(len(b), bool)
    for _ in range(3):
        if np.linalg.matrix_rank(a[keep]) < 3:
            return pose
        solution = np.linalg.lstsq(a[keep] * w[keep, None], b[keep] * w[keep], rcond=None)[0]
        error = np.abs(b - a @ solution)
        keep = error < max(0.001, 2.5 * float(np.median(error)))
    return _in_plane(pose, solution)


def _edge_shift(
    ground: NDArray[Any], table: NDArray[np.bool_], beyond: NDArray[np.bool_], axis: int, end: Array
) -> tuple[Array, Array, Array]:
    """Where along an edge it was measured [m] (N,), how far the picture must be moved there [m] (N,), and the weight.

    Per piece of the edge: half way between the last pixel on the table and the first one beyond it. Pixels lost at the
    edge are lost on both sides alike, so that the middle has no bias.
    """
    lower = end is TABLE_LOWER
    sign = -1.0 if lower else 1.0
    other = 1 - axis
    outward = (ground[..., axis] - np.float32(end[axis])) * np.float32(sign)
    span = (ground[..., other] > TABLE_LOWER[other] + 0.02) & (ground[..., other] < TABLE_UPPER[other] - 0.02)
    strip = span & (np.abs(outward) < EDGE_BAND)
    count = int(np.ceil((TABLE_UPPER[other] - TABLE_LOWER[other]) / EDGE_BIN))
    last, first = np.full(count, -np.inf), np.full(count, np.inf)
    for chosen, target, reduce in ((strip & table, last, np.maximum), (strip & beyond, first, np.minimum)):
        place = ((ground[..., other][chosen] - TABLE_LOWER[other]) / EDGE_BIN).astype(int)
        reduce.at(target, np.clip(place, 0, count - 1), outward[chosen].astype(np.float64))
    good = np.isfinite(last) & np.isfinite(first) & (np.abs(first - last) < 0.010)
    middle = (np.arange(count) + 0.5) * EDGE_BIN + TABLE_LOWER[other]
    weight = 0.001 / np.maximum(first[good] - last[good], 0.0005)  # a pixel's footprint is the measure of its error
    return middle[good], -sign * (last[good] + first[good]) / 2, weight


def _face_shift(face: Image, axis: int, end: Array) -> tuple[Array, Array, Array]:
    """As `_edge_shift`, from points (N, 2) [m] on a side face that a camera sees obliquely."""
    lower = end is TABLE_LOWER
    other = 1 - axis
    outward = (face[:, axis] - end[axis]) * (-1.0 if lower else 1.0)
    on_face = (
        (np.abs(outward) < EDGE_BAND)
        & (face[:, other] > TABLE_LOWER[other] + 0.02)
        & (face[:, other] < TABLE_UPPER[other] - 0.02)
    )
    count = int(np.ceil((TABLE_UPPER[other] - TABLE_LOWER[other]) / EDGE_BIN))
    place = np.clip(((face[on_face, other] - TABLE_LOWER[other]) / EDGE_BIN).astype(int), 0, count - 1)
    amount = np.bincount(place, minlength=count)
    total = np.bincount(place, weights=outward[on_face], minlength=count)
    good = amount >= 12
    middle = (np.arange(count) + 0.5) * EDGE_BIN + TABLE_LOWER[other]
    shift = -(total[good] / amount[good]) * (-1.0 if lower else 1.0)
    return middle[good], shift, np.full(int(good.sum()), 1.0)


def _in_plane(pose: Array, move: NDArray[Any]) -> Array:
    """The pose moved by (dx, dy) [m] and turned by dyaw [rad] about the world's origin."""
    c, s = np.cos(move[2]), np.sin(move[2])
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    mended = pose.copy()
    mended[:3, :3] = turn @ pose[:3, :3]
    mended[:3, 3] = turn @ pose[:3, 3] + np.array([move[0], move[1], 0.0])
    return mended
