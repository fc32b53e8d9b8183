"""One picture made ready: median-filtered depth, pose fitted to the table, smooth depth error removed, points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kb.rgbd import RgbdView
from tools.perception.filter_depth import box_sum, median_depth
from tools.perception.table_plane import TABLE_LOWER, TABLE_UPPER, fit_edges, fit_plane, pixel_rays

Array = NDArray[np.float64]
Image = NDArray[np.float32]

BLOCK = 4
"""The smooth depth error is estimated on blocks of this many pixels squared."""

FIELD_HALF = 4
"""Half-window of the running mean of the table's residual [blocks]: the error is alike over some tens of pixels."""

SURROUNDINGS, TALLEST, BORDER = 0.04, 0.33, 14
"""Depth below and height above the table [m], and border [px], of the part of the picture that is looked at."""

TABLE_BAND = 0.005
"""Residuals up to this belong to the table [m]: 2 mm per pixel, halved by the median, and a 1.5-mm smooth part."""

ORDINARY_NOISE = 0.0020
"""Standard deviation of a pixel's depth in an ordinary picture [m]."""

NOISY, NOISY_ROUNDS = 1.4, 2
"""From this many times the ordinary noise on, the median filter is run that many times more."""


@dataclass(frozen=True)
class CalibratedView:
    """A picture whose points are in the world frame to about a millimetre."""

    name: str
    rgb: NDArray[np.uint8]
    """Colour (H, W, 3)."""
    depth: Image
    """Corrected, filtered depth [m] (H, W), 0 where unmeasured."""
    raw: Image
    """Corrected depth without the median [m] (H, W): thin things survive in it."""
    points: Image
    """World points [m] (H, W, 3); meaningless where unmeasured."""
    whole: tuple[int, int]
    """Height and width of the whole picture [px], of which this is the part around the table."""
    corner: tuple[int, int]
    """Row and column of this part's first pixel in the whole picture."""
    focal: float
    """Focal length [px]."""
    pose: Array
    """Fitted pose camera-to-world (4, 4)."""
    noise: float = 1.0
    """Depth noise of this picture over the ordinary one, 1 unless it is clearly more."""

    @property
    def measured(self) -> NDArray[np.bool_]:
        """Pixels with a depth (H, W)."""
        return self.depth > 0

    def project(self, points: Array) -> tuple[Array, Array, Array]:
        """Pixel column, row (not rounded) and depth [m] of world points (N, 3)."""
        camera = (points - self.pose[:3, 3]) @ self.pose[:3, :3]
        z = np.maximum(camera[:, 2], 1e-6)
        u = camera[:, 0] / z * self.focal + (self.whole[1] - 1) / 2 - self.corner[1]
        v = camera[:, 1] / z * self.focal + (self.whole[0] - 1) / 2 - self.corner[0]
        return u, v, camera[:, 2]


def calibrate_view(view: RgbdView) -> CalibratedView:
    """Filters the depth and corrects pose and smooth depth error by the table."""
    told = np.asarray(view.transform_camera_to_world, np.float64)
    all_rays = pixel_rays(*view.depth.shape, view.focal)
    window = _table_window(all_rays, told)
    rays, measured = all_rays[window], np.ascontiguousarray(view.depth[window])
    pose = fit_edges(measured, rays, fit_plane(measured, rays, told))
    noise = noise_level(measured)
    filtered = median_depth(measured)
    for _ in range(NOISY_ROUNDS if noise > 1.0 else 0):
        filtered = median_depth(filtered)
    error = table_error(filtered, rays, pose, noise)
    depth = np.where(filtered > 0, filtered - error, np.float32(0.0))
    raw = np.where(measured > 0, measured - error, np.float32(0.0))
    points = (rays * depth[..., None]) @ pose[:3, :3].T.astype(np.float32) + pose[:3, 3].astype(np.float32)
    corner = (int(window[0].start), int(window[1].start))
    whole = view.depth.shape
    return CalibratedView(view.name, view.rgb[window], depth, raw, points, whole, corner, view.focal, pose, noise)


