"""Upright boxes around everything perceived, for the arm's way between grasps."""

from __future__ import annotations

from kb.base import Vec3
from kb.percept import PerceivedObject, Percept
from sim.motion import Obstacle

GROWTH = 0.004
"""Added on every side of a perceived box [m]: visible points fall short of the true size (perception.md)."""
BIN_WALL = 0.006
"""Thickness of the bin's walls and floor [m]."""


def obstacle_of(seen: PerceivedObject) -> Obstacle:
    """The perceived box of one object, grown by the error of perception."""
    long, short, high = seen.size
    half: Vec3 = (long / 2 + GROWTH, short / 2 + GROWTH, high / 2 + GROWTH)
    return Obstacle(centre=seen.position, yaw=seen.yaw, half=half)


def obstacles(percept: Percept, without: tuple[str, ...] = ()) -> tuple[Obstacle, ...]:
    """Boxes of all perceived objects except those named, and the walls of the bin."""
    found = [obstacle_of(seen) for seen in percept.objects if seen.id not in without]
    return (*found, *bin_walls(percept.bin))


def bin_walls(corners: tuple[Vec3, Vec3] | None) -> tuple[Obstacle, ...]:
    """The four walls of the bin as boxes; what is above its opening stays free."""
    if corners is None:
        return ()
    (x0, y0, z0), (x1, y1, z1) = corners
    middle_x, middle_y, middle_z = (x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2
    half_x, half_y, half_z = (x1 - x0) / 2, (y1 - y0) / 2, (z1 - z0) / 2
    wall = BIN_WALL / 2
    along_x: Vec3 = (half_x + BIN_WALL, wall, half_z)
    along_y: Vec3 = (wall, half_y + BIN_WALL, half_z)
    return (
        Obstacle(centre=(middle_x, y0 - wall, middle_z), yaw=0.0, half=along_x),
        Obstacle(centre=(middle_x, y1 + wall, middle_z), yaw=0.0, half=along_x),
        Obstacle(centre=(x0 - wall, middle_y, middle_z), yaw=0.0, half=along_y),
        Obstacle(centre=(x1 + wall, middle_y, middle_z), yaw=0.0, half=along_y),
    )
