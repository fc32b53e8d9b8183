"""Grasps in a line, and what a motion wrote, for the tests of the robot."""

from __future__ import annotations

import math

import numpy as np

from kb.grasp import Grasp
from sim.motion import Obstacle
from sim.placed import PlacedObject
from sim.recording import Recording
from sim.world import World


def from_above(x: float, y: float, z: float, yaw: float = 0.0, **fields) -> Grasp:
    """A pinch straight down."""
    values = {"aperture": 0.07, "force": 15.0, "type": "pinch"} | fields
    return Grasp(position=(x, y, z), approach=(0, 0, -1), yaw=yaw, **values)


def from_aside(x: float, y: float, z: float, azimuth: float, **fields) -> Grasp:
    """A level grasp that comes along an azimuth [rad]."""
    values = {"aperture": 0.08, "force": 20.0, "type": "side"} | fields
    return Grasp(
        position=(x, y, z), approach=(math.cos(azimuth), math.sin(azimuth), 0), yaw=azimuth + math.pi / 2, **values
    )


def box_of(thing: PlacedObject) -> Obstacle:
    """The box around an upright thing."""
    (x, y, z), (long, wide, high) = thing.position, thing.size
    return Obstacle((x, y, z + high / 2), 0.0, (long / 2, wide / 2, high / 2))


def place_of(world: World, name: str) -> np.ndarray:
    """Where an object's origin is now, (3,) [m]."""
    return world.data.qpos[world.index.objects[name].qpos][:3].copy()


class Keeper:
    """Keeps every recording of a world."""

    def __init__(self, world: World) -> None:
        self.kept: list[Recording] = []
        world.recorders.append(self)

    def on_recording(self, recording: Recording) -> None:
        self.kept.append(recording)

    def phases(self) -> list[str]:
        """Names of the phases, in order, each once in a row."""
        out: list[str] = []
        for record in self.kept:
            if not out or out[-1] != record.phase:
                out.append(record.phase)
        return out
