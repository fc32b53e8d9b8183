"""Upright boxes around everything perceived, for the arm's way between grasps."""

from __future__ import annotations

from kb.base import Vec3
from kb.percept import PerceivedObject, Percept
from kb.sensing import Plan
from sim.motion import Obstacle
from sim.setting import setting_obstacles
from tools.planning.set_down import SetDown

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


def set_down_box(held: PerceivedObject, option: SetDown, plan: Plan) -> Obstacle:
    """The box of an object where it will stand."""
    long, short, high = held.size
    base = option.position[2] - (plan.grasp.position[2] - held.base_z)
    return Obstacle(
        centre=(option.centre[0], option.centre[1], base + high / 2),
        yaw=held.yaw + option.turn,
        half=(long / 2 + GROWTH, short / 2 + GROWTH, high / 2 + GROWTH),
    )
