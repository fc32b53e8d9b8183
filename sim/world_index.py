"""Where in MuJoCo's arrays each named thing of a scene lies."""

# MuJoCo ships no type stubs for its compiled functions.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from dataclasses import dataclass, field

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.build_model import particle_name
from sim.placed import PlacedScene


@dataclass(frozen=True)
class ObjectIndex:
    """Addresses of one object."""

    body: int
    geoms: tuple[int, ...]
    """Geom ids in the order of `PlacedObject.geoms`."""
    qpos: slice | None
    """Position (3,) and quaternion (4,) in qpos; None for a fixed object."""
    qvel: slice | None
    """Linear (3,) and angular (3,) velocity in qvel."""


@dataclass(frozen=True)
class WorldIndex:
    """Names to addresses; compiled once per scene."""

    sensors: dict[str, slice]
    """Sensor name to columns of sensordata; numbered sensors ("robot/joint_position/1"...) also as one group."""
    objects: dict[str, ObjectIndex]
    particles: dict[str, NDArray[np.int64]] = field(default_factory=dict)
    """Container id to the first qpos address of each of its particles, shape (N,)."""
    geom_owner: dict[int, str] = field(default_factory=dict)
    """Geom id to "robot", "table", "floor", an object's id, or "particle/<container>"."""
    arm: slice = field(default_factory=lambda: slice(0, 7))
    fingers: slice = field(default_factory=lambda: slice(7, 9))
    gripper: int = 7
    """Actuator number of the gripper."""
    gripper_control: int = 21
    """Its column in the controls."""


def index_model(model: mujoco.MjModel, placed: PlacedScene) -> WorldIndex:
    """Reads all addresses of the compiled scene."""
    sensors = {
        model.sensor(i).name: slice(int(model.sensor_adr[i]), int(model.sensor_adr[i] + model.sensor_dim[i]))
        for i in range(model.nsensor)
    }
    for group in ("robot/joint_position", "robot/joint_velocity", "robot/joint_torque"):
        sensors[group] = slice(sensors[f"{group}/1"].start, sensors[f"{group}/7"].stop)
    objects = {thing.id: _index_object(model, thing.id, len(thing.geoms), thing.fixed) for thing in placed.objects}
    particles = {
        group.container: np.array(
            [
                int(model.joint(particle_name(group.container, i)).qposadr[0])
                for i in range(len(np.asarray(group.positions)))
            ],
            dtype=np.int64,
        )
        for group in placed.particles
    }
    return WorldIndex(
        sensors=sensors,
        objects=objects,
        particles=particles,
        geom_owner={geom: _owner(model, geom) for geom in range(model.ngeom)},
        gripper=model.actuator("robot/gripper").id,
        gripper_control=int(model.nu) - 1,
    )


def _index_object(model: mujoco.MjModel, name: str, geoms: int, fixed: bool) -> ObjectIndex:
    ids = tuple(model.geom(f"{name}/{number}").id for number in range(geoms))
    if fixed:
        return ObjectIndex(model.body(name).id, ids, None, None)
    joint = model.joint(name)
    q, v = int(joint.qposadr[0]), int(joint.dofadr[0])
    return ObjectIndex(model.body(name).id, ids, slice(q, q + 7), slice(v, v + 6))


def _owner(model: mujoco.MjModel, geom: int) -> str:
    name = model.body(int(model.geom_bodyid[geom])).name
    if name.startswith("robot/"):
        return "robot"
    if name.startswith("particle/"):
        return name.rpartition("/")[0]
    return "floor" if name == "world" else name
