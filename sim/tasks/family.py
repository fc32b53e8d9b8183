"""The part of a built-in task that a scene file cannot say: what varies between trials, and which draws are rejected."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from sim.placed import PlacedScene
from sim.scene_spec import SceneSpec
from sim.tasks import clutter, occlusion, repeated_categories, sort_by_fragility


class Vary(Protocol):
    """Draws the trial's version of a scene."""

    def __call__(self, spec: SceneSpec, rng: np.random.Generator) -> SceneSpec: ...


class Accept(Protocol):
    """Whether a drawn world fulfils the task's conditions."""

    def __call__(self, placed: PlacedScene) -> bool: ...


def _unchanged(spec: SceneSpec, rng: np.random.Generator) -> SceneSpec:
    return spec


def _any(placed: PlacedScene) -> bool:
    return True


@dataclass(frozen=True)
class Family:
    """One task's own draws."""

    vary: Vary = _unchanged
    accept: Accept = _any


_FAMILIES: dict[str, Family] = {
    clutter.NAME: Family(vary=clutter.arranged),
    "ball_behind_box": Family(accept=occlusion.mostly_hidden),
    "sort_by_fragility": Family(vary=sort_by_fragility.other_objects),
    "repeated_categories": Family(vary=repeated_categories.one_half),
}


def family_of(spec: SceneSpec) -> Family:
    """The family of a built-in scene; a user's file has none, whatever its name."""
    return _FAMILIES.get(spec.name, Family()) if spec.builtin else Family()
