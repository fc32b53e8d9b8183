"""Where a picture for people is taken from. Not one of the robot's cameras."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Viewpoint:
    """A pinhole camera in the world frame that looks at a point with the horizon level."""

    eye: tuple[float, float, float]
    """Where it stands [m]."""
    target: tuple[float, float, float]
    """What it looks at [m]."""
    fovy: float = 32.0
    """Vertical field of view [deg]."""

    def axes(self) -> tuple[Array, Array, Array]:
        """Unit vectors right, down and forward in the world frame, each (3,)."""
        forward = np.subtract(self.target, self.eye)
        forward = forward / np.linalg.norm(forward)
        right = np.cross(forward, [0.0, 0.0, 1.0])
        right = right / np.linalg.norm(right)
        return right, np.cross(forward, right), forward

    def rays(self, pixels: Array, width: int, height: int) -> Array:
        """Unit directions (N, 3) through the centres of pixels (N, 2), given as column and row."""
        right, down, forward = self.axes()
        focal = height / 2 / math.tan(math.radians(self.fovy) / 2)
        x = (pixels[:, 0] + 0.5 - width / 2) / focal
        y = (pixels[:, 1] + 0.5 - height / 2) / focal
        rays = forward + x[:, None] * right + y[:, None] * down
        return rays / np.linalg.norm(rays, axis=1, keepdims=True)


OVERVIEW = Viewpoint(eye=(1.55, -1.25, 0.95), target=(0.40, 0.02, 0.22), fovy=34.0)
"""The whole robot and the table."""
TABLE_SIDE = Viewpoint(eye=(1.70, -1.00, 0.80), target=(0.40, 0.0, 0.24), fovy=33.0)
"""The table and the hand, for videos."""
