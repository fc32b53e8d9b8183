"""Where an object goes on the table, and whether it fits there."""

from __future__ import annotations

import math
from dataclasses import replace

import mujoco
import numpy as np

from kb.errors import BadInputError
from sim.build_model import build_model
from sim.footprint import SURELY, gap, outline, surely_apart
from sim.placed import PlacedObject, PlacedScene
from sim.scene_spec import ObjectSpec, SceneSpec

TABLE_LOWER, TABLE_UPPER = (0.25, -0.40), (0.85, 0.40)
"""Corners of the table [m] (ledger G40)."""
SPAWN_LOWER, SPAWN_UPPER = (0.40, -0.25), (0.65, 0.25)
"""Corners of the area where targets are drawn [m] (ledger G40)."""
REACH = 0.80
"""Largest distance of a footprint's centre from the robot's base [m]: up to here a grasp from above was always solvable
(12 random places per 5-cm ring, four yaws), beyond it never."""
NEIGHBOUR_GAP = (0.04, 0.08)
"""Free distance to a neighbour if the file gives none [m] (benchmark.md section 2)."""
RESTING = 1e-5
"""Height at which things start above the table [m]: contact without penetration."""


def put(
    entry: ObjectSpec, spec: SceneSpec, thing: PlacedObject, done: dict[str, PlacedObject], rng: np.random.Generator
) -> PlacedObject:
    """The object at its place; for `on`, above its support."""
    shift = spec.randomise.position * rng.uniform(-1.0, 1.0, 2)
    if entry.on is not None:
        below = done[entry.on]
        return replace(thing, position=(*below.position[:2], below.position[2] + below.size[2] + 0.05))
    if entry.near is not None:
        free = _draw(entry.gap if entry.gap is not None else NEIGHBOUR_GAP, rng)
        bearing = _draw(entry.bearing if entry.bearing is not None else (-math.pi, math.pi), rng)
        return beside(thing, done[entry.near], free, bearing)
    if entry.position is not None:
        height = entry.position[2] if len(entry.position) == 3 else 0.0
        x, y = entry.position[0] + float(shift[0]), entry.position[1] + float(shift[1])
        return replace(thing, position=(x, y, max(height, RESTING)))
    x, y = rng.uniform(SPAWN_LOWER, SPAWN_UPPER)
    return replace(thing, position=(float(x), float(y), RESTING))


def _draw(value: float | tuple[float, float], rng: np.random.Generator) -> float:
    return float(rng.uniform(*value)) if isinstance(value, tuple) else value


def beside(thing: PlacedObject, other: PlacedObject, free: float, bearing: float) -> PlacedObject:
    """The object at `bearing` from the other one with a free distance of `free` between their outlines (bisection)."""
    fixed, moving = outline(other), outline(replace(thing, position=(0.0, 0.0, 0.0)))
    direction = np.array([math.cos(bearing), math.sin(bearing)])
    centre = np.asarray(other.position[:2])
    near, far = 0.0, 1.5
    # A step changes the gap by no more than its length: the gaps at both ends bound it, and decide half of the halvings.
    most, least = math.inf, -math.inf
    for _ in range(40):
        middle = (near + far) / 2
        above, below = most + (middle - near), least - (far - middle)
        if below < free + SURELY and above >= free - SURELY:
            above = below = gap(fixed, moving + centre + middle * direction)
        if above < free:
            near, most = middle, above
        else:
            far, least = middle, below
    x, y = centre + far * direction
    return replace(thing, position=(float(x), float(y), RESTING))


def check_place(entry: ObjectSpec, spec: SceneSpec, thing: PlacedObject, done: dict[str, PlacedObject]) -> None:
    """Raises BadInputError if the object hangs off the table, is out of reach or is inside or too near another one."""
    where = spec.where(entry.id)
    edge = outline(thing)
    if (edge < TABLE_LOWER).any() or (edge > TABLE_UPPER).any():
        raise BadInputError("it hangs off the table (x 0.25 to 0.85, y -0.40 to 0.40 m)", where=where)
    distance = math.hypot(*thing.position[:2])
    if distance > REACH:
        raise BadInputError(
            f"it is out of reach: {distance:.2f} m from the robot's base, at most {REACH:.2f} m", where=where
        )
    if entry.on is not None:
        return
    for other_id, other in done.items():
        if other.fixed or _stacked(other) or entry.near == other_id:
            continue
        related = _related(spec, entry.id, other_id)
        drawn = entry.position is None or spec.entry(other_id).position is None
        least = 0.0 if related or not drawn else spec.separation
        if surely_apart(edge, outline(other), least):
            continue
        free = gap(edge, outline(other))
        if free >= least or (free < 0.0 and _above_each_other(thing, other)):
            continue
        if free < 0.0 and not drawn and not _pieces_overlap(thing, other):
            continue
        raise BadInputError(
            f"it overlaps {other_id!r}" if free < 0 else f"it is only {free:.3f} m from {other_id!r}", where=where
        )


def _stacked(thing: PlacedObject) -> bool:
    return thing.state == "stacked"


def _related(spec: SceneSpec, one: str, two: str) -> bool:
    """Whether one of the two stands near the other or both near the same thing, so that the file rules their distance."""
    a, b = spec.entry(one), spec.entry(two)
    return two == a.near or one == b.near or (a.near is not None and a.near == b.near)


def _above_each_other(one: PlacedObject, two: PlacedObject) -> bool:
    """Whether their heights do not overlap."""
    low, high = sorted((one, two), key=lambda thing: thing.position[2])
    return high.position[2] >= low.position[2] + low.size[2]


def _pieces_overlap(one: PlacedObject, two: PlacedObject) -> bool:
    """Whether the objects really touch, piece by piece; their outlines are convex and may overlap where they do not."""
    pair = PlacedScene(name="pair", seed=0, objects=(one, two))
    model = build_model(pair, check=False)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_collision(model, data)
    ids = {int(model.body(thing.id).id) for thing in (one, two)}
    bodies = model.geom_bodyid[data.contact.geom[: data.ncon]]
    return any(set(map(int, row)) == ids for row in bodies)
