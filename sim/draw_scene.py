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
from sim.catalogue import FRICTION
from sim.footprint import outline
from sim.objects import bin as bin_shape
from sim.objects.form import quaternion_about
from sim.ood_catalogue import any_model
from sim.own_object import check_extents, own_object
from sim.particles import contained, fill
from sim.placed import PlacedObject, PlacedScene, RequiredConstraint, Task
from sim.placement import TABLE_LOWER, TABLE_UPPER, check_place, put
from sim.scene_file import placement_order
from sim.scene_spec import ObjectSpec, Randomise, SceneSpec
from sim.settle import lay_down, settle
from sim.tasks.family import Family, family_of

PLACE_TRIES = 20
"""Draws of one object's place before the whole placement is drawn again."""
MOST_UNCERTAIN = 0.9
"""Largest relative half-width of the draws of mass and friction."""
ATTEMPTS = 100
"""Draws of a whole placement before a scene counts as impossible."""


def draw_scene(spec: SceneSpec, seed: int, *, noise: float = 1.0) -> PlacedScene:
    """The world of one trial.

    Args:
        spec: The scene.
        seed: Any non-negative integer; the same seed gives the same world, bit for bit.
        noise: Scale of what the robot can't know: mass, friction and the residual of the cameras' calibration. The draws
            are the same for every scale, so that places, sizes and looks do not depend on it.

    Raises:
        BadInputError: an object overlaps another, hangs off the table, is out of reach, or no placement was found.
    """
    root = np.random.SeedSequence([seed, digest(spec.like or spec.name)])
    vary, place, look, cameras, contents, instances = root.spawn(6)
    family = family_of(spec)
    spec = spec.model_copy(update={"randomise": scaled(spec.randomise, noise)})
    spec = family.vary(spec, np.random.default_rng(vary))
    streams = [np.random.default_rng(stream) for stream in instances.spawn(len(spec.objects))]
    things = {entry.id: draw_object(entry, spec, stream) for entry, stream in zip(spec.objects, streams, strict=True)}
    scene = PlacedScene(
        name=spec.name,
        seed=seed,
        objects=(),
        task=_task(spec),
        cameras=draw_cameras(np.random.default_rng(cameras), residual=noise),
    )
    scene = lit(scene, np.random.default_rng(look))
    return _placed(spec, scene, things, family, np.random.default_rng(place), np.random.default_rng(contents))


def scaled(spread: Randomise, noise: float) -> Randomise:
    """The spread with mass and friction scaled by `noise`; they stay positive."""
    mass, friction = (min(MOST_UNCERTAIN, noise * value) for value in (spread.mass, spread.friction))
    return spread.model_copy(update={"mass": mass, "friction": friction})


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
    chosen = any_model(entry.model)
    scale = entry.scale * (1 + spread.size * _truncated(size, spread, chosen.largest))
    nominal_friction = FRICTION[chosen.affordance.material] if entry.friction is None else entry.friction
    if not chosen.fixed:
        check_extents(np.asarray(chosen.form(scale).size), spec.where(entry.id))
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
        if entry.model == "bin":
            base = (*bin_shape.CENTRE, bin_shape.FLOOR_Z - bin_shape.STAND - bin_shape.SHEET)
            done[entry.id] = replace(thing, position=base)
            inside = bin_shape.inside()
            continue
        thing = _fitting(entry, spec, thing, done, rng)
        done[entry.id] = thing
    ordered = tuple(done[entry.id] for entry in spec.objects)
    full = replace(scene, objects=ordered, bin=inside)
    for entry in placement_order(spec):
        if entry.on is not None:
            full = _laid_on(entry, full)
    return full


def _fitting(
    entry: ObjectSpec, spec: SceneSpec, thing: PlacedObject, done: dict[str, PlacedObject], rng: np.random.Generator
) -> PlacedObject:
    """The object at a place that fits; a drawn place is drawn a few times before the others are drawn again too."""
    tries = 1 if entry.position is not None or entry.on is not None else PLACE_TRIES
    while True:
        tries -= 1
        yaw = entry.yaw + spec.randomise.yaw * float(rng.uniform(-1.0, 1.0))
        turned = replace(thing, quaternion=quaternion_about("z", yaw))
        try:
            placed = put(entry, spec, turned, done, rng)
            check_place(entry, spec, placed, done)
        except BadInputError:
            if tries <= 0:
                raise
            continue
        return placed


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
