"""The robot's cameras: depth and colour by casting rays into the compiled world (ledger G44, physics.md "Seeing").

Needs no OpenGL and gives the same bytes on every machine. Only rays that can meet something on or just above the table
are cast; the rest shows the floor. What is seen is exact; `sim.camera_noise` makes it look measured. This module knows
nothing about objects' names or categories: it sees geoms.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from kb.rgbd import RgbdView
from sim.camera_noise import noisy_colour, noisy_depth
from sim.placed import CameraDraw, PlacedScene

FRONT_EYE, FRONT_TARGET = (1.33, 0.0, 0.78), (0.55, 0.0, 0.03)
"""The front camera stands across the table, 45 degrees above it, and looks at the robot [m] (perception.md)."""
TOP_EYE = (0.55, 0.0, 1.05)
"""The top camera hangs over the table's middle and looks straight down [m]; the top of its image is away from the robot."""
SEEN_LOWER, SEEN_UPPER = np.array([0.24, -0.41, -0.03]), np.array([0.86, 0.41, 0.34])
"""Corners of the volume whose rays are cast [m]: the table with 1 cm of margin, up to the tallest object."""
FLOOR_Z = -0.75
"""Height of the floor below the table's top [m]."""
FLOOR_COLOUR = np.array([0.30, 0.32, 0.35], np.float32)
JITTER_M, JITTER_RAD = 0.005, np.deg2rad(1.0)
"""Root-mean-square displacement and rotation of a camera from its nominal pose (benchmark.md section 2)."""
RESIDUAL_M, RESIDUAL_RAD = 0.001, np.deg2rad(0.1)
"""Root-mean-square part of it that calibration does not tell the robot (benchmark.md section 2)."""


@dataclass(frozen=True)
class RayImage:
    """What one camera's rays met, before noise."""

    depth: NDArray[np.float32]
    """Distance along the optical axis [m] (H, W); 0 where nothing was met."""
    geom: NDArray[np.int32]
    """Geom met (H, W); -1 where none, which includes the floor."""
    rgb: NDArray[np.float32]
    """Shaded colour in [0, 1] (H, W, 3)."""
    through: NDArray[np.bool_]
    """Pixels whose first surface can be seen through (H, W)."""


def look_at(
    eye: Sequence[float], target: Sequence[float], up: Sequence[float] = (0.0, 0.0, 1.0)
) -> NDArray[np.float64]:
    """Pose camera-to-world (4, 4) in OpenCV axes of a camera at `eye` [m] that looks at `target` [m], `up` upwards."""
    z = np.asarray(target, float) - np.asarray(eye, float)
    z /= np.linalg.norm(z)
    x = np.cross(z, np.asarray(up, float))
    x /= np.linalg.norm(x)
    pose = np.eye(4)
    pose[:3, :3] = np.column_stack([x, np.cross(z, x), z])
    pose[:3, 3] = eye
    return pose


def _exact(name: str, pose: NDArray[np.float64]) -> CameraDraw:
    return CameraDraw(name=name, true_pose=pose, told_pose=pose)


FRONT = _exact("front", look_at(FRONT_EYE, FRONT_TARGET))
TOP = _exact("top", look_at(TOP_EYE, (0.55, 0.0, 0.0), up=(1.0, 0.0, 0.0)))


def draw_cameras(rng: np.random.Generator, *, residual: float = 1.0) -> tuple[CameraDraw, ...]:
    """Both cameras, displaced from their nominal poses and told to the robot but for `residual` times the calibration's."""
    drawn: list[CameraDraw] = []
    for nominal in (FRONT, TOP):
        true = _displaced(nominal.true_pose, rng, JITTER_M, JITTER_RAD)
        told = _displaced(true, rng, residual * RESIDUAL_M, residual * RESIDUAL_RAD)
        drawn.append(CameraDraw(name=nominal.name, true_pose=true, told_pose=told))
    return tuple(drawn)


def _displaced(pose: NDArray[np.float64], rng: np.random.Generator, shift: float, turn: float) -> NDArray[np.float64]:
    """The pose moved and turned by normal draws of root-mean-square size `shift` [m] and `turn` [rad]."""
    rotation = np.empty(9)
    vector = rng.normal(0.0, turn / np.sqrt(3.0), 3)
    angle = float(np.linalg.norm(vector))
    quaternion = np.empty(4)
    mujoco.mju_axisAngle2Quat(quaternion, vector / max(angle, 1e-12), angle)
    mujoco.mju_quat2Mat(rotation, quaternion)
    moved = pose.copy()
    moved[:3, :3] = rotation.reshape(3, 3) @ pose[:3, :3]
    moved[:3, 3] += rng.normal(0.0, shift / np.sqrt(3.0), 3)
    return moved


def focal_length(camera: CameraDraw) -> float:
    """Focal length [px] from the vertical field of view."""
    return camera.height / 2.0 / float(np.tan(np.deg2rad(camera.fovy) / 2.0))


