"""Laws of the seeded world draws (benchmark.md section 2)."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from sim.build_model import build_model
from sim.catalogue import MODELS
from sim.draw_scene import draw_scene
from sim.footprint import gap, hull, outline, surely_apart
from sim.objects.form import quaternion_about
from sim.particles import contained
from sim.placed import PlacedScene
from sim.placement import REACH, SPAWN_LOWER, SPAWN_UPPER, TABLE_LOWER, TABLE_UPPER, beside
from sim.scene_file import builtin_scenes, load_scene
from sim.tasks.occlusion import hidden_share
from sim.tasks.random_scene import ARRANGEMENTS, random_scene
from sim.tasks.sort_by_fragility import triples


def fingerprint(placed: PlacedScene) -> str:
    """Everything about a placed scene, as text; arrays in full."""
    with np.printoptions(threshold=100_000, precision=17):
        return repr(placed)


@pytest.mark.parametrize("name", builtin_scenes())
def test_same_seed_same_world_and_other_seed_other_world(name: str) -> None:
    """A scene's world depends on its name and seed alone; another seed gives another world."""
    spec = load_scene(name)
    first = draw_scene(spec, 11)
    assert fingerprint(first) == fingerprint(draw_scene(load_scene(name), 11))
    assert fingerprint(first) != fingerprint(draw_scene(spec, 12))


@pytest.mark.parametrize("name", builtin_scenes())
def test_built_in_worlds_are_possible(name: str) -> None:
    """Objects stand on the table within reach, apart from each other, and the compiled scene has no penetration."""
    for seed in range(3):
        placed = draw_scene(load_scene(name), seed)
        build_model(placed)
        movable = [thing for thing in placed.objects if not thing.fixed]
        for index, thing in enumerate(movable):
            edge = outline(thing)
            assert (edge >= np.array(TABLE_LOWER) - 1e-3).all()
            assert (edge <= np.array(TABLE_UPPER) + 1e-3).all()
            assert math.hypot(*thing.position[:2]) <= REACH + 1e-3
            for other in movable[:index]:
                if "stacked" not in (thing.state, other.state):
                    assert gap(edge, outline(other)) > 0.015
        task = placed.task
        assert task is not None
        ids = {thing.id for thing in placed.objects}
        assert {entry.target for entry in task.required} <= ids
        if task.target is not None:
            x, y, _ = next(thing.position for thing in placed.objects if thing.id == task.target)
            assert SPAWN_LOWER[0] - 1e-3 <= x <= SPAWN_UPPER[0] + 1e-3
            assert SPAWN_LOWER[1] - 1e-3 <= y <= SPAWN_UPPER[1] + 1e-3


@pytest.mark.parametrize(
    ("name", "target", "neighbour", "low", "high"),
    [
        ("cup_near_vase", "cup", "vase", 0.04, 0.08),
        ("phone_near_wine_glass", "phone", "glass", 0.04, 0.08),
        ("ball_behind_box", "ball", "box", 0.04, 0.06),
        ("screwdriver_side_grasp", "screwdriver", "block", 0.12, 0.18),
        ("phone_between_glasses", "phone", "glass_1", 0.02, 0.02),
    ],
)
def test_neighbour_gaps(name: str, target: str, neighbour: str, low: float, high: float) -> None:
    """The free distance to the neighbour lies in the task's range, measured between outlines."""
    for seed in range(4):
        things = {thing.id: thing for thing in draw_scene(load_scene(name), seed).objects}
        free = gap(outline(things[target]), outline(things[neighbour]))
        assert low - 1e-6 <= free <= high + 1e-6


def test_ball_is_hidden_from_the_front() -> None:
    """In every draw of task IT-b the box hides at least 60 % of the ball from the front camera."""
    for seed in range(5):
        assert hidden_share(draw_scene(load_scene("ball_behind_box"), seed), "ball") >= 0.60


def test_fragility_triples_differ_by_a_fifth() -> None:
    """The nominal triple is among them, and over seeds several triples occur, each in the bin's company."""
    assert ("block", "cup", "glass") in triples()
    drawn = set()
    for seed in range(12):
        placed = draw_scene(load_scene("sort_by_fragility"), seed)
        fragilities = sorted(thing.affordance.fragility for thing in placed.objects if not thing.fixed)
        assert np.diff(fragilities).min() >= 0.2 - 1e-9
        assert placed.bin is not None
        drawn.add(tuple(sorted(thing.id for thing in placed.objects)))
    assert len(drawn) > 4


def test_repeated_categories_repeat() -> None:
    """Each draw has three objects, two of them of one category; both halves occur."""
    halves = set()
    for seed in range(8):
        things = [thing for thing in draw_scene(load_scene("repeated_categories"), seed).objects if not thing.fixed]
        categories = sorted(thing.category for thing in things)
        assert len(categories) == 3
        assert len(set(categories)) == 2
        halves.add(tuple(categories))
    assert len(halves) == 2


def test_filled_cup_is_filled_to_about_seventy_percent() -> None:
    """The balls lie inside, and their topmost layer is at 0.65 to 0.85 of the cup's height."""
    for seed in range(2):
        placed = draw_scene(load_scene("filled_cup"), seed)
        cup, group = placed.objects[0], placed.particles[0]
        assert cup.state == "filled"
        assert contained(cup, group.positions)
        level = np.sort(group.positions[:, 2])[-7:].mean() + group.radius
        assert 0.65 < level / cup.size[2] < 0.85


