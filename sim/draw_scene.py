"""From what a scene file says to one definite world: every random number of a trial's world comes from here.

Streams: `SeedSequence([seed, digest of the scene's name])`, spawned per purpose and per object, so that one object's
draws do not depend on another's (benchmark.md section 2).
"""

from __future__ import annotations

import hashlib
import math
from dataclasses import replace

import numpy as np

from kb.errors import BadInputError
from sim.cameras import draw_cameras
from sim.catalogue import FRICTION, MODELS
from sim.footprint import gap, outline
from sim.objects import bin as bin_shape
from sim.objects.form import quaternion_about
from sim.own_object import own_object
from sim.particles import contained, fill
from sim.placed import PlacedObject, PlacedScene, RequiredConstraint, Task
from sim.scene_file import placement_order
from sim.scene_spec import ObjectSpec, Randomise, SceneSpec
from sim.settle import lay_down, settle
from sim.tasks.family import Family, family_of

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
ATTEMPTS = 400
"""Draws of a whole placement before a scene counts as impossible."""


def draw_scene(spec: SceneSpec, seed: int) -> PlacedScene:
    """The world of one trial.

    Args:
        spec: The scene.
        seed: Any non-negative integer; the same seed gives the same world, bit for bit.

    Raises:
        BadInputError: an object overlaps another, hangs off the table, is out of reach, or no placement was found.
    """
    root = np.random.SeedSequence([seed, digest(spec.name)])
    vary, place, look, cameras, contents, instances = root.spawn(6)
    family = family_of(spec)
    spec = family.vary(spec, np.random.default_rng(vary))
    streams = [np.random.default_rng(stream) for stream in instances.spawn(len(spec.objects))]
    things = {entry.id: draw_object(entry, spec, stream) for entry, stream in zip(spec.objects, streams, strict=True)}
    scene = PlacedScene(
        name=spec.name, seed=seed, objects=(), cameras=draw_cameras(np.random.default_rng(cameras)), task=_task(spec)
    )
    scene = lit(scene, np.random.default_rng(look))
    return _placed(spec, scene, things, family, np.random.default_rng(place), np.random.default_rng(contents))


def digest(name: str) -> int:
    """A stable 64-bit number for a name."""
    return int.from_bytes(hashlib.sha256(name.encode()).digest()[:8], "big")


def draw_object(entry: ObjectSpec, spec: SceneSpec, rng: np.random.Generator) -> PlacedObject:
    """The instance of an entry, still at the origin."""
    spread = spec.randomise
    size, mass, friction = (float(rng.uniform(-1.0, 1.0)) for _ in range(3))
    if entry.model is None:
        return own_object(
            entry,
            spec,
            scale=entry.scale * (1 + spread.size * size),
            mass_factor=1 + spread.mass * mass,
            friction_factor=1 + spread.friction * friction,
            rng=rng,
        )
    chosen = MODELS[entry.model]
    scale = entry.scale * (1 + spread.size * _truncated(size, spread, chosen.largest))
    nominal_friction = FRICTION[chosen.affordance.material] if entry.friction is None else entry.friction
    return chosen.draw(
        rng,
        id=entry.id,
        size_scale=scale,
        mass=(chosen.mass if entry.mass is None else entry.mass) * (1 + spread.mass * mass),
        friction=nominal_friction * (1 + spread.friction * friction),
        colour=None if entry.color is None else (*entry.color, 1.0),
        fragility=entry.fragility,
        category=entry.category,
        state="stacked" if entry.on is not None else entry.state,
    )


def _truncated(unit: float, spread: Randomise, largest: float) -> float:
    """The uniform draw on [-1, 1] squeezed so that the size stays graspable: 1 + size * draw <= largest."""
    if spread.size <= 0.0:
        return unit
    upper = min(1.0, (largest - 1.0) / spread.size)
    return -1.0 + (unit + 1.0) * (upper + 1.0) / 2.0


def _task(spec: SceneSpec) -> Task | None:
    if spec.task is None:
        return None
    return Task(
        target=spec.task.target,
        instructions=spec.task.instructions,
        required=tuple(RequiredConstraint(entry.kind, entry.target) for entry in spec.task.required),
        side_grasp_of=spec.task.side_grasp_of,
        kind=spec.task.kind,
    )


def lit(scene: PlacedScene, rng: np.random.Generator) -> PlacedScene:
    """The scene with drawn light and a drawn colour and grain of the table."""
    azimuth, height = float(rng.uniform(-math.pi, math.pi)), float(rng.uniform(0.5, 1.2))
    wood = np.array([0.72, 0.66, 0.58]) * rng.uniform(0.7, 1.15) + rng.uniform(-0.06, 0.06, 3)
    red, green, blue = np.clip(wood, 0.05, 0.95).tolist()
    pattern = {
        "table_contrast": float(rng.uniform(0.0, 0.15)),
        "table_grain": float(rng.uniform(0.03, 0.12)),
        "table_turn": float(rng.uniform(0.0, math.pi)),
    }
    return replace(
        scene,
        light=(math.cos(azimuth) * math.cos(height), math.sin(azimuth) * math.cos(height), math.sin(height)),
        ambient=float(rng.uniform(0.35, 0.55)),
        table_rgba=(red, green, blue, 1.0),
        extras={**scene.extras, **pattern},
    )


