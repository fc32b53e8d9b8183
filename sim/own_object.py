"""An object of the user's own, from a mesh or an MJCF file, as a placed body."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from kb.affordance import AffordanceDescriptor
from kb.errors import BadInputError
from kb.percept import Part
from kb.vocabulary import UNKNOWN_CATEGORY
from sim.catalogue import MODELS, damage_threshold
from sim.footprint import geom_points
from sim.mesh import SMALLEST_VOLUME, SUFFIXES, convex_pieces, hull_volumes
from sim.mjcf import mjcf_geoms, moved
from sim.objects.colours import anything
from sim.objects.form import Colour
from sim.placed import Geom, PlacedObject
from sim.scene_spec import ObjectSpec, SceneSpec
from sim.user_files import inside, read

SMALLEST, LARGEST = 0.002, 0.60
"""Limits of an object's extents [m]: thinner is lost between the fingers, larger does not fit the table."""
DENSITY = 600.0
"""Density of an object whose mass the file does not give [kg/m^3]."""
FRICTION = 0.5
FRAGILITY = 0.3
"""Of an object whose file does not say: careful without being useless."""


def check_files(entry: ObjectSpec, spec: SceneSpec) -> None:
    """Raises BadInputError if the entry's file is missing, too big, of another kind, or outside the scene's folder."""
    name = entry.mesh or entry.mjcf
    if name is not None:
        inside(_folder(entry, spec), name, spec.where(entry.id), SUFFIXES if entry.mesh else (".xml", ".mjcf"))


def own_object(
    entry: ObjectSpec,
    spec: SceneSpec,
    *,
    scale: float,
    mass_factor: float,
    friction_factor: float,
    rng: np.random.Generator,
) -> PlacedObject:
    """The object at the origin.

    Args:
        entry: Its entry in the scene file.
        spec: The scene.
        scale: Factor from the file's units to metres.
        mass_factor: Drawn factor on the mass.
        friction_factor: Drawn factor on the friction.
        rng: Draws colour and damage threshold.

    Raises:
        BadInputError: the file is unusable, or the object has no volume or an impossible size.
    """
    where, folder = spec.where(entry.id), _folder(entry, spec)
    drawn, damage = anything(rng), float(rng.uniform(0.8, 1.25))
    colour: Colour | None = None if entry.color is None else (*entry.color, 1.0)
    mass = entry.mass
    if entry.mjcf is not None:
        pieces, file_mass = mjcf_geoms(folder, entry.mjcf, where)
        mass = file_mass * scale**3 if mass is None else mass
    else:
        path = inside(folder, str(entry.mesh), where, SUFFIXES)
        cut = convex_pieces(
            read(path, where), path.suffix.lower(), where, lambda size: check_extents(scale * size, where)
        )
        colour = colour or drawn
        pieces = [Geom("mesh", vertices=piece, mass=v) for piece, v in zip(cut, hull_volumes(cut), strict=True)]
    geoms, size = _standing(pieces, scale, entry.up, where)
    volume = sum(geom.mass for geom in geoms)
    if volume < SMALLEST_VOLUME:
        raise BadInputError("it has no volume", where=where)
    mass = (DENSITY * volume if mass is None else mass) * mass_factor
    affordance = _affordance(entry)
    return PlacedObject(
        id=entry.id,
        model=str(entry.mesh or entry.mjcf),
        category=entry.category or UNKNOWN_CATEGORY,
        affordance=affordance,
        geoms=tuple(
            replace(geom, mass=geom.mass / volume * mass, rgba=colour or geom.rgba, region="body") for geom in geoms
        ),
        position=(0.0, 0.0, 0.0),
        quaternion=(1.0, 0.0, 0.0, 0.0),
        size=size,
        mass=mass,
        friction=(FRICTION if entry.friction is None else entry.friction) * friction_factor,
        damage_force=damage_threshold(affordance.fragility) * damage,
        state="stacked" if entry.on is not None else "empty",
        parts=(_body(size),),
    )


def _folder(entry: ObjectSpec, spec: SceneSpec) -> Path:
    if spec.source.file is None:
        raise BadInputError("only scene files can hold meshes", where=spec.where(entry.id))
    return Path(spec.source.file).resolve().parent


def _standing(pieces: list[Geom], scale: float, up: str, where: str) -> tuple[list[Geom], tuple[float, float, float]]:
    """The pieces in metres, upright, with the footprint's centre at the origin and the lowest point at z = 0; extents."""
    turn: NDArray[np.float64] = np.eye(3)
    if up == "y":
        turn = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    rough = [moved(geom, turn, np.zeros(3), scale) for geom in pieces]
    points = np.vstack([geom_points(geom) for geom in rough])
    low, high = points.min(0), points.max(0)
    extents = high - low
    check_extents(extents, where)
    shift = -np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]])
    x, y, z = extents.tolist()
    return [moved(geom, np.eye(3), shift, 1.0) for geom in rough], (x, y, z)


def check_extents(extents: NDArray[np.float64], where: str, smallest: float = SMALLEST) -> None:
    """Raises BadInputError if an object's extents (3,) [m] are too small or too large to be handled.

    A flat mesh is let through here: it has no volume, which is the better thing to say.
    """
    if extents.max() > LARGEST or 0.0 < extents.min() < smallest or extents.max() < smallest:
        centimetres = " x ".join(f"{100 * value:.4g}" for value in extents)
        hint = "; are its units millimetres (scale: 0.001)?" if extents.max() > 10 * LARGEST else ""
        raise BadInputError(
            f"it measures {centimetres} cm, each must be {100 * smallest:.1g} to {100 * LARGEST:.0f} cm{hint}",
            where=where,
        )


def _affordance(entry: ObjectSpec) -> AffordanceDescriptor:
    """That of the catalogue's category of this name, else a body of unknown material."""
    known = next((model.affordance for model in MODELS.values() if model.category == entry.category), None)
    if known is not None:
        return known if entry.fragility is None else known.model_copy(update={"fragility": entry.fragility})
    fragility = FRAGILITY if entry.fragility is None else entry.fragility
    return AffordanceDescriptor(type="GRASPABLE_BODY", material="mixed", fragility=fragility, region="body")


def _body(size: tuple[float, float, float]) -> Part:
    along = (1.0, 0.0, 0.0) if size[0] >= size[1] else (0.0, 1.0, 0.0)
    return Part(region="body", centre=(0.0, 0.0, size[2] / 2), axis=along, width=min(size[:2]), length=max(size[:2]))
