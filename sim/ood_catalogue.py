"""Objects that nothing was tuned or learnt on: 15 new instances of known categories, 15 of new ones (benchmark.md section 6).

They are kept apart from `sim.catalogue`: reference views, random scenes and the knowledge base are made from that one
alone, and a test holds that none of these gets into them.
"""

from __future__ import annotations

from kb.affordance import AffordanceDescriptor
from kb.errors import BadInputError
from kb.vocabulary import AffordanceType, Material, Region
from sim.catalogue import MODELS, ObjectModel
from sim.objects import colours
from sim.objects.colours import Palette, among, anything
from sim.objects.form import Shape
from sim.objects.ood import far_things, far_vessels, near

WHITE = among((0.92, 0.92, 0.90), (0.90, 0.86, 0.78))
SHELL = among((0.82, 0.62, 0.45), (0.93, 0.90, 0.85))
BRUSHED = among((0.62, 0.63, 0.66), (0.20, 0.30, 0.45), (0.55, 0.12, 0.12))
DARK = among((0.07, 0.07, 0.08), (0.25, 0.25, 0.27))
MILK_GLASS = among((0.93, 0.92, 0.88), (0.96, 0.90, 0.75))
SPICES = among((0.70, 0.40, 0.15), (0.50, 0.18, 0.10), (0.45, 0.50, 0.25), alpha=0.45)


def _new(
    name: str,
    category: str,
    affordance: tuple[AffordanceType, Material, float, Region],
    mass: float,
    shape: Shape,
    palette: Palette = anything,
    *,
    largest: float = 1.05,
    transparent: float = 0.0,
    soft: bool = False,
    fixed: bool = False,
) -> ObjectModel:
    kind, material, fragility, region = affordance
    descriptor = AffordanceDescriptor(type=kind, material=material, fragility=fragility, region=region)
    return ObjectModel(
        name,
        category,
        descriptor,
        mass,
        shape,
        palette,
        largest=largest,
        transparent=transparent,
        soft=soft,
        fixed=fixed,
    )


