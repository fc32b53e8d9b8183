"""Scenes in which things lean on others or lie inside them: relations that the task scenes and random scenes lack."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from sim.cameras import draw_cameras
from sim.catalogue import MODELS
from sim.draw_scene import lit
from sim.objects.colours import anything
from sim.objects.form import quaternion_about, quaternion_product
from sim.placed import PlacedObject, PlacedScene
from sim.settle import lay_down

LOWER, UPPER = (0.40, -0.25), (0.65, 0.25)
"""Part of the table where things are put (x, y) [m]."""
CLEAR = 3e-4
"""Free distance of a leaning thing from what it leans on [m]."""
CONTENTS = {"apple": (0.95, 1.0), "toy_block": (1.5, 1.7), "wood_cube": (1.2, 1.35)}
"""Things that lie in a bowl and stick out of it, with the range of their scale. (What lies wholly inside is perceived as
the bowl's filling, not as an object.)"""


def leaning_scene(rng: np.random.Generator) -> PlacedScene:
    """A phone that leans at 45-70 degrees against a box, its foot on the table."""
    support = _at(MODELS["box"].draw(rng, id="support", colour=anything(rng)), rng, margin=0.08)
    leaner = MODELS["smartphone"].draw(rng, id="leaner", colour=anything(rng))
    tilt = float(rng.uniform(math.radians(45.0), math.radians(70.0)))
    height = support.size[2]
    length = leaner.size[0]
    rise, run = math.sin(tilt), math.cos(tilt)
    # The underside's line from the foot meets the box's upper edge, or its end meets the box's face.
    foot = height * run / rise if length * rise > height else length * run
    face = support.size[0] / 2.0
    out = rng.choice([0.0, math.pi]) + _yaw(support)
    away = np.array([math.cos(out), math.sin(out)])
    middle = np.asarray(support.position[:2]) + away * (face + CLEAR + foot - length / 2.0 * run)
    turn = quaternion_product(quaternion_about("z", out + math.pi), quaternion_about("y", -tilt))
    tilted = replace(
        leaner, position=(float(middle[0]), float(middle[1]), length / 2.0 * rise + CLEAR), quaternion=turn
    )
    return _scene("leaning", rng, (support, tilted))


def contained_scene(rng: np.random.Generator) -> PlacedScene:
    """A thing in a bowl that sticks out of it, laid down straight until it touches."""
    bowl = _at(MODELS["ceramic_bowl"].draw(rng, id="bowl", colour=anything(rng)), rng)
    name = str(rng.choice(list(CONTENTS)))
    scale = float(rng.uniform(*CONTENTS[name]))
    small = MODELS[name].draw(rng, id="content", colour=anything(rng), size_scale=scale)
    turned = replace(
        small,
        position=(*bowl.position[:2], bowl.size[2] + 0.10),
        quaternion=quaternion_about("z", float(rng.uniform(-math.pi, math.pi))),
    )
    scene = _scene("contained", rng, (bowl, turned))
    return replace(scene, objects=(bowl, lay_down(scene, "content", turned.position[2])))


def _at(thing: PlacedObject, rng: np.random.Generator, margin: float = 0.0) -> PlacedObject:
    x, y = rng.uniform(np.asarray(LOWER) + margin, np.asarray(UPPER) - margin)
    return replace(
        thing,
        position=(float(x), float(y), 0.0),
        quaternion=quaternion_about("z", float(rng.uniform(-math.pi, math.pi))),
    )


def _yaw(thing: PlacedObject) -> float:
    w, _, _, z = thing.quaternion
    return 2.0 * math.atan2(z, w)


def _scene(name: str, rng: np.random.Generator, objects: tuple[PlacedObject, ...]) -> PlacedScene:
    seed = int(rng.integers(2**31))
    return lit(PlacedScene(name=name, seed=seed, objects=objects, cameras=draw_cameras(rng)), rng)
