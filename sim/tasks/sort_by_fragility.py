"""Task LH-b: three objects whose fragilities differ by at least 0.2 (benchmark.md section 3)."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from sim.catalogue import MODELS
from sim.scene_spec import SceneSpec

CANDIDATES = {
    "block": "toy_block",
    "cube": "wood_cube",
    "ball": "tennis_ball",
    "banana": "banana",
    "cup": "ceramic_cup",
    "phone": "smartphone",
    "glass": "wine_glass",
}
"""Scene id -> model of the objects to draw from."""
LEAST_DIFFERENCE = 0.2 - 1e-9
"""Smallest difference of fragility between any two of them."""


def triples() -> tuple[tuple[str, str, str], ...]:
    """All triples of ids whose fragilities differ pairwise by at least 0.2, least fragile first."""

    def fragility(name: str) -> float:
        return MODELS[CANDIDATES[name]].affordance.fragility

    found: list[tuple[str, str, str]] = []
    for triple in combinations(CANDIDATES, 3):
        a, b, c = sorted(triple, key=fragility)
        if fragility(b) - fragility(a) >= LEAST_DIFFERENCE and fragility(c) - fragility(b) >= LEAST_DIFFERENCE:
            found.append((a, b, c))
    return tuple(found)


def other_objects(spec: SceneSpec, rng: np.random.Generator) -> SceneSpec:
    """The scene with a triple drawn in place of the nominal one, in a drawn order."""
    every = triples()
    chosen = every[int(rng.integers(len(every)))]
    names = [chosen[int(k)] for k in rng.permutation(3)]
    others = tuple(thing for thing in spec.objects if thing.model == "bin")
    template = next(thing for thing in spec.objects if thing.model != "bin")
    drawn = tuple(template.model_copy(update={"id": name, "model": CANDIDATES[name]}) for name in names)
    return spec.model_copy(update={"objects": (*drawn, *others)})
