"""Calibration gate: hand-written grasps at the annotated region, at true poses, lift every object unharmed."""

from __future__ import annotations

import math

import numpy as np
import pytest

from kb.grasp import Grasp, GraspType
from sim.catalogue import MODELS
from sim.draw_scene import draw_scene
from sim.footprint import rotation
from sim.objects.tableware import wall_tilt
from sim.observer import Observer
from sim.placed import PlacedObject
from sim.reach import Unreachable, solve_reach
from sim.robot import Robot
from sim.scene_spec import ObjectSpec, Randomise, SceneSpec
from sim.world import World

DOWN = (0.0, 0.0, -1.0)
Local = tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float], float, float]
"""Position, approach and closing axis in the object's frame, opening [m] and force [N]."""


def grasps(thing: PlacedObject) -> tuple[list[Local], GraspType]:
    """Alternatives for one object, in its own frame, from its true parts."""
    part = next(part for part in thing.parts if part.region == thing.affordance.region)
    x, y, z = part.centre
    match part.region:
        case "handle" if part.outward is not None:  # a loop: from above, pads on the bar's flat sides
            return [((x + 0.003, 0.0, thing.size[2] - 0.034), DOWN, (0.0, 1.0, 0.0), 0.05, 20.0)], "pinch"
        case "rim":  # along the wall, one finger inside
            tilt, radius = wall_tilt(), (part.radius or 0.0) - 0.0025
            angles = np.arange(8) * math.pi / 4
            return [
                (
                    (radius * math.cos(a), radius * math.sin(a), z - 0.009),
                    (-math.sin(tilt) * math.cos(a), -math.sin(tilt) * math.sin(a), -math.cos(tilt)),
                    (math.cos(a), math.sin(a), 0.0),
                    0.04,
                    20.0,
                )
                for a in angles
            ], "pinch"
        case "stem" | "neck":  # from the side
            force, dip = (4.0, math.radians(20)) if part.region == "stem" else (9.0, 0.0)
            return [
                (
                    (x, y, z + (0.012 if part.region == "stem" else 0.0)),
                    (math.cos(dip) * math.cos(a), math.cos(dip) * math.sin(a), -math.sin(dip)),
                    (-math.sin(a), math.cos(a), 0.0),
                    0.04 if part.region == "stem" else 0.065,
                    force,
                )
                for a in np.arange(24) * math.pi / 12
            ], "side"
    if thing.category == "bottle":  # high on the body, from above there is the neck in the way
        angles = np.arange(24) * math.pi / 12
        return [
            ((0.0, 0.0, 0.11), (math.cos(a), math.sin(a), 0.0), (-math.sin(a), math.cos(a), 0.0), 0.08, 20.0)
            for a in angles
        ], "side"
    across = (0.0, 1.0, 0.0) if abs(part.axis[0]) > 0.5 else (1.0, 0.0, 0.0)
    height = max(min(z + 0.004, thing.size[2] - 0.004), 0.0115)
    opening = min(0.08, part.width + 0.03)
    return [((x, y, height), DOWN, across, opening, 15.0)], "pinch"


def world_grasps(thing: PlacedObject) -> list[Grasp]:
    """The alternatives in the world that the arm can reach, cheapest first."""
    turn, origin = rotation(thing.quaternion), np.asarray(thing.position)
    locals_, kind = grasps(thing)
    found: list[tuple[float, Grasp]] = []
    for position, approach, closing, opening, force in locals_:
        point, direction, axis = (turn @ np.asarray(v) for v in (position, approach, closing))
        grasp = Grasp(
            position=tuple((point + origin).tolist()),
            approach=tuple(direction.tolist()),
            yaw=math.atan2(axis[1], axis[0]),
            aperture=opening,
            force=force,
            type=kind,
        )
        reach = solve_reach(grasp)
        if not isinstance(reach, Unreachable):
            found.append((reach.cost, grasp))
    return [grasp for _, grasp in sorted(found, key=lambda pair: pair[0])]


@pytest.mark.parametrize("name", [name for name, entry in MODELS.items() if not entry.fixed and name != "box"])
def test_each_object_can_be_lifted_by_its_affordance_region(name: str) -> None:
    """Gripped at the region Table I implies, the object is raised, held and shaken without damage, cups by the handle."""
    spec = SceneSpec(
        name="alone",
        objects=(ObjectSpec(id="thing", model=name, position=(0.5, 0.05)),),
        randomise=Randomise(position=0.05, yaw=0.6, size=0.05, mass=0.2, friction=0.2),
    )
    placed = draw_scene(spec, 1)
    for grasp in world_grasps(placed.objects[0])[:6]:
        world = World(placed)
        observer = Observer(world)
        sensing = Robot(world).grasp(grasp)
        if sensing.stopped_by == "path":
            continue
        observed = observer.judge(world.attempt, "thing")
        assert observed.success, (observed.failure, observed.verdict)
        return
    pytest.fail("no grasp could be reached on a free path")
