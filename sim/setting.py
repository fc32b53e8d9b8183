"""What the robot knows of its surroundings from its set-up, without seeing: the bin beside the table."""

from __future__ import annotations

from kb.base import Vec3
from sim.motion import Obstacle

WALL = 0.012
"""Thickness assumed for the bin's walls and floor [m]."""


def setting_obstacles(bin_corners: tuple[Vec3, Vec3] | None) -> list[Obstacle]:
    """The bin's walls, and its floor with the stand, as boxes; none without a bin."""
    if bin_corners is None:
        return []
    low, high = bin_corners
    middle = [(a + b) / 2 for a, b in zip(low, high, strict=True)]
    half = [(b - a) / 2 for a, b in zip(low, high, strict=True)]
    walls = []
    for sign in (-1.0, 1.0):
        x = middle[0] + sign * (half[0] + WALL / 2)
        y = middle[1] + sign * (half[1] + WALL / 2)
        walls.append(Obstacle((x, middle[1], middle[2]), 0.0, (WALL / 2, half[1] + WALL, half[2])))
        walls.append(Obstacle((middle[0], y, middle[2]), 0.0, (half[0] + WALL, WALL / 2, half[2])))
    stand = Obstacle((middle[0], middle[1], low[2] - 0.10), 0.0, (half[0] + WALL, half[1] + WALL, 0.10))
    return [*walls, stand]
