"""The clutter suite: the paper's twelve objects all on the table, with gaps down to 5 mm, and each once the target.

A scene is named `clutter_<target>`. Its world follows from the seed alone, so that the same clutter is met with every
target; what differs is the task.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kb.errors import BadInputError
from sim.catalogue import MODELS, TABLE_I
from sim.footprint import gap, outline
from sim.placement import REACH, TABLE_LOWER, TABLE_UPPER
from sim.scene_spec import ObjectSpec, Randomise, SceneSpec, TaskSpec

Array = NDArray[np.float64]

NAME, PREFIX = "clutter", "clutter_"
TARGETS: dict[str, str] = {
    "cup": "the cup",
    "apple": "the apple",
    "bottle": "the bottle",
    "banana": "the banana",
    "bowl": "the bowl",
    "cube": "the wooden cube",
    "vase": "the vase",
    "glass": "the wine glass",
    "screwdriver": "the screwdriver",
    "phone": "the phone",
    "ball": "the tennis ball",
    "block": "the toy block",
}
"""Object id -> how a person calls it; in the order of the paper's Table I."""
SENTENCES = (
    "pick up {}",
    "grab {}",
    "lift {} off the table",
    "please take {}",
    "can you get {} for me?",
    "get {} out of the clutter",
)
GAP = 0.005
"""Least free distance between any two objects [m]."""
LOWER, UPPER = (0.32, -0.28), (0.74, 0.28)
"""Corners of the area that the centres are drawn from [m]."""
TRIES = 400
"""Draws of a place after which the pile is begun anew."""
PILES = 20
"""Piles begun before a seed counts as impossible."""


@dataclass(frozen=True)
class _Stood:
    """An object that has its place."""

    name: str
    edge: Array
    """Outline in the world (N, 2) [m]."""
    position: tuple[float, float]
    yaw: float


def clutter_scenes() -> tuple[str, ...]:
    """Names of the scenes, one a target."""
    return tuple(PREFIX + target for target in TARGETS)


def clutter_scene(target: str) -> SceneSpec:
    """The scene whose task is to pick up `target` out of the clutter; places follow when it is drawn.

    Raises:
        BadInputError: there is no such object.
    """
    if target not in TARGETS:
        raise BadInputError(f"there is no scene {PREFIX + target!r}", choices=clutter_scenes())
    sentences = tuple(sentence.format(TARGETS[target]) for sentence in SENTENCES)
    return SceneSpec(
        name=NAME,
        objects=tuple(ObjectSpec(id=name, model=model) for name, model in zip(TARGETS, TABLE_I, strict=True)),
        randomise=Randomise(mass=0.2, friction=0.2),
        separation=0.0,
        task=TaskSpec(target=target, instructions=sentences),
    )


def arranged(spec: SceneSpec, rng: np.random.Generator) -> SceneSpec:
    """The scene with a place for every object.

    Raises:
        BadInputError: no pile fits on the table.
    """
    pile = _packed(int(rng.integers(2**62)))
    if pile is None:
        raise BadInputError("the objects do not fit on the table", where=spec.where())
    objects = tuple(
        thing.model_copy(update={"position": pile[thing.id].position, "yaw": pile[thing.id].yaw})
        for thing in spec.objects
    )
    return spec.model_copy(update={"objects": objects})


@lru_cache(maxsize=32)
def _packed(seed: int) -> dict[str, _Stood] | None:
    """Places of all objects by id: kept, since the same pile is met once with every target."""
    rng = np.random.default_rng(seed)
    edges = {
        name: outline(MODELS[model].draw(np.random.default_rng(0), id=name, size_scale=1.0, position=(0.0, 0.0, 0.0)))
        for name, model in zip(TARGETS, TABLE_I, strict=True)
    }
    for _ in range(PILES):
        pile: list[_Stood] = []
        for name in rng.permutation(list(edges)):
            stood = _place(str(name), edges[name], pile, rng)
            if stood is None:
                break
            pile.append(stood)
        else:
            return {stood.name: stood for stood in pile}
    return None


def _place(name: str, edge: Array, pile: list[_Stood], rng: np.random.Generator) -> _Stood | None:
    """A drawn place that fits beside those that have theirs, or None."""
    for _ in range(TRIES):
        yaw = float(rng.uniform(-math.pi, math.pi))
        x, y = (float(value) for value in rng.uniform(LOWER, UPPER))
        turned = edge @ np.array([[math.cos(yaw), math.sin(yaw)], [-math.sin(yaw), math.cos(yaw)]])
        stood = _Stood(name, turned + np.array([x, y]), (x, y), yaw)
        if _fits(stood, pile):
            return stood
    return None


def _fits(stood: _Stood, pile: list[_Stood]) -> bool:
    """Whether it stands on the table, in reach, and leaves every other object its distance."""
    if (stood.edge < TABLE_LOWER).any() or (stood.edge > TABLE_UPPER).any() or math.hypot(*stood.position) > REACH:
        return False
    return all(gap(stood.edge, other.edge) >= GAP for other in pile)
