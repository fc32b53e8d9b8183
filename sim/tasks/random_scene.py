"""Random scenes with their truth, for measuring perception: catalogue objects and strange ones, in four arrangements."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Literal, get_args

import numpy as np

from kb.affordance import AffordanceDescriptor
from kb.errors import BadInputError
from kb.vocabulary import UNKNOWN_CATEGORY
from sim.cameras import draw_cameras
from sim.catalogue import MODELS, damage_threshold
from sim.draw_scene import lit
from sim.footprint import gap, outline
from sim.objects.colours import anything
from sim.objects.form import Colour, quaternion_about
from sim.objects.strange import FLAT_TOPPED, STRANGE
from sim.particles import contained, fill
from sim.placed import PlacedObject, PlacedScene
from sim.placement import REACH, RESTING, SPAWN_LOWER, SPAWN_UPPER, TABLE_LOWER, TABLE_UPPER, beside
from sim.settle import lay_down, settle

Arrangement = Literal["separate", "touching", "stacked", "filled"]
ARRANGEMENTS: tuple[Arrangement, ...] = get_args(Arrangement)
STRANGE_SHARE = 0.30
"""Share of objects outside the catalogue."""
APART = 0.03
"""Free distance between objects that are separate [m]."""
TOUCHING = 5e-4
"""Free distance between objects that touch [m]: no depth camera sees it."""
CONTAINERS = ("ceramic_cup", "mug", "ceramic_bowl")
BASES = ("box", "wood_cube", "toy_block", "smartphone")
ON_TOP = ("toy_block", "wood_cube", "ceramic_cup", "key", "smartphone", "plastic_bottle")
"""Models that stay where they are laid."""
TRIES = 200


def random_scene(
    rng: np.random.Generator,
    *,
    arrangement: Arrangement | None = None,
    count: int | None = None,
    free_colours: bool = True,
    noise: float = 1.0,
) -> PlacedScene:
    """A scene with one to five objects.

    Args:
        rng: Source of every draw.
        arrangement: How they stand; drawn evenly if None. "touching", "stacked" and "filled" concern the first objects,
            further ones stand apart.
        count: Number of objects; drawn from 1 to 5 if None (at least 2 where two take part).
        free_colours: Colours of any kind; else those of the category.
        noise: Scale of the camera noise.

    Raises:
        BadInputError: the arrangement is unknown.
    """
    if arrangement is not None and arrangement not in ARRANGEMENTS:
        raise BadInputError(f"there is no arrangement {arrangement!r}", choices=ARRANGEMENTS)
    how: Arrangement = ARRANGEMENTS[int(rng.integers(4))] if arrangement is None else arrangement
    least = 2 if how in ("touching", "stacked") else 1
    number = int(rng.integers(least, 6)) if count is None else max(count, least)
    while True:
        scene = _draw(rng, how, number, free_colours)
        if scene is not None:
            return replace(scene, noise=noise)


def _draw(rng: np.random.Generator, how: Arrangement, number: int, free_colours: bool) -> PlacedScene | None:
    """One draw; None where it does not fit the table or does not rest."""
    things: list[PlacedObject] = []
    for index in range(number):
        thing = _instance(rng, how, index, free_colours)
        placed = _place(rng, thing, things, how, index)
        if placed is None:
            return None
        things.append(placed)
    seed = int(rng.integers(2**31))
    scene = PlacedScene(name=f"random_{how}", seed=seed, objects=tuple(things), cameras=draw_cameras(rng))
    scene = lit(scene, rng)
    if how == "stacked":
        lowered = lay_down(scene, things[1].id, things[1].position[2])
        scene = replace(scene, objects=(things[0], lowered, *things[2:]))
    if how == "filled":
        scene = replace(scene, particles=(fill(things[0], rng),))
    return _settled(scene) if how in ("stacked", "filled") else scene


def _settled(scene: PlacedScene) -> PlacedScene | None:
    """The scene at rest, or None if a thing fell, or if contents were lost."""
    rested, rests = settle(scene)
    for before, after in zip(scene.objects, rested.objects, strict=True):
        if abs(after.position[2] - before.position[2]) > 0.01 or math.dist(before.position, after.position) > 0.02:
            return None
    for group in rested.particles:
        container = next(thing for thing in rested.objects if thing.id == group.container)
        if not contained(container, group.positions):
            return None
    return rested if rests else None


def _instance(rng: np.random.Generator, how: Arrangement, index: int, free_colours: bool) -> PlacedObject:
    """An object at the origin: its kind depends on the part it plays."""
    colour = anything(rng) if free_colours else None
    names = [name for name in MODELS if name not in ("bin", "box")]
    if how == "filled" and index == 0:
        names = list(CONTAINERS)
    elif how == "stacked" and index < 2:
        names = list((BASES, ON_TOP)[index])
    odd = rng.random() < STRANGE_SHARE and not (how == "filled" and index == 0)
    state = "filled" if how == "filled" and index == 0 else "stacked" if how == "stacked" and index == 1 else "empty"
    if odd:
        kinds = list(FLAT_TOPPED) if how == "stacked" and index == 0 else list(STRANGE)
        drawn = _strange(rng, str(rng.choice(kinds)), colour or anything(rng))
        return replace(drawn, id=f"thing_{index}", state=state)
    model = MODELS[str(rng.choice(names))]
    if colour is not None and model.transparent == 1.0:
        colour = (*colour[:3], 0.45)
    return model.draw(rng, id=f"thing_{index}", colour=colour, state=state)


def _strange(rng: np.random.Generator, kind: str, colour: Colour) -> PlacedObject:
    form = STRANGE[kind](rng, colour)
    affordance = AffordanceDescriptor(type="GRASPABLE_BODY", material="mixed", fragility=0.3, region="body")
    mass = float(rng.uniform(0.05, 0.3))
    volume = sum(geom.mass for geom in form.geoms)
    return PlacedObject(
        id=kind,
        model=kind,
        category=UNKNOWN_CATEGORY,
        affordance=affordance,
        geoms=tuple(replace(geom, mass=geom.mass / volume * mass) for geom in form.geoms),
        position=(0.0, 0.0, 0.0),
        quaternion=(1.0, 0.0, 0.0, 0.0),
        size=form.size,
        mass=mass,
        friction=float(rng.uniform(0.4, 0.6)),
        damage_force=damage_threshold(0.3),
        parts=form.parts,
    )


def _place(
    rng: np.random.Generator, thing: PlacedObject, others: list[PlacedObject], how: Arrangement, index: int
) -> PlacedObject | None:
    """The object at a free place on the table, or against or above the first one; None if none is found."""
    for _ in range(TRIES):
        turned = replace(thing, quaternion=quaternion_about("z", float(rng.uniform(-math.pi, math.pi))))
        if how == "stacked" and index == 1:
            base = others[0]
            return replace(turned, position=(*base.position[:2], base.position[2] + base.size[2] + 0.05))
        if how == "touching" and index == 1:
            put = beside(turned, others[0], TOUCHING, float(rng.uniform(-math.pi, math.pi)))
            apart = others[1:]
        else:
            x, y = rng.uniform(SPAWN_LOWER, SPAWN_UPPER)
            put, apart = replace(turned, position=(float(x), float(y), RESTING)), others
        edge = outline(put)
        if (edge < TABLE_LOWER).any() or (edge > TABLE_UPPER).any() or math.hypot(*put.position[:2]) > REACH:
            continue
        if all(gap(edge, outline(other)) >= APART for other in apart):
            return put
    return None
