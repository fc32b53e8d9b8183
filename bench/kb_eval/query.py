"""The queries: one object on the table, seen by the two noisy cameras, and what it truly is."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from kb.affordance import AffordanceDescriptor
from kb.reference_views import ReferenceView, cropped
from sim.draw_scene import draw_scene
from sim.ood_catalogue import FAR, NEAR
from sim.robot import Robot
from sim.world import World
from tools.experience.trial import trial_scene
from tools.perceive import PerceiveArgs
from tools.perception import RgbdPerceiver

Split = Literal["in", "near", "far"]

IN_DISTRIBUTION = (
    "ceramic_cup", "apple", "plastic_bottle", "banana", "ceramic_bowl", "wood_cube", "glass_vase", "wine_glass",
    "screwdriver", "smartphone", "tennis_ball", "toy_block",
)  # fmt: skip
"""The twelve objects of the paper's Table I."""
VIEWS = 5
FIRST_SEED = 18_000
"""Seeds of the queries: model number * 10 + view. Nothing is tuned on 18000-18999."""


@dataclass(frozen=True)
class Query:
    """One look at one object."""

    model: str
    split: Split
    seed: int
    true_category: str
    true_affordance: AffordanceDescriptor
    category: str
    """As perceived; "unknown" where nothing fitted or nothing was seen."""
    affordance: AffordanceDescriptor
    """As perceived."""
    view: ReferenceView | None
    """The masked crop; None where nothing was seen."""

    @property
    def seen(self) -> bool:
        """Whether perception found the object at all."""
        return self.view is not None


class _Crops:
    """Stands in for an embedder: keeps every crop and returns its number instead of a vector."""

    def __init__(self) -> None:
        self.views: list[ReferenceView] = []

    def embed(
        self, rgb: NDArray[np.uint8], mask: NDArray[np.bool_], depth: NDArray[np.float32] | None = None
    ) -> NDArray[np.float64]:
        """Keeps the crop."""
        self.views.append(cropped(rgb, mask, depth))
        return np.array([len(self.views) - 1.0])


def look_at(model: str, split: Split, seed: int) -> Query:
    """Draws an instance of a catalogue model somewhere on the table and perceives it from pixels."""
    placed = draw_scene(trial_scene(model), seed)
    world = World(placed)
    thing = next(item for item in placed.objects if item.id == "thing")
    crops = _Crops()
    views = tuple(Robot(world).look(np.random.default_rng([seed, 7])))
    percept = RgbdPerceiver(crops).perceive(views, PerceiveArgs())
    position = np.array(world.data.body("thing").xpos)[:2]
    seen = min(percept.objects, key=lambda o: float(np.hypot(*(np.array(o.position[:2]) - position))), default=None)
    return Query(
        model=model,
        split=split,
        seed=seed,
        true_category=thing.category,
        true_affordance=thing.affordance,
        category="unknown" if seen is None else seen.category,
        affordance=thing.affordance if seen is None else seen.affordance,
        view=None if seen is None or not seen.embedding else crops.views[int(seen.embedding[0])],
    )


def make_queries(
    splits: Sequence[Split],
    views: int = VIEWS,
    progress: Callable[[int, int, str], None] | None = None,
    workers: int = 1,
) -> list[Query]:
    """All queries of the splits, in a fixed order; the same numbers give the same queries."""
    jobs: list[tuple[str, Split, int]] = [
        (model, split, seed) for model, split, seed in _jobs(views) if split in splits
    ]
    if workers <= 1 or len(jobs) < 2:
        return _collected(map(_look, jobs), len(jobs), progress)
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        return _collected(pool.map(_look, jobs, chunksize=2), len(jobs), progress)


def _look(job: tuple[str, Split, int]) -> Query:
    return look_at(*job)


def _collected(found: Iterable[Query], count: int, progress: Callable[[int, int, str], None] | None) -> list[Query]:
    queries: list[Query] = []
    for done, query in enumerate(found, start=1):
        queries.append(query)
        if progress is not None:
            progress(done, count, f"looks at {query.model}")
    return queries


def _jobs(views: int) -> list[tuple[str, Split, int]]:
    splits: tuple[Split, ...] = ("in", "near", "far")
    models: list[tuple[str, Split]] = [(name, split) for split in splits for name in models_of(split)]
    jobs: list[tuple[str, Split, int]] = []
    for number, (name, split) in enumerate(models):
        jobs.extend((name, split, FIRST_SEED + 10 * number + view) for view in range(views))
    return jobs


def models_of(split: Split) -> tuple[str, ...]:
    """Names of a split's models."""
    return {"in": IN_DISTRIBUTION, "near": tuple(NEAR), "far": tuple(FAR)}[split]
