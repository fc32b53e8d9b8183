"""The whole evaluation as one value: every setting, the sweeps, and what was not run."""

from __future__ import annotations

import platform
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

from bench.kb_eval.evaluate import Setting, Sight, evaluate, judge, make_sight, sweep, wanted_pairs
from bench.kb_eval.measure_ranking import RESAMPLES, Mean
from bench.kb_eval.query import VIEWS, Query, Split, make_queries, models_of
from bench.kb_eval.ranking import Fusion
from bench.kb_eval.relevance import FunctionalRelevance, code_digest
from kb.embed_store import embedded_store
from kb.errors import EnvironmentFaultError
from kb.experience import Experience
from kb.open_embedder import CORE, open_embedder
from kb.store import ExperienceStore
from kb.taxonomy import TaxonomyName

Progress = Callable[[int, int, str], None]

OUTSIDE: tuple[Split, ...] = ("near", "far")
NOT_RUN = "not run here"
TAUS = tuple(round(0.1 * step, 1) for step in range(10))
STEP = 0.1
"""Step of the fusion weights in their sweep."""


@dataclass(frozen=True)
class Part:
    """One setting on one split."""

    split: Split | Literal["ood"]
    """"ood": near and far together."""
    setting: Setting
    queries: int
    objects: int
    systems: dict[str, dict[str, Mean]]


@dataclass(frozen=True)
class Study:
    """Everything that was measured."""

    knowledge_base: dict[str, Any]
    embedders: dict[str, str]
    """Word -> title, or why it was not run."""
    perceived: dict[str, tuple[int, int, int]]
    """Per split: queries, seen, perceived as the true category."""
    executed: tuple[int, int]
    """Pairs of object and strategy with executed outcomes, and those still missing."""
    parts: tuple[Part, ...]
    tau_sweep: list[dict[str, float]]
    weight_sweep: list[dict[str, float]]
    machine: str
    left_out_tau_sweep: list[dict[str, float]] = field(default_factory=list[dict[str, float]])
    """The same with the query's own category left out, where threshold and weights matter more."""
    left_out_weight_sweep: list[dict[str, float]] = field(default_factory=list[dict[str, float]])
    current: bool = True
    """The executed outcomes were made by the present code of world and trials."""

    def part(self, split: Split, **setting: Any) -> Part | None:
        """The part of a split and setting, or None."""
        wanted = replace(Setting(), **setting)
        return next((part for part in self.parts if part.split == split and part.setting == wanted), None)


@dataclass(frozen=True)
class Wanted:
    """What to measure."""

    store: Path | None = None
    embedders: tuple[str, ...] = (CORE,)
    splits: tuple[Split, ...] = ("in", "near", "far")
    views: int = VIEWS
    execute: bool = True
    """Execute the strategies that have no outcome yet."""
    again: bool = False
    """Execute all anew."""
    executed: Path | None = None
    """File of the executed outcomes; None: beside the knowledge base."""
    resamples: int = RESAMPLES
    workers: int = 1
    """Processes that look and execute."""


def study(wanted: Wanted, progress: Progress | None = None) -> Study:
    """Makes the queries, executes what is missing, ranks and measures.

    Raises:
        EnvironmentFaultError: the knowledge base or the file of outcomes cannot be used.
    """
    store = ExperienceStore.open(wanted.store)
    splits = wanted.splits
    queries = make_queries(splits, wanted.views, progress, wanted.workers)
    executed = FunctionalRelevance(wanted.executed or executed_path(store), again=wanted.again)
    sights, told = _sights(wanted.embedders, store, queries)
    pairs = _pairs(queries, sights, executed, store)
    if wanted.execute:
        executed.fill(executed.missing(pairs), progress, wanted.workers)
    parts = _parts(queries, sights, executed, splits, wanted.resamples)
    inside = [query for query in queries if query.split == "in"]
    numbers = [number for number, query in enumerate(queries) if query.split == "in"]
    judged = judge(inside, [_of(sights[0], numbers)], executed, Setting())
    harder = judge(inside, [_of(sights[0], numbers)], executed, Setting(leave_out=True))
    return Study(
        knowledge_base={
            "entries": len(store),
            "successes": sum(entry.success for entry in store.all()),
            "content": store.content_hash(),
        },
        embedders=told,
        perceived={split: _perceived([query for query in queries if query.split == split]) for split in splits},
        executed=(len(pairs), len(executed.missing(pairs))),
        parts=parts,
        tau_sweep=sweep(judged, sights[0].word, [Fusion(tau=tau) for tau in TAUS]) if judged else [],
        weight_sweep=sweep(judged, sights[0].word, weight_grid()) if judged else [],
        left_out_tau_sweep=sweep(harder, sights[0].word, [Fusion(tau=tau) for tau in TAUS]) if harder else [],
        left_out_weight_sweep=sweep(harder, sights[0].word, weight_grid()) if harder else [],
        current=executed.code == code_digest(),
        machine=f"{platform.machine()}, Python {platform.python_version()}",
    )


