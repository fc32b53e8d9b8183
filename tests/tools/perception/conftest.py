"""Pictures made by hand: boxes and balls on the table, ray-cast in numpy, without the simulator."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from kb.rgbd import RgbdView

Array = NDArray[np.float64]
FOCAL = 312.0
SHAPE = (240, 320)


def look_at(
    eye: tuple[float, float, float], target: tuple[float, float, float], up: tuple[float, float, float]
) -> Array:
    """Pose camera-to-world (4, 4), OpenCV axes."""
    z = np.subtract(target, eye) / np.linalg.norm(np.subtract(target, eye))
    x = np.cross(z, up)
    x /= np.linalg.norm(x)
    pose = np.eye(4)
    pose[:3, :3] = np.column_stack([x, np.cross(z, x), z])
    pose[:3, 3] = eye
    return pose


POSES = {
    "front": look_at((1.33, 0.0, 0.78), (0.55, 0.0, 0.03), (0, 0, 1)),
    "top": look_at((0.55, 0.0, 1.05), (0.55, 0.0, 0.0), (1, 0, 0)),
}


def _box_depth(eye: Array, rays: Array, low: Array, high: Array) -> Array:
    with np.errstate(divide="ignore", invalid="ignore"):
        a, b = (low - eye) / rays, (high - eye) / rays
    near, far = np.minimum(a, b).max(-1), np.maximum(a, b).min(-1)
    return np.where((near <= far) & (near > 0), near, np.inf)


def _ball_depth(eye: Array, rays: Array, centre: Array, radius: float) -> Array:
    a, b = (rays**2).sum(-1), (rays * (eye - centre)).sum(-1)
    root = b**2 - a * (((eye - centre) ** 2).sum() - radius**2)
    return np.where(root > 0, (-b - np.sqrt(np.maximum(root, 0))) / a, np.inf)


@pytest.fixture
def draw_views() -> Callable[..., tuple[RgbdView, ...]]:
    """Makes front and top views of boxes ((low, high), rgb) and balls ((centre, radius), rgb) on the table."""

    def draw(
        boxes: list[tuple[tuple[Array, Array], tuple[int, int, int]]] | None = None,
        balls: list[tuple[tuple[Array, float], tuple[int, int, int]]] | None = None,
        *,
        noise: float = 0.001,
        told: dict[str, Array] | None = None,
        seed: int = 0,
    ) -> tuple[RgbdView, ...]:
        rng = np.random.default_rng(seed)
        views: list[RgbdView] = []
        for name, pose in POSES.items():
            u, v = np.meshgrid(np.arange(SHAPE[1]), np.arange(SHAPE[0]))
            camera = np.stack(
                [(u - (SHAPE[1] - 1) / 2) / FOCAL, (v - (SHAPE[0] - 1) / 2) / FOCAL, np.ones(SHAPE)], axis=-1
            )
            rays, eye = camera @ pose[:3, :3].T, pose[:3, 3]
            with np.errstate(divide="ignore"):
                floor = (-0.75 - eye[2]) / rays[..., 2]
            depth = np.where(floor > 0, floor, 10.0)
            rgb = np.full((*SHAPE, 3), 80, np.uint8)
            table = (np.array([0.25, -0.4, -0.04]), np.array([0.85, 0.4, 0.0]))
            for (low, high), colour in [(table, (180, 165, 145)), *(boxes or [])]:
                here = _box_depth(eye, rays, np.asarray(low), np.asarray(high))
                rgb[here < depth] = colour
                depth = np.minimum(depth, here)
            for (centre, radius), colour in balls or []:
                here = _ball_depth(eye, rays, np.asarray(centre), radius)
                rgb[here < depth] = colour
                depth = np.minimum(depth, here)
            noisy = (depth + noise * rng.standard_normal(SHAPE)).astype(np.float32)
            views.append(RgbdView(name, rgb, noisy, FOCAL, pose if told is None else told[name]))
        return tuple(views)

    return draw