def test_block_rests_on_the_bowl() -> None:
    """The block stands clear of the bowl's rim, touches no table, and is marked as stacked."""
    things = {thing.id: thing for thing in draw_scene(load_scene("block_on_bowl"), 1).objects}
    block, bowl = things["block"], things["bowl"]
    assert block.state == "stacked"
    assert block.position[2] > 0.005
    assert block.position[2] + block.size[2] > bowl.size[2] + 0.01


def test_sizes_masses_and_friction_vary_within_their_ranges() -> None:
    """Over 40 draws of the apple: never above 80 mm, masses and friction within 20 % and spread over it."""
    apples = [draw_scene(load_scene("single_apple"), seed).objects[0] for seed in range(40)]
    diameters = np.array([apple.size[0] for apple in apples])
    assert diameters.max() <= 0.080
    assert diameters.min() >= 0.076 - 1e-9
    ratios = np.array([apple.mass / MODELS["apple"].mass for apple in apples])
    assert 0.8 <= ratios.min() < 0.9
    assert 1.1 < ratios.max() <= 1.2


def test_one_objects_draw_does_not_depend_on_another() -> None:
    """Leaving the last object out of a scene changes no property of the first."""
    spec = load_scene("cup_near_vase")
    alone = spec.model_copy(update={"objects": spec.objects[:1]})
    one, two = draw_scene(spec, 4).objects[0], draw_scene(alone, 4).objects[0]
    assert one.geoms == two.geoms
    assert one.friction == two.friction


def test_gap_of_squares() -> None:
    """Free distance between unit squares: along an edge, along a diagonal, and negative in overlap."""
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    assert gap(square, square + np.array([1.5, 0.2])) == pytest.approx(0.5)
    assert gap(square, square + np.array([2.0, 2.0])) == pytest.approx(math.sqrt(2))
    assert gap(square, square + np.array([0.75, 0.0])) == pytest.approx(-0.25)
    assert len(hull(np.vstack([square, [[0.5, 0.5]]]))) == 4


def test_gaps_left_out_move_nothing() -> None:
    """A place beside another thing is, bit for bit, the one that 40 measured halvings give, and boxes never say too much."""
    rng = np.random.default_rng(7)
    for seed in range(10):
        things = [thing for thing in draw_scene(load_scene("clear_table"), seed).objects if not thing.fixed]
        thing, other = (things[k] for k in rng.permutation(len(things))[:2])
        free, bearing = float(rng.uniform(0.003, 0.1)), float(rng.uniform(-math.pi, math.pi))
        fixed, moving = outline(other), outline(replace(thing, position=(0.0, 0.0, 0.0)))
        centre, direction = np.asarray(other.position[:2]), np.array([math.cos(bearing), math.sin(bearing)])
        near, far = 0.0, 1.5
        for _ in range(40):
            middle = (near + far) / 2
            at = moving + centre + middle * direction
            closer = gap(fixed, at) < free
            assert not (closer and surely_apart(fixed, at, free))
            near, far = (middle, far) if closer else (near, middle)
        x, y = (centre + far * direction).tolist()
        assert beside(thing, other, free, bearing).position[:2] == (x, y)


def test_outline_turns_with_the_object() -> None:
    """A phone turned by a right angle swaps its outline's extents."""
    phone = MODELS["smartphone"].draw(np.random.default_rng(0))
    turned = replace(phone, quaternion=quaternion_about("z", math.pi / 2))
    assert np.ptp(outline(turned), axis=0) == pytest.approx(np.ptp(outline(phone), axis=0)[::-1], abs=1e-9)


@pytest.mark.parametrize("arrangement", ARRANGEMENTS)
def test_random_scenes_are_what_they_say(arrangement: str) -> None:
    """Random scenes compile without penetration and show the asked arrangement; the same seed gives the same scene."""
    for seed in range(3):
        scene = random_scene(np.random.default_rng(seed), arrangement=arrangement)  # type: ignore[arg-type]
        build_model(scene)
        states = {thing.state for thing in scene.objects}
        assert (arrangement == "stacked") == ("stacked" in states)
        assert (arrangement == "filled") == ("filled" in states) == bool(scene.particles)
        if arrangement == "touching":
            assert gap(outline(scene.objects[0]), outline(scene.objects[1])) < 0.001
    again = random_scene(np.random.default_rng(2), arrangement=arrangement)  # type: ignore[arg-type]
    assert fingerprint(again) == fingerprint(random_scene(np.random.default_rng(2), arrangement=arrangement))  # type: ignore[arg-type]


def test_a_third_of_random_objects_is_strange() -> None:
    """About 30 % of objects in separate random scenes lie outside the catalogue and are called unknown."""
    rng = np.random.default_rng(0)
    things = [thing for _ in range(60) for thing in random_scene(rng, arrangement="separate", count=4).objects]
    strange = [thing for thing in things if thing.category == "unknown"]
    assert 0.2 < len(strange) / len(things) < 0.4
    assert all(thing.model not in MODELS for thing in strange)
