"""Lets stacked, filled and the user's own objects come to rest before a run starts; nothing is moved once it has."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import mujoco
import numpy as np

from sim.build_model import build_model, particle_name
from sim.panda import READY
from sim.placed import PlacedObject, PlacedScene

LONGEST_S, CHECK_S = 3.0, 0.1
"""Longest time to come to rest, and time between looks [s]."""
STILL_M, STILL_BALL_M = 5e-5, 5e-4
"""Largest displacement between looks of a thing that rests, and of a ball among others [m]."""
FINENESS = 1e-4
"""Accuracy of the height at which a thing is laid down [m]."""


def lay_down(placed: PlacedScene, name: str, highest: float) -> PlacedObject:
    """The object lowered straight down until it would touch something.

    Args:
        placed: The scene with everything below already in place.
        name: Scene id of the object.
        highest: Height of its frame at which it is free [m].
    """
    thing = next(thing for thing in placed.objects if thing.id == name)
    model = build_model(placed, check=False)
    data = mujoco.MjData(model)
    address = int(model.jnt_qposadr[model.body_jntadr[model.body(name).id]])
    low, high = 0.0, highest
    if _touches(model, data, name, address, high):
        return thing
    while high - low > FINENESS:
        middle = (low + high) / 2
        low, high = (middle, high) if _touches(model, data, name, address, middle) else (low, middle)
    return replace(thing, position=(*thing.position[:2], high))


def _touches(model: Any, data: Any, name: str, address: int, height: float) -> bool:
    data.qpos[address + 2] = height
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_collision(model, data)
    body = model.body(name).id
    bodies = model.geom_bodyid[data.contact.geom[: data.ncon]]
    return bool(np.any(bodies == body))


def settle(placed: PlacedScene) -> tuple[PlacedScene, bool]:
    """The scene after its things came to rest, and whether they did within 3 s. The arm stays at its ready pose."""
    model = build_model(placed, check=False)
    data = mujoco.MjData(model)
    data.qpos[:7] = READY
    data.qpos[7:9] = 0.04
    data.ctrl[0:21:3] = READY
    data.ctrl[21] = 0.08
    data.act[:] = 0.08
    names = [thing.id for thing in placed.objects if not thing.fixed]
    balls = [particle_name(group.container, k) for group in placed.particles for k in range(len(group.positions))]
    free = [int(model.jnt_qposadr[model.body_jntadr[model.body(name).id]]) for name in [*names, *balls]]
    limits = np.array([STILL_M] * len(names) + [STILL_BALL_M] * len(balls))
    before = _places(data, free)
    rests = False
    for look in range(round(LONGEST_S / CHECK_S)):
        mujoco.mj_step(model, data, nstep=round(CHECK_S / model.opt.timestep))
        after = _places(data, free)
        rests = bool(np.all(np.abs(after - before).max(axis=1) < limits))
        if rests and look >= 3:
            break
        before = after
    poses = {
        name: data.qpos[address : address + 7].copy() for name, address in zip([*names, *balls], free, strict=True)
    }
    return _with_poses(placed, poses), rests


def _places(data: Any, free: list[int]) -> Any:
    return np.array([data.qpos[address : address + 3] for address in free])


def _with_poses(placed: PlacedScene, poses: dict[str, Any]) -> PlacedScene:
    objects = tuple(thing if thing.fixed else replace(thing, **_pose(poses[thing.id])) for thing in placed.objects)
    particles = tuple(
        replace(
            group,
            positions=np.array([poses[particle_name(group.container, k)][:3] for k in range(len(group.positions))]),
        )
        for group in placed.particles
    )
    return replace(placed, objects=objects, particles=particles)


def _pose(qpos: Any) -> dict[str, tuple[float, ...]]:
    return {"position": tuple(qpos[:3].tolist()), "quaternion": tuple(qpos[3:7].tolist())}
