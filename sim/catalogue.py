"""The objects that exist: shape, material facts and how an instance is drawn (Table I; benchmark.md sections 1 and 2).

Truth of the world: perception, memory and the agent must not import it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kb.affordance import AffordanceDescriptor
from kb.errors import BadInputError
from kb.vocabulary import AffordanceType, Material, ObjectState, Region
from sim.objects import bin as bin_shape
from sim.objects import colours, drinkware, solids, tableware, tools
from sim.objects.colours import Palette
from sim.objects.form import Colour, Form, Shape
from sim.placed import PlacedObject

FRICTION: dict[Material, float] = {
    "ceramic": 0.5,
    "glass": 0.4,
    "plastic": 0.5,
    "wood": 0.6,
    "metal": 0.4,
    "organic": 0.6,
    "fabric": 0.8,
    "mixed": 0.5,
    "foam": 0.8,
    "paper": 0.5,
}
"""Sliding friction by material (benchmark.md section 1; foam as fabric and paper as plastic are ours)."""
SPREAD = 0.2
"""Half-width of the uniform factors on mass and friction (benchmark.md section 1)."""
SIZE_SPREAD = 0.05
"""Half-width of the uniform factor on size (benchmark.md section 2)."""
CLEAR_ALPHA = 0.45
"""Opacity of a see-through plastic bottle."""


@dataclass(frozen=True)
class ObjectModel:
    """One catalogue entry."""

    name: str
    category: str
    affordance: AffordanceDescriptor
    mass: float
    """Nominal mass [kg]."""
    shape: Shape
    palette: Palette = colours.anything
    second: Palette | None = None
    """Palette of the second colour; the main one if None."""
    largest: float = 1.0 + SIZE_SPREAD
    """Largest scale for which the dimension to be grasped stays within 80 mm (ledger G35)."""
    transparent: float = 0.0
    """Probability that an instance is transparent."""
    soft: bool = False
    """Round or compliant (see `PlacedObject.soft`)."""
    fixed: bool = False

    def draw(
        self,
        rng: np.random.Generator,
        *,
        id: str | None = None,
        size_scale: float | None = None,
        mass: float | None = None,
        friction: float | None = None,
        colour: Colour | None = None,
        fragility: float | None = None,
        category: str | None = None,
        position: tuple[float, float, float] = (0.5, 0.0, 0.0),
        quaternion: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0),
        state: ObjectState = "empty",
    ) -> PlacedObject:
        """An instance: what is given is taken, the rest is drawn. The same number of draws is made in every case.

        Args:
            rng: Source of all draws.
            id: Scene id; the model's name if None.
            size_scale: Factor on all dimensions; drawn within +-5 % (and the gripper's 80 mm) if None.
            mass: Mass [kg]; nominal x U(0.8, 1.2) if None.
            friction: Sliding friction coefficient; the material's x U(0.8, 1.2) if None.
            colour: Main colour.
            fragility: Overrides the model's.
            category: Overrides the model's.
            position: World position of the object frame [m].
            quaternion: World orientation (w, x, y, z).
            state: Physical state.
        """
        drawn_scale = float(rng.uniform(1 - SIZE_SPREAD, min(1 + SIZE_SPREAD, self.largest)))
        drawn_mass = self.mass * float(rng.uniform(1 - SPREAD, 1 + SPREAD))
        drawn_friction = FRICTION[self.affordance.material] * float(rng.uniform(1 - SPREAD, 1 + SPREAD))
        damage_factor = float(rng.uniform(0.8, 1.25))
        main, second = self.palette(rng), (self.second or self.palette)(rng)
        clear = bool(rng.random() < self.transparent)
        if colour is not None:
            main = colour
        if clear:
            main = (*main[:3], min(main[3], CLEAR_ALPHA))
        scale = drawn_scale if size_scale is None else size_scale
        affordance = self.affordance
        if fragility is not None:
            affordance = affordance.model_copy(update={"fragility": fragility})
        form = self.form(scale, main, second)
        total = sum(geom.mass for geom in form.geoms)
        weight = drawn_mass if mass is None else mass
        return PlacedObject(
            id=self.name if id is None else id,
            model=self.name,
            category=self.category if category is None else category,
            affordance=affordance,
            geoms=tuple(replace(geom, mass=geom.mass / total * weight) for geom in form.geoms),
            position=position,
            quaternion=quaternion,
            size=form.size,
            mass=weight,
            friction=drawn_friction if friction is None else friction,
            damage_force=damage_threshold(affordance.fragility) * damage_factor,
            state=state,
            transparent=clear,
            soft=self.soft,
            parts=form.parts,
            fixed=self.fixed,
            cavity=form.cavity,
        )

    def form(self, scale: float = 1.0, *palette: Colour) -> Form:
        """The shape at a scale, in the given colours (grey if there are none)."""
        given = iter(palette or ((0.5, 0.5, 0.5, 1.0),) * 2)
        return self.shape(scale, lambda: next(given))


def damage_threshold(fragility: float) -> float:
    """Nominal F_dmg [N]: max(5, 70 (1 - frag)) (benchmark.md section 1)."""
    return max(5.0, 70.0 * (1.0 - fragility))


def model(name: str) -> ObjectModel:
    """The catalogue's entry `name`.

    Raises:
        BadInputError: if there is none.
    """
    if name not in MODELS:
        raise BadInputError(f"there is no object model {name!r}", choices=MODELS)
    return MODELS[name]


def _affords(kind: AffordanceType, material: Material, fragility: float, region: Region) -> AffordanceDescriptor:
    return AffordanceDescriptor(type=kind, material=material, fragility=fragility, region=region)


_ENTRIES = (
    ObjectModel(
        "ceramic_cup", "cup", _affords("GRASPABLE_HANDLE", "ceramic", 0.3, "handle"), 0.30, drinkware.cup, largest=1.0
    ),
    ObjectModel(
        "mug", "mug", _affords("GRASPABLE_HANDLE", "ceramic", 0.3, "handle"), 0.33, drinkware.mug, largest=1.025
    ),
    ObjectModel(
        "apple",
        "apple",
        _affords("WRAPPABLE", "organic", 0.1, "body"),
        0.18,
        solids.apple,
        colours.APPLE,
        largest=1.0,
        soft=True,
    ),
    ObjectModel(
        "plastic_bottle",
        "bottle",
        _affords("GRASPABLE_BODY", "plastic", 0.1, "body"),
        0.35,
        tableware.bottle,
        transparent=0.5,
        soft=True,
    ),
    ObjectModel(
        "banana",
        "banana",
        _affords("WRAPPABLE", "organic", 0.2, "body"),
        0.12,
        solids.banana,
        colours.BANANA,
        soft=True,
    ),
    ObjectModel("ceramic_bowl", "bowl", _affords("GRASPABLE_EDGE", "ceramic", 0.3, "rim"), 0.35, tableware.bowl),
    ObjectModel(
        "wood_cube", "cube", _affords("GRASPABLE_BODY", "wood", 0.0, "body"), 0.09, solids.wood_cube, colours.WOOD
    ),
    ObjectModel(
        "glass_vase",
        "vase",
        _affords("FRAGILE", "glass", 0.8, "neck"),
        0.50,
        tableware.vase,
        colours.GLASS,
        transparent=1.0,
    ),
    ObjectModel(
        "wine_glass",
        "wine_glass",
        _affords("FRAGILE", "glass", 0.9, "stem"),
        0.15,
        tableware.wine_glass,
        colours.CLEAR_GLASS,
        transparent=1.0,
    ),
    ObjectModel("screwdriver", "screwdriver", _affords("TOOL_HANDLE", "metal", 0.0, "handle"), 0.15, tools.screwdriver),
    ObjectModel(
        "smartphone",
        "smartphone",
        _affords("CLAMPABLE", "mixed", 0.5, "edge"),
        0.19,
        solids.smartphone,
        colours.PHONE,
    ),
    ObjectModel(
        "tennis_ball",
        "tennis_ball",
        _affords("WRAPPABLE", "fabric", 0.0, "body"),
        0.058,
        solids.tennis_ball,
        colours.TENNIS,
        soft=True,
    ),
    ObjectModel("toy_block", "block", _affords("GRASPABLE_BODY", "plastic", 0.0, "body"), 0.04, solids.toy_block),
    ObjectModel("box", "box", _affords("GRASPABLE_BODY", "plastic", 0.0, "body"), 0.25, solids.carton),
    ObjectModel(
        "bin", "bin", _affords("GRASPABLE_EDGE", "plastic", 0.0, "rim"), 5.0, bin_shape.standing_bin, fixed=True
    ),
    ObjectModel("pen", "pen", _affords("PINCHABLE", "plastic", 0.0, "body"), 0.02, tools.pen),
    ObjectModel("key", "key", _affords("PINCHABLE", "metal", 0.0, "body"), 0.03, tools.key, colours.METAL),
)

MODELS: dict[str, ObjectModel] = {entry.name: entry for entry in _ENTRIES}
"""By the names that scene files use."""
TABLE_I = (
    "ceramic_cup",
    "apple",
    "plastic_bottle",
    "banana",
    "ceramic_bowl",
    "wood_cube",
    "glass_vase",
    "wine_glass",
    "screwdriver",
    "smartphone",
    "tennis_ball",
    "toy_block",
)
"""The paper's twelve objects (Table I)."""