def _placed(
    spec: SceneSpec,
    scene: PlacedScene,
    things: dict[str, PlacedObject],
    family: Family,
    rng: np.random.Generator,
    contents: np.random.Generator,
) -> PlacedScene:
    """The scene with every object in a place that fits; drawn places are drawn again while they do not."""
    misfit = BadInputError("no placement was found", where=spec.where())
    for _ in range(ATTEMPTS if _has_drawn_places(spec) else 1):
        try:
            full = _one_placement(spec, scene, things, rng)
            full = _at_rest(spec, full, contents)
        except BadInputError as error:
            misfit = error
            continue
        if family.accept(full):
            return full
        misfit = BadInputError("no placement fulfils the task's conditions", where=spec.where())
    raise misfit


def _has_drawn_places(spec: SceneSpec) -> bool:
    """Whether another draw may give other places."""
    spread = spec.randomise
    if spread.position > 0 or spread.yaw > 0 or spread.size > 0:
        return True
    free = (thing.position is None and thing.on is None and thing.model != "bin" for thing in spec.objects)
    return any(free) or any(thing.state == "filled" for thing in spec.objects)


def _one_placement(
    spec: SceneSpec, scene: PlacedScene, things: dict[str, PlacedObject], rng: np.random.Generator
) -> PlacedScene:
    """One draw of all places, in the order of dependence; the objects keep the file's order."""
    done: dict[str, PlacedObject] = {}
    inside = None
    for entry in placement_order(spec):
        thing = things[entry.id]
        if thing.fixed:
            base = (*bin_shape.CENTRE, bin_shape.FLOOR_Z - bin_shape.STAND - bin_shape.SHEET)
            done[entry.id] = replace(thing, position=base)
            inside = bin_shape.inside()
            continue
        yaw = entry.yaw + spec.randomise.yaw * float(rng.uniform(-1.0, 1.0))
        thing = replace(thing, quaternion=quaternion_about("z", yaw))
        thing = _put(entry, spec, thing, done, rng)
        _check_place(entry, spec, thing, done)
        done[entry.id] = thing
    ordered = tuple(done[entry.id] for entry in spec.objects)
    full = replace(scene, objects=ordered, bin=inside)
    for entry in placement_order(spec):
        if entry.on is not None:
            full = _laid_on(entry, full)
    return full


def _put(
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
        return replace(
            thing, position=(entry.position[0] + shift[0], entry.position[1] + shift[1], max(height, RESTING))
        )
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
    for _ in range(40):
        middle = (near + far) / 2
        closer = gap(fixed, moving + centre + middle * direction) < free
        near, far = (middle, far) if closer else (near, middle)
    x, y = centre + far * direction
    return replace(thing, position=(float(x), float(y), RESTING))


def _check_place(entry: ObjectSpec, spec: SceneSpec, thing: PlacedObject, done: dict[str, PlacedObject]) -> None:
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
    import mujoco

    from sim.build_model import build_model

    pair = PlacedScene(name="pair", seed=0, objects=(one, two))
    model = build_model(pair, check=False)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_collision(model, data)
    ids = {int(model.body(thing.id).id) for thing in (one, two)}
    bodies = model.geom_bodyid[data.contact.geom[: data.ncon]]
    return any(set(map(int, row)) == ids for row in bodies)


def _laid_on(entry: ObjectSpec, scene: PlacedScene) -> PlacedScene:
    """The scene with a stacked object lowered onto its support."""
    thing = next(thing for thing in scene.objects if thing.id == entry.id)
    lowered = lay_down(scene, entry.id, thing.position[2])
    return replace(scene, objects=tuple(lowered if other.id == entry.id else other for other in scene.objects))


def _at_rest(spec: SceneSpec, scene: PlacedScene, contents: np.random.Generator) -> PlacedScene:
    """The scene with containers filled and with everything that does not simply stand on the table settled."""
    filled = [entry.id for entry in spec.objects if entry.state == "filled"]
    particles = tuple(fill(thing, contents) for thing in scene.objects if thing.id in filled)
    scene = replace(scene, particles=particles)
    if not particles and all(_simply_stands(entry) for entry in spec.objects):
        return scene
    settled, rests = settle(scene)
    for thing, start in zip(settled.objects, scene.objects, strict=True):
        if thing.fixed:
            continue
        where = spec.where(thing.id)
        edge = outline(thing)
        if (edge < TABLE_LOWER).any() or (edge > TABLE_UPPER).any() or thing.position[2] < -0.05:
            raise BadInputError("it does not stay on the table", where=where)
        on = spec.entry(thing.id).on
        if on is not None and thing.position[2] < start.position[2] - 0.03:
            raise BadInputError(f"it does not stay on {on!r}", where=where)
    for group in settled.particles:
        container = next(thing for thing in settled.objects if thing.id == group.container)
        if not contained(container, group.positions):
            raise BadInputError("its contents do not stay inside", where=spec.where(group.container))
    if not rests:
        raise BadInputError("its objects do not come to rest within 3 s", where=spec.where())
    return settled


def _simply_stands(entry: ObjectSpec) -> bool:
    raised = entry.position is not None and len(entry.position) == 3 and entry.position[2] > 0.0
    return entry.model is not None and entry.on is None and not raised
