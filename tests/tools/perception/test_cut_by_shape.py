"""Laws of cutting things of one colour apart by their shapes."""

from __future__ import annotations

import numpy as np
import pytest

from bench.relation_scenes import contained_scene, leaning_scene
from kb.percept import Percept
from sim.placed import PlacedScene
from sim.tasks.random_scene import random_scene
from sim.world import World
from tools.perceive import PerceiveArgs
from tools.perception.neck import heights_of_steps, necks
from tools.perception.rgbd_perceiver import RgbdPerceiver
from tools.perception.tilted_slab import tilted_slab


def _percept(scene: PlacedScene, seed: int) -> Percept:
    views = World(scene, settle=False).capture(np.random.default_rng([seed, 1]))
    return RgbdPerceiver(None).perceive(views, PerceiveArgs())


def _face(rng: np.random.Generator, count: int, sides: tuple[float, float]) -> np.ndarray:
    """Points (N, 3) on a level rectangle around the origin [m], with 0.5 mm noise."""
    flat = (rng.random((count, 2)) - 0.5) * np.array(sides)
    return np.column_stack([flat, rng.normal(0.0, 0.0005, count)])


@pytest.mark.parametrize("degrees", [45.0, 55.0, 70.0])
def test_a_tilted_slab_is_found_in_front_of_a_box(degrees: float) -> None:
    """Of a phone's face before a box's top, at least 95 % of the face and at most 5 % of the box are its part."""
    rng = np.random.default_rng(1)
    angle = np.radians(degrees)
    turn = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    face = _face(rng, 4000, (0.075, 0.15)) @ turn.T
    face[:, 2] += 0.005 - face[:, 2].min()
    top = _face(rng, 4000, (0.11, 0.13)) + np.array([-0.11, 0.0, 0.10])
    slab = tilted_slab(np.concatenate([face, top]))
    assert slab is not None
    assert slab.part[:4000].mean() > 0.95
    assert slab.part[4000:].mean() < 0.05
    assert np.degrees(np.arccos(slab.normal[2])) == pytest.approx(degrees, abs=3.0)


def test_what_lies_flat_or_stands_upright_is_no_tilted_slab() -> None:
    """The top and a side of a box hold no inclined face."""
    rng = np.random.default_rng(2)
    top = _face(rng, 3000, (0.12, 0.16)) + np.array([0.0, 0.0, 0.1])
    side = _face(rng, 3000, (0.1, 0.16))[:, [2, 1, 0]] + np.array([0.06, 0.0, 0.05])
    assert tilted_slab(np.concatenate([top, side])) is None


def test_two_discs_have_a_neck_and_one_has_none() -> None:
    """The narrowest cut through two touching discs tells them apart; a single disc has no neck."""
    rng = np.random.default_rng(3)
    disc = rng.normal(size=(3000, 3))
    disc = 0.04 * disc / np.linalg.norm(disc[:, :2], axis=1)[:, None] * np.sqrt(rng.random((3000, 1)))
    pair = np.concatenate([disc, disc + np.array([0.078, 0.0, 0.0])])
    side = necks(pair)[0]
    assert abs(side[:3000].mean() - side[3000:].mean()) > 0.97
    assert necks(disc) == []


def test_a_step_of_the_reach_is_found() -> None:
    """A narrow cylinder on a wide one steps at the height where it stands."""
    z = np.linspace(0.002, 0.098, 6000)
    around = np.linspace(0.0, 500.0, 6000)
    radius = np.where(z < 0.04, 0.05, 0.02)
    xyz = np.column_stack([radius * np.cos(around), radius * np.sin(around), z])
    assert heights_of_steps(xyz)[0] == pytest.approx(0.04, abs=0.004)


@pytest.mark.parametrize("seed", [12002, 11043, 11078])
def test_a_phone_that_leans_on_a_box_of_its_colour_is_an_object(seed: int) -> None:
    """Both are seen, the box as a box."""
    percept = _percept(leaning_scene(np.random.default_rng(seed)), seed)
    assert len(percept.objects) == 2
    assert "box" in [thing.category for thing in percept.objects]


@pytest.mark.parametrize("seed", [12136, 11058, 13088])
def test_what_sticks_out_of_a_bowl_of_its_colour_is_an_object(seed: int) -> None:
    """The bowl and its content are two."""
    percept = _percept(contained_scene(np.random.default_rng(seed)), seed)
    assert len(percept.objects) == 2
    assert "bowl" in [thing.category for thing in percept.objects]


def test_two_known_things_of_one_colour_that_touch_are_two() -> None:
    """A mug and a ball at its side are told apart at the neck between them."""
    percept = _percept(random_scene(np.random.default_rng(11180), arrangement="touching", free_colours=False), 11180)
    assert sorted(thing.category for thing in percept.objects).count("mug") == 2
    assert "tennis_ball" in [thing.category for thing in percept.objects]


@pytest.mark.parametrize("seed", [16004, 16025])
def test_a_phone_that_hides_what_it_lies_on_is_carried_by_something(seed: int) -> None:
    """Of the cube below, of the phone's colour, hardly anything shows: still there are two things, one on the other."""
    scene = random_scene(np.random.default_rng(seed), arrangement="stacked", free_colours=False)
    percept = _percept(scene, seed)
    assert len(percept.objects) == len(scene.objects)


@pytest.mark.parametrize("seed", [16007, 16105])
def test_a_block_hides_the_wall_of_the_bowl_that_it_sticks_out_of(seed: int) -> None:
    """The bowl is seen as a bowl though its content of the same colour hides part of its wall."""
    percept = _percept(contained_scene(np.random.default_rng(seed)), seed)
    assert sorted(thing.category == "bowl" for thing in percept.objects) == [False, True]