def _table_window(rays: Image, pose: Array) -> tuple[slice, slice]:
    """Rows and columns of the picture in which the table, what stands on it and its surroundings are seen."""
    height, width = rays.shape[:2]
    focal = 1.0 / float(rays[0, 1, 0] - rays[0, 0, 0]) if width > 1 else 1.0
    corners = np.array(
        [
            [x, y, z]
            for x in (TABLE_LOWER[0], TABLE_UPPER[0])
            for y in (TABLE_LOWER[1], TABLE_UPPER[1])
            for z in (-SURROUNDINGS, TALLEST)
        ]
    )
    camera = (corners - pose[:3, 3]) @ pose[:3, :3]
    if (camera[:, 2] < 0.05).any():
        return slice(0, height), slice(0, width)
    u = camera[:, 0] / camera[:, 2] * focal + (width - 1) / 2
    v = camera[:, 1] / camera[:, 2] * focal + (height - 1) / 2
    rows = slice(max(int(v.min()) - BORDER, 0), min(int(v.max()) + BORDER, height))
    columns = slice(max(int(u.min()) - BORDER, 0), min(int(u.max()) + BORDER, width))
    if rows.stop - rows.start < 8 or columns.stop - columns.start < 8:
        return slice(0, height), slice(0, width)
    return rows, columns


def noise_level(depth: Image) -> float:
    """Pixel noise of a depth picture over the ordinary one, from differences of neighbours in a row; at least 1.

    Ordinary pictures have exactly 1: how much noise a picture has is known to some per cent only.
    """
    left, right = depth[::2, :-1], depth[::2, 1:]
    both = (left > 0) & (right > 0)
    if both.sum() < 200:
        return 1.0
    # The difference of two pixels has the square root of two of their noise; the median of its size is 0.6745 of that.
    spread = float(np.median(np.abs(right - left)[both])) / 0.6745 / np.sqrt(2.0)
    level = spread / ORDINARY_NOISE
    return level if level > NOISY else 1.0


def table_error(depth: Image, rays: Image, pose: Array, noise: float = 1.0) -> Image:
    """Smooth depth error [m] (H, W), measured on the table around each pixel and zero where no table is near."""
    directions = rays @ pose[:3, :3].T.astype(np.float32)
    with np.errstate(divide="ignore"):
        ideal = np.float32(-pose[2, 3]) / directions[..., 2]
    x = directions[..., 0] * ideal + np.float32(pose[0, 3])
    y = directions[..., 1] * ideal + np.float32(pose[1, 3])
    residual = np.where(depth > 0, depth - ideal, np.float32(1.0))
    table = (np.abs(residual) < TABLE_BAND * noise) & (x > TABLE_LOWER[0]) & (x < TABLE_UPPER[0])
    table &= (y > TABLE_LOWER[1]) & (y < TABLE_UPPER[1])
    total = box_sum(_blocks(np.where(table, residual, np.float32(0.0))), FIELD_HALF)
    count = box_sum(_blocks(table.astype(np.float32)), FIELD_HALF)
    # A mean over few pixels is shrunk: 60 pixels of 1-mm noise weigh like the prior knowledge that the error is small.
    coarse = (total / (count + 60.0)).astype(np.float32)
    return np.repeat(np.repeat(coarse, BLOCK, axis=0), BLOCK, axis=1)[: depth.shape[0], : depth.shape[1]]


def _blocks(image: Image) -> Image:
    """Sums over blocks of BLOCK squared pixels."""
    height, width = -(-image.shape[0] // BLOCK) * BLOCK, -(-image.shape[1] // BLOCK) * BLOCK
    padded = np.zeros((height, width), np.float32)
    padded[: image.shape[0], : image.shape[1]] = image
    return padded.reshape(height // BLOCK, BLOCK, width // BLOCK, BLOCK).sum(axis=(1, 3))
