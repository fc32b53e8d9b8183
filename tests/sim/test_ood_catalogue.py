"""The objects outside the knowledge base: they have the sizes of the table, and each stands where it is put."""

from __future__ import annotations

import numpy as np
import pytest

from sim.catalogue import MODELS, TABLE_I
from sim.draw_scene import draw_scene
from sim.footprint import geom_points
from sim.ood_catalogue import ALL_MODELS, FAR, NEAR, STAND, group_of
from sim.scene_file import load_scene
from sim.tasks.ood import ood_groups, ood_scenes
from sim.world import World

SIZES_CM = {
    "latte_mug": (8.5, 8.5, 12), "enamel_mug": (8, 8, 8), "small_apple": (6.6, 6.6, 6.6), "pet_bottle": (6, 6, 20),
    "shampoo_bottle": (8.6, 4.5, 19), "baby_banana": (13, 3.2, 3.2), "salad_bowl": (15, 15, 7),
    "rice_bowl": (11, 11, 5.5), "puzzle_cube": (5.7, 5.7, 5.7), "duplo_brick": (6.4, 3.2, 2.4),
    "bud_vase": (6, 6, 18), "champagne_flute": (5, 5, 23), "stubby_screwdriver": (11, 3.4, 3.4),
    "compact_phone": (6.4, 13, 0.8), "foam_ball": (7, 7, 7), "thermos": (7, 7, 25), "soup_can": (6.6, 6.6, 10.1),
    "spice_jar": (5, 5, 10), "teapot": (16, 12, 13), "watering_can": (18, 9, 14), "dinner_plate": (20, 20, 2.2),
    "egg": (5.8, 4.4, 4.4), "light_bulb": (11, 6, 6), "hammer": (30, 11, 3), "kitchen_knife": (30, 3, 1.8),
    "hairbrush": (22, 7, 4), "tv_remote": (17, 4.5, 2), "paperback": (11, 2.5, 18), "clothes_peg": (7, 1, 1.2),
    "plush_toy": (7, 6, 9),
}  # fmt: skip
"""Extents by benchmark.md section 6, laid or stood as the models are; mugs without their handles."""
HANDLES_ASIDE = {"latte_mug", "enamel_mug"}
REGION_WIDTH_CM = {
    "salad_bowl": 0.6, "rice_bowl": 0.3, "bud_vase": 3.5, "champagne_flute": 1.0, "teapot": 1.5, "watering_can": 2.0,
    "dinner_plate": 0.5, "light_bulb": 2.7, "hammer": 3.0, "kitchen_knife": 2.2, "hairbrush": 2.0,
}  # fmt: skip
"""Width of the annotated region where the table gives one."""


def test_fifteen_near_and_fifteen_far_beside_the_catalogue() -> None:
    """Two groups of fifteen that share no model with the catalogue; 42 scenes with the twelve known objects."""
    assert len(NEAR) == len(FAR) == 15
    assert not (set(NEAR) | set(FAR)) & set(MODELS)
    assert {name: len(names) for name, names in ood_groups().items()} == {"in_dist": 12, "near": 15, "far": 15}
    assert len(set(ood_scenes())) == 42
    assert [group_of(name) for name in ("egg", "latte_mug", "apple", "plate_stand")] == [
        "far_ood", "near_ood", "catalogue", "setting",
    ]  # fmt: skip
    assert set(ALL_MODELS) == {*MODELS, *NEAR, *FAR, STAND.name}


def test_categories_are_known_for_the_near_and_new_for_the_far() -> None:
    """Every near one has a category of the twelve or the mug's; no far one has a category of the catalogue."""
    known = {entry.category for entry in MODELS.values()}
    assert {entry.category for entry in NEAR.values()} <= {MODELS[name].category for name in TABLE_I} | {"mug"}
    assert not {entry.category for entry in FAR.values()} & known
    assert len({entry.category for entry in FAR.values()}) == 15


@pytest.mark.parametrize("name", list(SIZES_CM))
def test_sizes_are_those_of_the_table(name: str) -> None:
    """Extents of the pieces are those of the table within 2 mm; so is the width of the annotated region, under 78 mm."""
    entry = (NEAR | FAR)[name]
    form = entry.form()
    pieces = [geom for geom in form.geoms if name not in HANDLES_ASIDE or geom.region != "handle"]
    points = np.vstack([geom_points(geom) for geom in pieces])
    assert np.ptp(points, axis=0) == pytest.approx(np.array(SIZES_CM[name]) / 100, abs=0.002)
    assert points[:, 2].min() == pytest.approx(0.0, abs=3e-4)
    part = next(part for part in form.parts if part.region == entry.affordance.region)
    assert part.width <= 0.078
    if name in REGION_WIDTH_CM:
        assert part.width == pytest.approx(REGION_WIDTH_CM[name] / 100, abs=1e-3)


@pytest.mark.parametrize("name", [name for group in ("near", "far") for name in ood_groups()[group]])
def test_each_stays_where_it_is_put(name: str) -> None:
    """Left alone for half a second nothing tips over, rolls away or starts inside something else."""
    world = World(draw_scene(load_scene(name), 10_000))
    model = name.removeprefix("ood_")
    before = world.data.body(model).xpos.copy(), world.data.body(model).xmat.copy()
    controls = np.repeat(world.data.ctrl[None], 250, axis=0)
    world.run(controls, "hold")
    assert np.linalg.norm(world.data.body(model).xpos - before[0]) < 0.002
    assert float(world.data.body(model).xmat @ before[1]) / 3 > 0.999