def executed_path(store: ExperienceStore) -> Path:
    """The file of executed outcomes beside a knowledge base."""
    path = store.path or Path("knowledge.jsonl")
    return path.with_suffix(".executed.json")


def weight_grid() -> list[Fusion]:
    """All weights of category, affordance and looks in steps of 0.1 that sum to 1."""
    count = round(1.0 / STEP)
    return [
        Fusion(category=a * STEP, affordance=b * STEP, visual=(count - a - b) * STEP)
        for a in range(count + 1)
        for b in range(count + 1 - a)
    ]


def _sights(
    words: Sequence[str], store: ExperienceStore, queries: Sequence[Query]
) -> tuple[list[Sight], dict[str, str]]:
    """The embedders that can run here; the others are told as not run. Only published CLIP weights are called CLIP."""
    sights: list[Sight] = []
    told: dict[str, str] = {}
    for word in words:
        short = word.split(":", 1)[0].replace("-", "_")
        try:
            embedder = open_embedder(word)
        except EnvironmentFaultError as error:
            told[short] = f"{NOT_RUN}: {error.what}"
            continue
        if short.startswith("clip") and not bool(getattr(embedder, "is_published", False)):
            short = "vit_l_14_file"
            told["clip"] = f"{NOT_RUN}: the weights of {word} are a local file of unknown origin"
        title = {"shape_colour": "shape and colour", "efficientnet": "EfficientNet-Lite0"}.get(short, embedder.name)
        told[short] = title
        sights.append(make_sight(short, title, embedder, embedded_store(store, embedder), queries))
    if "clip" not in told:
        told["clip"] = f"{NOT_RUN}: no CLIP weights were given (--embedder clip:TAG)"
    return sights, told


def _settings(split: Split | Literal["ood"]) -> list[Setting]:
    names: tuple[TaxonomyName, ...] = ("known", "blind") if split in ("far", "ood") else ("known",)
    settings = [Setting(taxonomy=name, true_descriptors=true) for name in names for true in (False, True)]
    return [*settings, Setting(leave_out=True)] if split == "in" else settings


def _pairs(
    queries: Sequence[Query], sights: Sequence[Sight], executed: FunctionalRelevance, store: ExperienceStore
) -> list[tuple[str, Experience]]:
    """What has to be executed: every success on every in-distribution object, and the first places on the others.

    Measures over a full ranking need the former; the other objects would take hours and have none of these.
    """
    found = {
        (model, entry.id): (model, entry)
        for model in models_of("in")
        for entry in store.all()
        if entry.success and any(query.split == "in" for query in queries)
    }
    for split in OUTSIDE:
        numbers = [number for number, query in enumerate(queries) if query.split == split]
        mine = [queries[number] for number in numbers]
        for setting in _settings(split) if mine else ():
            for model, entry in wanted_pairs(mine, [_of(sight, numbers) for sight in sights], executed, setting):
                if entry.success:
                    found.setdefault((model, entry.id), (model, entry))
    return list(found.values())


def _parts(
    queries: Sequence[Query],
    sights: Sequence[Sight],
    executed: FunctionalRelevance,
    splits: Sequence[Split],
    resamples: int,
) -> tuple[Part, ...]:
    parts: list[Part] = []
    groups: list[tuple[Split | Literal["ood"], tuple[Split, ...]]] = [(split, (split,)) for split in splits]
    if set(OUTSIDE) <= set(splits):
        groups.append(("ood", OUTSIDE))
    for split, members in groups:
        numbers = [number for number, query in enumerate(queries) if query.split in members]
        mine = [queries[number] for number in numbers]
        seen = [_of(sight, numbers) for sight in sights]
        for setting in _settings(split):
            systems = evaluate(mine, seen, executed, setting, np.random.default_rng(0), resamples)
            parts.append(Part(split, setting, len(mine), len({query.model for query in mine}), systems))
    return tuple(parts)


def _of(sight: Sight, numbers: Sequence[int]) -> Sight:
    """The sight with these queries only."""
    return replace(sight, queries=sight.queries[list(numbers)])


def _perceived(queries: Sequence[Query]) -> tuple[int, int, int]:
    return (
        len(queries),
        sum(query.seen for query in queries),
        sum(query.seen and query.category == query.true_category for query in queries),
    )
