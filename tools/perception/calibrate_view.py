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

FIELD_HALF = 18
"""Half-window of the running mean of the table's residual [px]: the error is alike over some tens of pixels."""

TABLE_BAND = 0.005
"""Residuals up to this belong to the table [m]: 2 mm per pixel, halved by the median, and a 1.5-mm smooth part."""


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
    rays: Image
    """Rays in camera axes, z = 1 (H, W, 3)."""
    focal: float
    """Focal length [px]."""
    pose: Array
    """Fitted pose camera-to-world (4, 4)."""

    @property
    def measured(self) -> NDArray[np.bool_]:
        """Pixels with a depth (H, W)."""
        return self.depth > 0

    def project(self, points: Array) -> tuple[Array, Array, Array]:
        """Pixel column, row (not rounded) and depth [m] of world points (N, 3)."""
        camera = (points - self.pose[:3, 3]) @ self.pose[:3, :3]
        z = np.maximum(camera[:, 2], 1e-6)
        height, width = self.depth.shape
        u = camera[:, 0] / z * self.focal + (width - 1) / 2
        v = camera[:, 1] / z * self.focal + (height - 1) / 2
        return u, v, camera[:, 2]


def calibrate_view(view: RgbdView) -> CalibratedView:
    """Filters the depth and corrects pose and smooth depth error by the table."""
    rays = pixel_rays(*view.depth.shape, view.focal)
    told = np.asarray(view.transform_camera_to_world, np.float64)
    pose = fit_edges(view.depth, rays, fit_plane(view.depth, rays, told))
    filtered = median_depth(view.depth)
    error = table_error(filtered, rays, pose)
    depth = np.where(filtered > 0, filtered - error, np.float32(0.0))
    raw = np.where(view.depth > 0, view.depth - error, np.float32(0.0))
    points = (rays * depth[..., None]) @ pose[:3, :3].T.astype(np.float32) + pose[:3, 3].astype(np.float32)
    return CalibratedView(view.name, view.rgb, depth, raw, points, rays, view.focal, pose)


def table_error(depth: Image, rays: Image, pose: Array) -> Image:
    """Smooth depth error [m] (H, W), measured on the table around each pixel and zero where no table is near."""
    directions = rays @ pose[:3, :3].T.astype(np.float32)
    with np.errstate(divide="ignore"):
        ideal = np.float32(-pose[2, 3]) / directions[..., 2]
    ground = directions[..., :2] * ideal[..., None] + pose[:2, 3].astype(np.float32)
    inside = np.all((ground > TABLE_LOWER.astype(np.float32)) & (ground < TABLE_UPPER.astype(np.float32)), axis=-1)
    residual = np.where(depth > 0, depth - ideal, np.float32(1.0))
    table = inside & (np.abs(residual) < TABLE_BAND)
    weight = table.astype(np.float32)
    total, count = box_sum(np.where(table, residual, 0), FIELD_HALF), box_sum(weight, FIELD_HALF)
    # A mean over few pixels is shrunk: 60 pixels of 1-mm noise weigh like the prior knowledge that the error is small.
    return (total / (count + 60.0)).astype(np.float32)
