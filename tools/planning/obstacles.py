"""Upright boxes around everything perceived, for the arm's way between grasps."""

from __future__ import annotations

from kb.base import Vec3
from kb.percept import PerceivedObject, Percept
from sim.motion import Obstacle
from sim.setting import setting_obstacles

GROWTH = 0.004
"""Added on every side of a perceived box [m]: visible points fall short of the true size (perception.md)."""


def obstacle_of(seen: PerceivedObject) -> Obstacle:
    """The perceived box of one object, grown by the error of perception."""
    long, short, high = seen.size
    half: Vec3 = (long / 2 + GROWTH, short / 2 + GROWTH, high / 2 + GROWTH)
    return Obstacle(centre=seen.position, yaw=seen.yaw, half=half)


def obstacles(percept: Percept, without: tuple[str, ...] = ()) -> tuple[Obstacle, ...]:
    """Boxes of all perceived objects except those named, and the bin that the robot knows of."""
    found = [obstacle_of(seen) for seen in percept.objects if seen.id not in without]
    return (*found, *setting_obstacles(percept.bin))
