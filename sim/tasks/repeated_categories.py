"""Task S3: two objects of one category and one of another, so that memory can transfer within a trial."""

from __future__ import annotations

import numpy as np

from sim.scene_spec import SceneSpec

HALVES = (("cup_1", "cup_2", "bottle"), ("block_1", "block_2", "ball"))
"""The scene file holds both halves; a trial shows one."""


def one_half(spec: SceneSpec, rng: np.random.Generator) -> SceneSpec:
    """The scene with one of the two halves, and whatever belongs to neither."""
    hidden = HALVES[int(rng.integers(2))]
    kept = tuple(thing for thing in spec.objects if thing.id not in hidden)
    return spec.model_copy(update={"objects": kept})
