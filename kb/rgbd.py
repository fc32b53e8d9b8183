"""One RGB-D picture with the calibration the robot is told: all that pixel-based perception may know."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class RgbdView:
    """A colour and depth image from one calibrated pinhole camera."""

    name: str
    """"front", "top" or "wrist"."""
    rgb: NDArray[np.uint8]
    """Colour, shape (H, W, 3)."""
    depth: NDArray[np.float32]
    """Distance along the optical axis [m], shape (H, W); 0 where there is no measurement."""
    focal: float
    """Focal length [px], the same for both axes."""
    transform_camera_to_world: NDArray[np.float64]
    """Calibrated pose, shape (4, 4), OpenCV axes (x right, y down, z along the view). The true pose differs by the
    calibration residual (benchmark.md section 2)."""

    @property
    def centre(self) -> tuple[float, float]:
        """Principal point (cx, cy) [px]: the middle of the image."""
        height, width = self.depth.shape
        return (width - 1) / 2.0, (height - 1) / 2.0

    def points_w(self) -> NDArray[np.float64]:
        """Back-projected points in the world frame [m], shape (H, W, 3); NaN where there is no measurement."""
        height, width = self.depth.shape
        cx, cy = self.centre
        z = np.where(self.depth > 0, self.depth, np.nan).astype(np.float64)
        u: NDArray[np.float64] = np.arange(width, dtype=np.float64)[None, :].repeat(height, axis=0)
        v: NDArray[np.float64] = np.arange(height, dtype=np.float64)[:, None].repeat(width, axis=1)
        camera = np.stack([(u - cx) / self.focal * z, (v - cy) / self.focal * z, z], axis=-1)
        pose = self.transform_camera_to_world
        return camera @ pose[:3, :3].T + pose[:3, 3]
