"""Learn from outcomes without being poisoned by them: quarantine, promotion after independent successes, a guard.

A lesson enters the journal at once, but no retrieval sees it. A strategy becomes an entry only after `needed` successes in
distinct poses, each claimed from the robot's own sensing and confirmed by a second lift, with so few failures beside
them that it works more often than not with 90 % posterior probability; and only if retrieval over the regression suite
does not get worse. By the same rule failures make an entry to be avoided. The observer has no part in it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import Field

from kb.affordance import AffordanceDescriptor
from kb.base import Finite, Noun
from kb.experience import Experience, Strategy
from kb.journal import Change
from kb.learned import LearnedBase, State, after, speaks_for
from kb.lesson import Lesson, distinct_poses
from kb.priors import prior
from kb.store import ExperienceStore
from kb.store_file import StoreHeader
from kb.switches import Switches
from kb.taxonomy import CATEGORIES
from kb.vocabulary import FailureType
from tools.context import ToolContext
from tools.retrieve_haarag import RetrieveArgs, retrieve_haarag

SURE = 0.9
"""Posterior probability that a strategy works more often than not, wanted for its promotion."""
FRAGILITY = 0.2
"""A retrieved experience fits a suite query if type and region agree and the fragility is this near."""


class LearnRules(Noun):
    """What a promotion asks for."""

    needed: Annotated[int, Field(ge=1, le=100)] = 3
    """Independent confirmed successes."""
    sure: Annotated[Finite, Field(gt=0.5, lt=1.0)] = SURE


@dataclass(frozen=True)
class Suite:
    """Queries with known answers: what retrieval must not unlearn."""

    queries: tuple[tuple[str, AffordanceDescriptor, tuple[float, ...]], ...]
    """Category, descriptor and embedding (empty: none)."""

    def score(self, store: ExperienceStore) -> tuple[float, float]:
        """Share of queries whose e_1 fits, and mean of fitting ones among the three best, over 3."""
        context = ToolContext(store=store, switches=Switches(learn=True))
        first: list[float] = []
        three: list[float] = []
        for category, affordance, embedding in self.queries:
            found = retrieve_haarag(
                RetrieveArgs(category=category, affordance=affordance, embedding=embedding), context
            )
            best = found.best()
            first.append(0.0 if best is None else float(_fits(best.experience, affordance)))
            # Out of three, however few there are: one more entry never looks like a loss by being there.
            three.append(sum(_fits(item.experience, affordance) for item in found.top) / 3)
        return (float(np.mean(first)), float(np.mean(three))) if first else (0.0, 0.0)


def make_suite(base: ExperienceStore) -> Suite:
    """One query per known category from its prior, and one per experience of `base` from its own descriptor."""
    words = [(name, prior(name).affordance, ()) for name in CATEGORIES if name not in ("bin", "box")]
    seen = [(entry.category, entry.affordance, entry.embedding) for entry in base.all()]
    return Suite((*words, *seen))


def learn_experience(
    lessons: Sequence[Lesson], base: LearnedBase, suite: Suite, rules: LearnRules | None = None
) -> list[Change]:
    """Enters lessons and decides what they promote; returns the acknowledged changes.

    Args:
        lessons: Outcomes as the robot sensed them.
        base: Where to.
        suite: Guards retrieval.
        rules: What a promotion asks for.

    Raises:
        EnvironmentFaultError: the knowledge base cannot be written.
    """
    wanted = rules or LearnRules()
    made: list[Change] = []
    for lesson in lessons:
        with base.journal.writing():
            word = "confirmed success" if lesson.success else "failure" if not lesson.claimed else "unconfirmed claim"
            says = f"{word} of {lesson.key}, seed {lesson.seed}"
            made.append(base.journal.append(Change(version=0, kind="lesson", says=says, lesson=lesson)))
            decided = decide(base.state, base.header, lesson, suite, wanted)
            if decided is not None:
                made.append(base.journal.append(decided))
    return made


def decide(state: State, header: StoreHeader, lesson: Lesson, suite: Suite, rules: LearnRules) -> Change | None:
    """The promotion or refusal that follows from the lesson that was just entered, or None."""
    key = lesson.key
    kept = state.quarantine.get(key, ())
    if speaks_for(state.entries, lesson) is not None or len(kept) <= state.refused.get(key, -1):
        return None
    # A failure can only complete a negative, a success only a positive.
    same = [one for one in kept if one.success == lesson.success]
    independent = distinct_poses(same)
    good = sum(one.success for one in kept)
    probability = works_mostly(good, len(kept) - good) if lesson.success else 1 - works_mostly(good, len(kept) - good)
    facts = {
        "lessons": len(kept),
        "successes": good,
        "independent": len(independent),
        "sure": round(probability, 4),
    }
    if len(independent) < rules.needed or probability < rules.sure:
        return None
    entry = entry_of(key, kept, header, success=lesson.success)
    if entry is None:
        return None
    word = "" if lesson.success else "to be avoided: "
    change = Change(
        version=0, kind="promoted", says=f"{word}{key} after {good} of {len(kept)}", entry=entry, key=key, facts=facts
    )
    old = suite.score(_store(state, header))
    new = suite.score(_store(after(state, change), header))
    facts |= {"suite_before": [round(value, 6) for value in old], "suite_after": [round(value, 6) for value in new]}
    if new[0] < old[0] - 1e-9 or new[1] < old[1] - 1e-9:
        says = f"{key} would lower retrieval from {old[0]:.3f}, {old[1]:.3f} to {new[0]:.3f}, {new[1]:.3f}"
        return Change(version=0, kind="refused", says=says, key=key, facts=facts)
    return change.model_copy(update={"facts": facts})


def works_mostly(successes: int, failures: int) -> float:
    """Posterior probability that the success rate is above one half, from a flat prior.

    For whole numbers the Beta distribution's tail is a binomial sum (Abramowitz and Stegun 26.5.24).
    """
    n = successes + failures + 1
    row = 1.0
    total = 0.0
    for k in range(n + 1):
        if k <= successes:
            total += row
        row = row * (n - k) / (k + 1)
    return total / 2.0**n


def entry_of(key: str, lessons: Sequence[Lesson], header: StoreHeader, *, success: bool) -> Experience | None:
    """The entry that these lessons make: means over the successes (of a negative: the failures), all outcomes counted."""
    good = [one for one in lessons if one.success == success and one.embedder == header.embedder and one.embedding]
    if not good:
        return None
    first = good[0].strategy

    def mean(values: Sequence[float]) -> float:
        return round(float(np.mean(values)), 4)

    forces = [one.strategy.force for one in good]
    strategy = Strategy(
        region=first.region, type=first.type, approach=first.approach, tilt=mean([one.strategy.tilt for one in good]),
        force=mean(forces), force_band=(round(min(forces), 4), round(max(forces), 4)),
        aperture=mean([one.strategy.aperture for one in good]), depth=mean([one.strategy.depth for one in good]),
        standoff=first.standoff, speed=min(one.strategy.speed for one in good),
    )  # fmt: skip
    failures: Counter[FailureType] = Counter(one.failure or "UNKNOWN" for one in lessons if not one.success)
    vector = np.mean([one.embedding for one in good], axis=0)
    vector = vector / max(1e-12, float(np.linalg.norm(vector)))
    sizes = np.mean([one.size for one in good], axis=0)
    count = sum(one.success for one in lessons)
    seeds = [one.seed for one in lessons]
    return Experience(
        id=key, category=good[0].category,
        affordance=good[0].affordance.model_copy(update={"region": first.region}),
        size=(mean([sizes[0]]), mean([sizes[1]]), mean([sizes[2]])), mass=mean([one.mass for one in good]),
        strategy=strategy, success=success, n_trials=len(lessons),
        n_success=count, failures=dict(sorted(failures.items())),
        embedding=tuple(round(float(value), 6) for value in vector), embedder=header.embedder,
        seeds=(min(seeds), max(seeds)),
    )  # fmt: skip


def _store(state: State, header: StoreHeader) -> ExperienceStore:
    return ExperienceStore(header, list(state.entries.values()))


def _fits(entry: Experience, affordance: AffordanceDescriptor) -> bool:
    mine = entry.affordance
    near = abs(mine.fragility - affordance.fragility) <= FRAGILITY + 1e-9
    return entry.success and mine.type == affordance.type and mine.region == affordance.region and near
