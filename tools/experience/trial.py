"""One physical trial: a single object on the table, a recipe carried out on it, the observer's verdict.

Poses come from the truth with the error of a good camera, so that what is learnt is the strategy, not perception.
Building the knowledge base is the one place where the observer's word is learnt from, and only on seeds below 10000.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from kb.affordance import AffordanceDescriptor
from kb.base import Vec3
from kb.embedder import Embedder
from kb.grasp import Grasp
from kb.percept import Part, PerceivedObject
from kb.vocabulary import FailureType
from sim.draw_scene import draw_scene
from sim.observer import Observer
from sim.ood_catalogue import STAND
from sim.robot import Robot
from sim.scene_spec import ObjectSpec, Randomise, SceneSpec
from sim.world import World
from tools.execute_grasp import abort_force
from tools.experience.recipe import Recipe
from tools.oracle_perception import OraclePerceiver
from tools.perceive import PerceiveArgs
from tools.planning.body_candidates import side_floor, tip_floor
from tools.planning.candidate import Candidate, horizontal, vec3, wrap
from tools.planning.generate_candidates import generate_candidates
from tools.planning.obstacles import obstacle_of
from tools.planning.posture import ArmWay, Posture
from tools.planning.shape_grasp import wide_opening

POSE_NOISE = 0.0012
"""Standard deviation of the known position along x and y [m] (perception.md: median error)."""
SPREAD = Randomise(yaw=3.1416, size=0.05, mass=0.2, friction=0.2)
"""The draws of the benchmark's own scenes (benchmark.md section 2)."""
TRIED_PLACES = 40
"""Candidates whose reach is checked before the recipe counts as unreachable for this pose."""


@dataclass(frozen=True)
class Outcome:
    """What one trial gave."""

    success: bool
    failure: FailureType | None
    force: float
    mass: float
    """Mass that the wrist weighed [kg]; 0 where nothing was lifted."""
    size: Vec3
    affordance: AffordanceDescriptor
    grasp: Grasp | None
    depth: float
    embedding: tuple[float, ...]
    """Empty unless asked for."""


def run_trial(model: str, recipe: Recipe, seed: int, force: float, embedder: Embedder | None = None) -> Outcome:
    """Carries out a recipe on one drawn instance of a catalogue model.

    Args:
        model: Catalogue name.
        recipe: What to do.
        seed: Seed of the world, below 10000.
        force: Force of this trial [N].
        embedder: Makes the visual embedding of the front camera's view, if given.
    """
    world = World(draw_scene(trial_scene(model), seed))
    observer, robot = Observer(world), Robot(world)
    rng = np.random.default_rng([seed, 1])
    views = robot.look(rng, ("front",)) if embedder is not None else ()
    true = OraclePerceiver(world, embedder).perceive(tuple(views), PerceiveArgs()).objects[0]
    subject = displaced(true, rng.normal(0.0, POSE_NOISE, 2))
    way = ArmWay(robot.joints, np.zeros((0, 3)), (obstacle_of(subject),))
    chosen = choose(subject, recipe, force, way)
    if chosen is None:
        return _outcome(true, None, force, 0.5, False, "UNREACHABLE_POSE", 0.0)
    grasp, joints = chosen
    sensed = robot.grasp(grasp, joints=joints, obstacles=way.boxes, force_limit=abort_force(subject))
    seen = observer.judge(world.attempt, "thing")
    depth = (grasp.position[2] - true.base_z) / true.size[2]
    return _outcome(true, grasp, force, depth, seen.success, seen.failure, max(0.0, sensed.load_end))


def trial_scene(model: str) -> SceneSpec:
    """One object of a model, called "thing", alone on the table; the dinner plate lies on its stand as in its scene."""
    if model == "dinner_plate":
        stand = ObjectSpec(id="stand", model=STAND.name)
        things = (stand, ObjectSpec(id="thing", model=model, on=stand.id))
    else:
        things = (ObjectSpec(id="thing", model=model),)
    return SceneSpec(name=f"trial_{model}", objects=things, randomise=SPREAD)


def _outcome(
    true: PerceivedObject,
    grasp: Grasp | None,
    force: float,
    depth: float,
    success: bool,
    failure: FailureType | None,
    mass: float,
) -> Outcome:
    return Outcome(
        success=success,
        failure=None if success else failure or "UNKNOWN",
        force=force,
        mass=mass,
        size=true.size,
        affordance=true.affordance,
        grasp=grasp,
        depth=depth,
        embedding=true.embedding,
    )


def displaced(subject: PerceivedObject, shift: np.ndarray) -> PerceivedObject:
    """The object as if it stood `shift` [m] (2,) beside where it is."""
    dx, dy = float(shift[0]), float(shift[1])

    def moved(point: Vec3) -> Vec3:
        return point[0] + dx, point[1] + dy, point[2]

    parts: tuple[Part, ...] = tuple(part.model_copy(update={"centre": moved(part.centre)}) for part in subject.parts)
    return subject.model_copy(update={"position": moved(subject.position), "parts": parts})


def choose(subject: PerceivedObject, recipe: Recipe, force: float, way: ArmWay) -> tuple[Grasp, Posture] | None:
    """The first candidate that does what the recipe says and that the arm can make, best geometry first."""
    fitting = [
        candidate
        for candidate in generate_candidates(subject)
        if candidate.region == recipe.region
        and candidate.type == recipe.type
        and candidate.approach_class == recipe.approach
    ]
    fitting.sort(key=lambda candidate: (_strangeness(candidate, recipe), candidate.name))
    for calm in (True, False):
        for candidate in fitting[:TRIED_PLACES]:
            bent = bend(candidate, subject, recipe)
            grasp = Grasp(
                position=bent.position,
                approach=bent.approach,
                yaw=bent.yaw,
                aperture=recipe.aperture or wide_opening(bent),
                force=force,
                type=bent.type,
                speed=recipe.speed,
            )
            posture = way.posture(grasp, whole=True, calm=calm)
            if posture is not None:
                return grasp, posture
    return None


def _strangeness(candidate: Candidate, recipe: Recipe) -> float:
    """How far a candidate is from the recipe and from the textbook."""
    tilt = abs(math.degrees(candidate.tilt) - recipe.tilt) / 20.0
    depth = 0.0 if recipe.depth is None else 2.0 * abs(candidate.depth - recipe.depth)
    return round(tilt + depth - candidate.merit, 4)


def bend(candidate: Candidate, subject: PerceivedObject, recipe: Recipe) -> Candidate:
    """The candidate with the recipe's own depth, shift and turn; never into the table."""
    x, y, z = candidate.position
    if recipe.depth is not None:
        floor = (
            side_floor(math.pi / 2 - candidate.tilt) if candidate.type == "side" else tip_floor(subject, candidate.tilt)
        )
        z = max(min(floor, z), subject.base_z + recipe.depth * subject.size[2])
    shift = horizontal(subject.yaw) * recipe.aside * subject.size[0]
    position = vec3((x + float(shift[0]), y + float(shift[1]), z))
    return replace(candidate, position=position, yaw=wrap(candidate.yaw + math.radians(recipe.turn)))
