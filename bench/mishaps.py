"""Mishaps: what goes wrong around the first grasp of a trial without the robot being told, so that recovery can be counted.

Where hardly a first attempt fails there is nothing to recover. Here the world or the first motion differs from what the
robot planned for; whether its first attempt then fails, and what comes after, is physics' and the robot's business. Two
mishaps last for the whole trial (a slippery thing, a heavy one), three pass (a nudge, an arm that is off, a weak grip).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np

if TYPE_CHECKING:
    from kb.grasp import Grasp
    from kb.sensing import Sensing
    from sim.placed import PlacedObject, PlacedScene
    from sim.world import World

MishapName = Literal["slippery", "heavy", "nudged", "arm_off", "weak_grip"]
MISHAPS: tuple[MishapName, ...] = get_args(MishapName)

SLIPPERY = 0.5
"""Factor on the friction of the thing to be grasped."""
HEAVY = 2.0
"""Factor on its mass."""
NUDGE = (0.03, 0.06)
"""How far it is moved between the look and the grasp [m]."""
NUDGE_TURN = 0.5
"""Largest turn about the vertical with it [rad]."""
NUDGE_FREE = 0.01
"""Distance that it keeps from everything else [m]; it is moved less far where there is no room."""
ARM_OFF = (0.015, 0.035)
"""How far from where it was sent the hand goes, sideways [m]."""
WEAK = (0.15, 0.40)
"""Share of the commanded force with which the hand closes."""
STREAM = 29
"""Number of the random stream, with the trial's seed."""


def changed_scene(mishap: MishapName | None) -> Callable[[PlacedScene], PlacedScene] | None:
    """What a lasting mishap changes in a drawn scene; None where it changes nothing."""
    if mishap not in ("slippery", "heavy"):
        return None

    def change(placed: PlacedScene) -> PlacedScene:
        victim = _victim(placed)
        return replace(placed, objects=tuple(_worse(mishap, o) if o.id == victim else o for o in placed.objects))

    return change


def _victim(placed: PlacedScene) -> str:
    """The task's target, or one of the movable things where all are meant."""
    if placed.task is not None and placed.task.target is not None:
        return placed.task.target
    movable = [thing.id for thing in placed.objects if not thing.fixed]
    return str(np.random.default_rng([placed.seed, STREAM]).choice(movable))


def _worse(mishap: MishapName | None, thing: PlacedObject) -> PlacedObject:
    if mishap == "slippery":
        return replace(thing, friction=thing.friction * SLIPPERY)
    geoms = tuple(replace(geom, mass=geom.mass * HEAVY) for geom in thing.geoms)
    return replace(thing, mass=thing.mass * HEAVY, geoms=geoms)


class UnluckyRobot:
    """A robot whose first motion of a trial suffers a passing mishap; everything else goes straight through.

    What happens follows from the trial's seed and the motion alone, so that configurations that plan the same first grasp
    see the same mishap.
    """

    def __init__(self, robot: Any, world: World, mishap: MishapName) -> None:
        self._robot, self._world = robot, world
        self._mishap: MishapName = mishap

    def grasp(self, grasp: Grasp, **options: Any) -> Sensing:
        """As `sim.robot.Robot.grasp`."""
        if self._world.attempt == 0:
            rng = np.random.default_rng([self._world.placed.seed, STREAM])
            if self._mishap == "nudged":
                nudge(self._world, grasp, rng)
            else:
                grasp, options = _bent(self._mishap, grasp, options, rng)
        return self._robot.grasp(grasp, **options)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._robot, name)


def _bent(
    mishap: MishapName, grasp: Grasp, options: dict[str, Any], rng: np.random.Generator
) -> tuple[Grasp, dict[str, Any]]:
    """What the arm does instead of what it was told."""
    if mishap == "arm_off":
        bearing, off = rng.uniform(-math.pi, math.pi), rng.uniform(*ARM_OFF)
        x, y, z = grasp.position
        position = (x + off * math.cos(bearing), y + off * math.sin(bearing), z)
        return grasp.model_copy(update={"position": position}), options | {"joints": None}
    share = rng.uniform(*WEAK)
    most = options.get("most_force")
    weak = options if most is None else options | {"most_force": share * most}
    return grasp.model_copy(update={"force": share * grasp.force}), weak


def nudge(world: World, grasp: Grasp, rng: np.random.Generator) -> str | None:
    """Somebody moves the thing that is about to be grasped along the table, as far as there is room.

    Returns:
        Id of what was moved, or None where everything is wedged in.
    """
    movable = [thing for thing in world.placed.objects if not thing.fixed]
    poses = {thing.id: world.data.qpos[_address(world, thing.id)].copy() for thing in movable}
    victim = min(movable, key=lambda thing: (math.dist(poses[thing.id][:2], grasp.position[:2]), thing.id))
    others = [(poses[thing.id][:2], _radius(thing)) for thing in movable if thing.id != victim.id]
    begin, turn = poses[victim.id], rng.uniform(-NUDGE_TURN, NUDGE_TURN)
    far, bearings = rng.uniform(*NUDGE), rng.permutation(12) * math.tau / 12
    for share in (1.0, 0.6, 0.3):
        for bearing in bearings:
            to = begin[:2] + share * far * np.array([math.cos(bearing), math.sin(bearing)])
            if all(math.dist(to, at) > wide + _radius(victim) + NUDGE_FREE for at, wide in others):
                _put(world, victim.id, to, share * turn)
                return victim.id
    return None


def _address(world: World, name: str) -> slice:
    address = world.index.objects[name].qpos
    assert address is not None
    return address


def _radius(thing: PlacedObject) -> float:
    """Radius of a circle around its footprint [m]."""
    return math.hypot(thing.size[0], thing.size[1]) / 2.0


def _put(world: World, name: str, to: np.ndarray, turn: float) -> None:
    """Puts a thing elsewhere on the table, turned about the vertical, at rest."""
    address = _address(world, name)
    w, x, y, z = world.data.qpos[address][3:]
    c, s = math.cos(turn / 2), math.sin(turn / 2)
    world.data.qpos[address][:2] = to
    world.data.qpos[address][3:] = (c * w - s * z, c * x - s * y, c * y + s * x, c * z + s * w)
    world.settle()
