"""Things that stand in a ring, in a bowl, or under something."""

from __future__ import annotations

import numpy as np

from bench.relation_scenes import contained_scene, leaning_scene
from sim.placed import PlacedScene
from sim.world import World
from tools.perceive import PerceiveArgs
from tools.perception import RgbdPerceiver
from tools.scene_relations.solid import Piece, Solid
from tools.scene_relations.support import is_inside


def _found(scene: PlacedScene) -> int:
    views = World(scene, settle=False).capture(np.random.default_rng(1))
    return len(RgbdPerceiver().perceive(views, PerceiveArgs()).objects)


def test_an_apple_in_a_bowl_and_a_leaning_phone_are_things_of_their_own() -> None:
    """Two differently coloured things stay two although the pair looks like one known thing, or one seems to hang."""
    assert _found(contained_scene(np.random.default_rng(12010))) == 2
    assert _found(leaning_scene(np.random.default_rng(12079))) == 2


def test_what_stands_on_the_same_ground_as_what_surrounds_it_is_not_inside() -> None:
    """A block in a ring stands on the table; a block on a bowl's floor is inside."""
    scene = contained_scene(np.random.default_rng(12010))
    views = World(scene, settle=False).capture(np.random.default_rng(1))
    bowl = max(RgbdPerceiver().perceive(views, PerceiveArgs()).objects, key=lambda obj: obj.size[0])
    outer = Solid((Piece((0.0, 0.0), (0.0, 0.0), 0.0, 0.06, 0.0, 0.06),))
    for low, inside in ((0.0, False), (0.006, True)):
        inner = Solid((Piece((0.0, 0.0), (0.02, 0.02), 0.0, 0.0, low, low + 0.04),))
        assert is_inside(inner, outer, bowl) is inside