_NEAR = (
    _new("latte_mug", "mug", ("GRASPABLE_HANDLE", "ceramic", 0.30, "handle"), 0.36, near.latte_mug),
    _new("enamel_mug", "mug", ("GRASPABLE_HANDLE", "metal", 0.10, "handle"), 0.15, near.enamel_mug, largest=1.0),
    _new(
        "small_apple", "apple", ("WRAPPABLE", "organic", 0.10, "body"), 0.13, near.small_apple, colours.APPLE, soft=True
    ),
    _new(
        "pet_bottle", "bottle", ("GRASPABLE_BODY", "plastic", 0.10, "body"), 0.25, near.pet_bottle,
        transparent=0.5, soft=True,
    ),
    _new("shampoo_bottle", "bottle", ("GRASPABLE_BODY", "plastic", 0.10, "body"), 0.30, near.shampoo_bottle),
    _new(
        "baby_banana", "banana", ("WRAPPABLE", "organic", 0.25, "body"), 0.06, near.baby_banana, colours.BANANA,
        soft=True,
    ),
    _new("salad_bowl", "bowl", ("GRASPABLE_EDGE", "wood", 0.10, "rim"), 0.32, near.salad_bowl, colours.WOOD),
    _new("rice_bowl", "bowl", ("GRASPABLE_EDGE", "ceramic", 0.40, "rim"), 0.20, near.rice_bowl),
    _new("puzzle_cube", "cube", ("GRASPABLE_BODY", "plastic", 0.05, "body"), 0.09, near.puzzle_cube),
    _new("duplo_brick", "block", ("GRASPABLE_BODY", "plastic", 0.0, "body"), 0.025, near.duplo_brick),
    _new(
        "bud_vase", "vase", ("FRAGILE", "glass", 0.80, "neck"), 0.28, near.bud_vase, colours.GLASS, transparent=1.0
    ),
    _new(
        "champagne_flute", "wine_glass", ("FRAGILE", "glass", 0.95, "stem"), 0.11, near.champagne_flute,
        colours.CLEAR_GLASS, transparent=1.0,
    ),
    _new(
        "stubby_screwdriver", "screwdriver", ("TOOL_HANDLE", "metal", 0.0, "handle"), 0.09, near.stubby_screwdriver
    ),
    _new(
        "compact_phone", "smartphone", ("CLAMPABLE", "mixed", 0.50, "edge"), 0.15, near.compact_phone, colours.PHONE
    ),
    _new("foam_ball", "tennis_ball", ("WRAPPABLE", "foam", 0.05, "body"), 0.012, near.foam_ball, soft=True),
)  # fmt: skip
_FAR = (
    _new("thermos", "thermos", ("GRASPABLE_BODY", "metal", 0.10, "body"), 0.42, far_vessels.thermos, BRUSHED),
    _new("soup_can", "can", ("GRASPABLE_BODY", "metal", 0.05, "body"), 0.40, far_vessels.soup_can),
    _new(
        "spice_jar", "jar", ("GRASPABLE_BODY", "glass", 0.55, "body"), 0.16, far_vessels.spice_jar, SPICES,
        transparent=1.0,
    ),
    _new("teapot", "teapot", ("GRASPABLE_HANDLE", "ceramic", 0.50, "handle"), 0.38, far_vessels.teapot),
    _new(
        "watering_can", "watering_can", ("GRASPABLE_HANDLE", "plastic", 0.10, "handle"), 0.16, far_vessels.watering_can
    ),
    _new("dinner_plate", "plate", ("GRASPABLE_EDGE", "ceramic", 0.40, "rim"), 0.30, far_vessels.dinner_plate, WHITE),
    _new("egg", "egg", ("WRAPPABLE", "organic", 0.85, "body"), 0.058, far_things.egg, SHELL, soft=True),
    _new("light_bulb", "bulb", ("FRAGILE", "glass", 0.90, "neck"), 0.035, far_things.light_bulb, MILK_GLASS),
    _new("hammer", "hammer", ("TOOL_HANDLE", "wood", 0.0, "handle"), 0.42, far_things.hammer, colours.WOOD),
    _new("kitchen_knife", "knife", ("TOOL_HANDLE", "metal", 0.10, "handle"), 0.13, far_things.kitchen_knife, DARK),
    _new("hairbrush", "brush", ("TOOL_HANDLE", "plastic", 0.05, "handle"), 0.08, far_things.hairbrush),
    _new("tv_remote", "remote", ("CLAMPABLE", "plastic", 0.20, "edge"), 0.11, far_things.tv_remote, DARK),
    _new("paperback", "book", ("CLAMPABLE", "paper", 0.15, "edge"), 0.22, far_things.paperback),
    _new("clothes_peg", "peg", ("PINCHABLE", "wood", 0.0, "body"), 0.008, far_things.clothes_peg, colours.WOOD),
    _new("plush_toy", "plush", ("WRAPPABLE", "fabric", 0.0, "body"), 0.05, far_things.plush_toy, soft=True),
)  # fmt: skip

NEAR: dict[str, ObjectModel] = {entry.name: entry for entry in _NEAR}
"""New instances of categories that the knowledge base has."""
FAR: dict[str, ObjectModel] = {entry.name: entry for entry in _FAR}
"""Instances of categories that neither the knowledge base nor the benchmark has."""
STAND = _new(
    "plate_stand",
    "stand",
    ("GRASPABLE_BODY", "wood", 0.0, "body"),
    0.25,
    far_vessels.plate_stand,
    colours.WOOD,
    fixed=True,
)
"""What the dinner plate lies on: fixed to the table, and no object of the benchmark."""
ALL_MODELS: dict[str, ObjectModel] = {**MODELS, **NEAR, **FAR, STAND.name: STAND}
"""Everything that a scene file may name."""


def any_model(name: str) -> ObjectModel:
    """The model `name`, known or new.

    Raises:
        BadInputError: if there is none.
    """
    if name not in ALL_MODELS:
        raise BadInputError(f"there is no object model {name!r}", choices=ALL_MODELS)
    return ALL_MODELS[name]


def group_of(name: str) -> str:
    """Where a model belongs: "catalogue", "near_ood", "far_ood" or "setting"."""
    if name in NEAR:
        return "near_ood"
    if name in FAR:
        return "far_ood"
    return "catalogue" if name in MODELS else "setting"