@lru_cache(maxsize=8)
def pixel_rays(width: int, height: int, focal: float) -> NDArray[np.float32]:
    """Ray of each pixel in camera axes with z = 1, shape (H * W, 3); the principal point is the image's middle."""
    u, v = np.meshgrid(np.arange(width), np.arange(height))
    rays = np.stack([(u - (width - 1) / 2) / focal, (v - (height - 1) / 2) / focal, np.ones_like(u, float)], axis=-1)
    return rays.reshape(-1, 3).astype(np.float32)


def _enters_volume(eye: NDArray[np.float64], rays: NDArray[np.float32]) -> NDArray[np.intp]:
    """Indices of the rays (N, 3) from `eye` that meet the seen volume (slab test)."""
    near = np.full(len(rays), 0.0, np.float32)
    far = np.full(len(rays), np.inf, np.float32)
    for axis in range(3):
        with np.errstate(divide="ignore"):
            inverse = 1.0 / rays[:, axis]
        a = (np.float32(SEEN_LOWER[axis] - eye[axis])) * inverse
        b = (np.float32(SEEN_UPPER[axis] - eye[axis])) * inverse
        np.maximum(near, np.minimum(a, b), out=near)
        np.minimum(far, np.maximum(a, b), out=far)
    return np.flatnonzero(near <= far)


def cast_rays(
    model: Any, data: Any, eye: NDArray[np.float64], rays: NDArray[np.float32], exclude: int = -1
) -> tuple[NDArray[np.int32], NDArray[np.float64], NDArray[np.float32]]:
    """Geom (N,), z-depth (N,) and surface normal (N, 3) that each ray (N, 3) with camera z = 1 meets; geom -1: none."""
    count = len(rays)
    geom = np.full(count, -1, np.int32)
    distance = np.full(count, -1.0)
    normal = np.zeros(3 * count)
    length = np.sqrt(np.einsum("ij,ij->i", rays, rays)).astype(np.float64)
    unit = (rays / length[:, None]).ravel()
    if count:
        mujoco.mj_multiRay(model, data, eye, unit, None, True, exclude, geom, distance, normal, count, 10.0)
    return geom, distance / length, normal.reshape(-1, 3).astype(np.float32)


def cast(model: Any, data: Any, camera: CameraDraw, placed: PlacedScene, *, whole: bool = False) -> RayImage:
    """What the camera sees from its true pose, exact.

    Args:
        model: Compiled MuJoCo model; colours are its geoms' (or materials') rgba.
        data: State with up-to-date geom poses (`mj_kinematics` at least).
        camera: The camera.
        placed: The scene, for light and table pattern.
        whole: Cast every ray, not only those that meet the table's volume (for pictures that people look at).
    """
    focal = focal_length(camera)
    eye = np.ascontiguousarray(camera.true_pose[:3, 3])
    rays = pixel_rays(camera.width, camera.height, focal) @ camera.true_pose[:3, :3].T.astype(np.float32)
    chosen = np.arange(len(rays)) if whole else _enters_volume(eye, rays)
    geom, depth, normal = cast_rays(model, data, eye, rays[chosen])
    light = _Light(model, placed)
    image = _floor(camera, eye, rays, light)
    hit = geom >= 0
    pixels = chosen[hit]
    colour = light.shade(geom[hit], eye, rays[pixels], depth[hit], normal[hit])
    clear = light.rgba[geom[hit], 3] < 0.99
    through = pixels[clear]
    if len(through):
        behind = _seen_through(model, data, eye, rays, through, geom[hit][clear], light, image.rgb.reshape(-1, 3))
        alpha = light.rgba[geom[hit][clear], 3:4]
        colour[clear] = alpha * colour[clear] + (1 - alpha) * behind
    image.rgb.reshape(-1, 3)[pixels] = colour
    image.depth.reshape(-1)[pixels] = depth[hit]
    image.geom.reshape(-1)[pixels] = geom[hit]
    image.through.reshape(-1)[through] = True
    return image


def _floor(camera: CameraDraw, eye: NDArray[np.float64], rays: NDArray[np.float32], light: _Light) -> RayImage:
    """An image of the bare floor."""
    shape = (camera.height, camera.width)
    with np.errstate(divide="ignore"):
        depth = np.float32(FLOOR_Z - eye[2]) / rays[:, 2]
    depth[(depth < 0) | (depth > 10.0)] = 0.0
    rgb = np.empty((*shape, 3), np.float32)
    rgb[:] = light.floor()
    return RayImage(depth.reshape(shape), np.full(shape, -1, np.int32), rgb, np.zeros(shape, bool))


