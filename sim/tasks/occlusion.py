"""Task IT-b: the ball must be hidden from the front camera by the box (ledger G51)."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.build_model import build_model
from sim.cameras import cast_rays, focal_length, pixel_rays
from sim.footprint import world_points
from sim.placed import CameraDraw, PlacedObject, PlacedScene

LEAST_HIDDEN = 0.60
"""Share of the target's pixels that the front camera must not see (benchmark.md section 3)."""


def mostly_hidden(placed: PlacedScene) -> bool:
    """Whether at least 60 % of the task's target is hidden in the front view."""
    target = placed.task.target if placed.task is not None else None
    return target is not None and hidden_share(placed, target) >= LEAST_HIDDEN


def hidden_share(placed: PlacedScene, name: str) -> float:
    """Share of the object's pixels in the front view, seen alone, that other objects hide; in [0, 1]."""
    alone = tuple(thing for thing in placed.objects if thing.id == name)
    rays = _rays_towards(alone[0], placed.cameras[0])
    seen, whole = (_hits(replace(placed, objects=things), name, rays) for things in (placed.objects, alone))
    return 1.0 - seen / whole if whole else 1.0


def _rays_towards(thing: PlacedObject, camera: CameraDraw) -> NDArray[np.float32]:
    """World rays (N, 3) of every second pixel in each direction in the window around the object."""
    rotation, eye = camera.true_pose[:3, :3], camera.true_pose[:3, 3]
    seen = (world_points(thing) - eye) @ rotation
    slopes = seen[:, :2] / seen[:, 2:]
    rays = pixel_rays(camera.width // 2, camera.height // 2, focal_length(camera) / 2)
    inside = ((rays[:, :2] >= slopes.min(0)) & (rays[:, :2] <= slopes.max(0))).all(axis=1)
    return rays[inside] @ rotation.T.astype(np.float32)


def _hits(placed: PlacedScene, name: str, rays: NDArray[np.float32]) -> int:
    model = build_model(replace(placed, particles=()), check=False)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    eye = np.ascontiguousarray(placed.cameras[0].true_pose[:3, 3])
    geom, _, _ = cast_rays(model, data, eye, rays)
    return int(np.isin(geom, np.flatnonzero(model.geom_bodyid == model.body(name).id)).sum())
