"""Facts of the catalogue's objects."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from kb.errors import BadInputError
from kb.taxonomy import CATEGORIES
from kb.vocabulary import AFFORDANCE_TYPES
from sim.build_model import build_model
from sim.catalogue import MODELS, TABLE_I, damage_threshold, model
from sim.footprint import world_points
from sim.placed import PlacedScene

TABLE_I_SIZES = {
    "ceramic_cup": (0.08, 0.08, 0.09),
    "apple": (0.08, 0.08, 0.08),
    "plastic_bottle": (0.07, 0.07, 0.22),
    "ceramic_bowl": (0.12, 0.12, 0.06),
    "wood_cube": (0.05, 0.05, 0.05),
    "glass_vase": (0.08, 0.08, 0.15),
    "wine_glass": (0.07, 0.07, 0.20),
    "screwdriver": (0.20, 0.03, 0.03),
    "smartphone": (0.07, 0.15, 0.01),
    "tennis_ball": (0.065, 0.065, 0.065),
    "toy_block": (0.04, 0.04, 0.04),
}
MOVABLE = [name for name, entry in MODELS.items() if not entry.fixed]


@pytest.mark.parametrize("name", list(TABLE_I_SIZES))
def test_sizes_are_those_of_table_i(name: str) -> None:
    """Extents at scale 1 are Table I's to 2 mm (a cup's without its handle)."""
    thing = model(name).draw(np.random.default_rng(0), size_scale=1.0)
    points = world_points(replace(thing, geoms=tuple(geom for geom in thing.geoms if geom.region != "handle")))
    if name == "screwdriver":
        points = world_points(replace(thing, position=(0.0, 0.0, 0.0)))
    assert np.ptp(points, axis=0) == pytest.approx(TABLE_I_SIZES[name], abs=0.002)


@pytest.mark.parametrize("name", list(MODELS))
def test_frame_is_at_the_footprint_and_size_is_true(name: str) -> None:
    """The lowest point is z = 0 and the stated size is the extent of the pieces to 3 mm."""
    thing = model(name).draw(np.random.default_rng(1), position=(0.0, 0.0, 0.0))
    points = world_points(thing)
    assert points[:, 2].min() == pytest.approx(0.0, abs=5e-4)
    assert np.ptp(points, axis=0) == pytest.approx(thing.size, abs=0.003)


@pytest.mark.parametrize("name", MOVABLE)
def test_objects_stand_still(name: str) -> None:
    """Left alone on the table for a second, every object stays within 1 mm and 1 degree."""
    thing = model(name).draw(np.random.default_rng(2), position=(0.5, 0.0, 1e-5))
    compiled = build_model(PlacedScene(name="alone", seed=0, objects=(thing,)))
    data = mujoco.MjData(compiled)
    compiled.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_ACTUATION)
    address = int(compiled.jnt_qposadr[compiled.body_jntadr[compiled.body(thing.id).id]])
    before = data.qpos[address : address + 7].copy()
    mujoco.mj_step(compiled, data, 500)
    after = data.qpos[address : address + 7]
    assert np.abs(after[:3] - before[:3]).max() < 1e-3
    assert 2 * np.arccos(min(1.0, abs(float(before[3:] @ after[3:])))) < np.radians(1.0)


def test_masses_and_friction_lie_in_their_ranges() -> None:
    """Over 200 draws mass stays within 20 % of nominal, and the pieces' masses sum to it."""
    rng = np.random.default_rng(3)
    for name in TABLE_I:
        for _ in range(20):
            thing = model(name).draw(rng)
            assert 0.8 <= thing.mass / MODELS[name].mass <= 1.2
            assert sum(geom.mass for geom in thing.geoms) == pytest.approx(thing.mass)


def test_what_is_grasped_fits_the_hand() -> None:
    """No draw makes an apple, a cup's or a vase's graspable part, or a phone wider than 80 mm (ledger G35)."""
    rng = np.random.default_rng(4)
    for name in MOVABLE:
        if name in ("box", "ceramic_bowl"):
            continue
        for _ in range(30):
            thing = model(name).draw(rng)
            region = thing.affordance.region
            assert min(part.width for part in thing.parts if part.region == region) <= 0.080 + 1e-9


def test_seven_of_eight_affordance_types_in_table_i_and_all_in_the_catalogue() -> None:
    """Table I covers every affordance type but PINCHABLE; pen and key add it."""
    paper = {MODELS[name].affordance.type for name in TABLE_I}
    assert set(AFFORDANCE_TYPES) - paper == {"PINCHABLE"}
    assert {entry.affordance.type for entry in MODELS.values()} == set(AFFORDANCE_TYPES)


def test_categories_are_those_the_knowledge_base_knows() -> None:
    """Every catalogue category is in the taxonomy's list."""
    assert {entry.category for entry in MODELS.values()} <= set(CATEGORIES)


def test_damage_threshold_formula() -> None:
    """F_dmg = max(5, 70 (1 - frag)): 7 N for a wine glass, 49 N for a cup, never below 5 N."""
    assert damage_threshold(0.9) == pytest.approx(7.0)
    assert damage_threshold(0.3) == pytest.approx(49.0)
    assert damage_threshold(1.0) == 5.0


def test_colour_does_not_give_the_category_away() -> None:
    """Anything-coloured categories cover the hue circle: over 60 cups the mean colours spread widely."""
    rng = np.random.default_rng(5)
    colours = np.array([model("ceramic_cup").draw(rng).geoms[0].rgba[:3] for _ in range(60)])
    assert colours.std(axis=0).min() > 0.15


def test_handle_loop_is_open() -> None:
    """A ray through the middle of the cup's handle loop meets nothing: the handle is a true loop."""
    thing = model("ceramic_cup").draw(np.random.default_rng(6), size_scale=1.0, position=(0.5, 0.0, 0.0))
    compiled = build_model(PlacedScene(name="cup", seed=0, objects=(thing,)))
    data = mujoco.MjData(compiled)
    mujoco.mj_kinematics(compiled, data)
    geom = np.zeros(1, np.int32)
    distance = mujoco.mj_ray(
        compiled, data, np.array([0.5475, -0.2, 0.0475]), np.array([0.0, 1.0, 0.0]), None, 1, -1, geom
    )
    assert distance < 0 or distance > 0.4


def test_unknown_model_names_the_choices() -> None:
    """An unknown model is refused with the catalogue's names."""
    with pytest.raises(BadInputError, match="ceramic_cup"):
        model("teapot")