def _seen_through(
    model: Any,
    data: Any,
    eye: NDArray[np.float64],
    rays: NDArray[np.float32],
    pixels: NDArray[np.intp],
    geoms: NDArray[np.int32],
    light: _Light,
    floor: NDArray[np.float32],
) -> NDArray[np.float32]:
    """Colours (N, 3) of what lies behind a see-through body, which the second ray leaves out."""
    colours = floor[pixels].copy()
    bodies = model.geom_bodyid[geoms]
    for body in np.unique(bodies):
        mine = np.flatnonzero(bodies == body)
        geom, depth, normal = cast_rays(model, data, eye, rays[pixels[mine]], exclude=int(body))
        hit = geom >= 0
        colours[mine[hit]] = light.shade(geom[hit], eye, rays[pixels[mine[hit]]], depth[hit], normal[hit])
    return colours


class _Light:
    """Lambert shading of geom colours under one distant light and an ambient part."""

    def __init__(self, model: Any, placed: PlacedScene) -> None:
        self.model = model
        material = model.geom_matid
        rgba = np.where((material >= 0)[:, None], model.mat_rgba[material], model.geom_rgba) if model.nmat else None
        self.rgba = np.array(model.geom_rgba if rgba is None else rgba, np.float32)
        direction = np.asarray(placed.light, np.float32)
        self.direction = direction / np.linalg.norm(direction)
        self.ambient = np.float32(placed.ambient)
        self.table = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, "table")
        self.pattern = [float(placed.extras.get(key, 0.0)) for key in ("table_contrast", "table_grain", "table_turn")]

    def floor(self) -> NDArray[np.float32]:
        """Colour (3,) of the floor, whose normal is up."""
        floor = mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_GEOM, "floor")
        colour = self.rgba[floor, :3] if floor >= 0 else FLOOR_COLOUR
        return colour * (self.ambient + (1 - self.ambient) * max(np.float32(0.0), self.direction[2]))

    def shade(
        self,
        geom: NDArray[np.int32],
        eye: NDArray[np.float64],
        rays: NDArray[np.float32],
        depth: NDArray[np.float64],
        normal: NDArray[np.float32],
    ) -> NDArray[np.float32]:
        """Colours (N, 3) of surfaces met by rays (N, 3) at z-depths (N,) with normals (N, 3)."""
        facing = np.maximum(normal @ self.direction, 0.0)
        brightness = self.ambient + (1 - self.ambient) * facing
        contrast, grain, turn = self.pattern
        if contrast > 0.0:
            on_table = np.flatnonzero(geom == self.table)
            hit = rays[on_table, :2] * depth[on_table, None].astype(np.float32) + eye[:2].astype(np.float32)
            across = np.float32(np.cos(turn)) * hit[:, 0] + np.float32(np.sin(turn)) * hit[:, 1]
            along = np.float32(-np.sin(turn)) * hit[:, 0] + np.float32(np.cos(turn)) * hit[:, 1]
            veins = np.sin(np.float32(2 * np.pi / grain) * (across + np.float32(0.02) * np.sin(20 * along)))
            brightness[on_table] *= 1 - np.float32(contrast) * (0.5 + 0.5 * veins)
        return np.clip(self.rgba[geom, :3] * brightness[:, None], 0.0, 1.0).astype(np.float32)


def capture(
    model: Any, data: Any, camera: CameraDraw, placed: PlacedScene, rng: np.random.Generator, *, noise: float = 1.0
) -> RgbdView:
    """One RGB-D picture as the robot gets it: seen from the true pose, told with the calibrated one, with noise.

    Args:
        model: Compiled MuJoCo model.
        data: State with up-to-date geom poses.
        camera: True and told pose.
        placed: Light and noise scale of the scene.
        rng: Source of the noise; not used when the noise is zero.
        noise: Further scale of the noise.
    """
    image = cast(model, data, camera, placed)
    scale = noise * placed.noise
    return RgbdView(
        name=camera.name,
        rgb=noisy_colour(image.rgb, rng, scale),
        depth=noisy_depth(image.depth, image.through, rng, scale),
        focal=focal_length(camera),
        transform_camera_to_world=camera.told_pose.copy(),
    )


def capture_all(
    model: Any, data: Any, cameras: Sequence[CameraDraw], placed: PlacedScene, rng: np.random.Generator
) -> tuple[RgbdView, ...]:
    """Pictures of several cameras at the same instant, in threads; the noise does not depend on their timing.

    MuJoCo's ray caster keeps its working memory in the state that it is given, so every thread gets a state of its own.
    Its poses follow from the positions alone: a picture after `World.restore` is the picture before the snapshot.
    """
    streams = rng.spawn(len(cameras))
    with ThreadPoolExecutor(max_workers=max(1, len(cameras))) as pool:
        jobs = [
            pool.submit(capture, model, _twin(model, data), camera, placed, stream)
            for camera, stream in zip(cameras, streams, strict=True)
        ]
        return tuple(job.result() for job in jobs)


def _twin(model: Any, data: Any) -> Any:
    """Another state with the same positions and up-to-date geom poses."""
    twin = mujoco.MjData(model)
    twin.qpos[:] = data.qpos
    mujoco.mj_kinematics(model, twin)
    return twin
