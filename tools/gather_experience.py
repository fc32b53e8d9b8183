"""Gather experience: carry out a way of grasping in physics ten times or more, and keep what happened.

The knowledge base is built from nothing but this: entries are logged outcomes, successes and failures, on seeds below
10000 that no evaluation uses (ledger G12, G43).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from kb.base import Noun
from kb.embedder import Embedder
from kb.errors import BadInputError
from kb.experience import SUCCESS_RATE, Experience, Strategy
from kb.shape_colour import ShapeColourEmbedder
from kb.vocabulary import FailureType
from sim.catalogue import MODELS
from tools.context import ToolContext
from tools.experience.recipe import CategoryPlan, Recipe, category_plans
from tools.experience.trial import Outcome, run_trial

LAST_SEED = 9999
"""Seeds above belong to tuning and evaluation (benchmark.md section 2)."""
SEEDS_PER_RECIPE = 20
"""Distance between the first seeds of two recipes of a category."""
SEEDS_PER_CATEGORY = 500
"""Distance between the first seeds of two categories."""
WEAKEST, STRONGEST = 0.85, 1.20
"""Trials spread the force between these shares of the recipe's, so that a band of working forces is learnt."""

Progress = Callable[[int, int, str], None]
"""Called with recipes done, recipes in all, and what was just found."""


class GatherArgs(Noun):
    """Arguments of `gather_experience`."""

    category: str
    model: str
    """Catalogue name of the object."""
    recipe: Recipe
    trials: Annotated[int, Field(ge=10, le=200)] = 10
    first_seed: Annotated[int, Field(ge=0, le=LAST_SEED)] = 0
    id: str


def gather_experience(args: GatherArgs, context: ToolContext) -> Experience:
    """Carries out a recipe on `trials` drawn instances and returns the entry; nothing is stored.

    Args:
        args: What to try with which object.
        context: Its embedder makes the visual embedding; the core's own is used if there is none.

    Raises:
        BadInputError: for an unknown model or seeds beyond the range of the knowledge base.
    """
    if args.model not in MODELS:
        raise BadInputError(f"there is no object model {args.model!r}", where="model", choices=MODELS)
    if args.first_seed + args.trials - 1 > LAST_SEED:
        raise BadInputError(f"seeds of the knowledge base end at {LAST_SEED}", where="first_seed")
    embedder: Embedder = context.embedder or ShapeColourEmbedder()
    outcomes: list[Outcome] = []
    for number in range(args.trials):
        force = trial_force(args.recipe, number, args.trials)
        # The reference view is that of the first instance.
        outcomes.append(
            run_trial(args.model, args.recipe, args.first_seed + number, force, embedder if number == 0 else None)
        )
    return summarise(args, outcomes, embedder.name)


def trial_force(recipe: Recipe, number: int, trials: int) -> float:
    """Force of trial `number` [N]: all shares between weakest and strongest, in an order that mixes them."""
    share = ((number * 7) % trials) / max(1, trials - 1)
    return float(np.clip(recipe.force * (WEAKEST + (STRONGEST - WEAKEST) * share), 1.0, 70.0))


def summarise(args: GatherArgs, outcomes: list[Outcome], embedder: str) -> Experience:
    """The entry of all trials of one recipe."""
    good = [outcome for outcome in outcomes if outcome.success]
    forces = [outcome.force for outcome in good] or [args.recipe.force]
    weighed = [outcome.mass for outcome in good if outcome.mass > 0] or [o.mass for o in outcomes if o.mass > 0.01]
    executed = [outcome for outcome in outcomes if outcome.grasp is not None]
    tilts = [float(np.arccos(np.clip(-o.grasp.approach[2], -1, 1))) for o in executed if o.grasp]
    apertures = [o.grasp.aperture for o in executed if o.grasp]
    failures: Counter[FailureType] = Counter(o.failure for o in outcomes if o.failure is not None)
    sizes = np.array([outcome.size for outcome in outcomes]).mean(axis=0)
    strategy = Strategy(
        region=args.recipe.region,
        type=args.recipe.type,
        approach=args.recipe.approach,
        tilt=_rounded(np.mean(tilts)) if tilts else float(np.radians(args.recipe.tilt)),
        force=args.recipe.force,
        force_band=(_rounded(min(forces)), _rounded(max(forces))),
        aperture=_rounded(np.mean(apertures)) if apertures else 0.08,
        depth=_rounded(np.clip(np.mean([o.depth for o in executed]), 0.0, 1.0)) if executed else 0.5,
        speed=args.recipe.speed,
    )
    return Experience(
        id=args.id,
        category=args.category,
        # The descriptor says what the object affords where it was held.
        affordance=outcomes[0].affordance.model_copy(update={"region": args.recipe.region}),
        size=(_rounded(sizes[0]), _rounded(sizes[1]), _rounded(sizes[2])),
        mass=_rounded(np.mean(weighed)) if weighed else 0.0,
        strategy=strategy,
        success=len(good) >= SUCCESS_RATE * len(outcomes),
        n_trials=len(outcomes),
        n_success=len(good),
        failures=dict(sorted(failures.items())),
        embedding=tuple(round(value, 6) for value in outcomes[0].embedding),
        embedder=embedder,
        seeds=(args.first_seed, args.first_seed + len(outcomes) - 1),
    )


def _rounded(value: float | np.floating[Any]) -> float:
    """Four decimals: 0.1 mm, 0.1 g, 0.1 mN are below what a trial can tell."""
    return round(float(value), 4)


def build_knowledge_base(
    progress: Progress | None = None, *, workers: int = 2, trials: int = 10, categories: tuple[str, ...] = ()
) -> list[Experience]:
    """Gathers all entries in physics; the same numbers every time, however many workers take part.

    Args:
        progress: Told after every recipe.
        workers: Processes; 1 runs in this one.
        trials: Trials per entry, at least 10.
        categories: Only these; all if empty.

    Returns:
        Entries in the order of the categories, as many as ledger G12 asks for.

    Raises:
        BadInputError: if a category's recipes did not yield enough successes or failures.
    """
    plans = [plan for plan in category_plans() if not categories or plan.category in categories]
    jobs = [job for plan in category_plans() if plan in plans for job in _jobs(plan, trials)]
    found: dict[str, list[Experience]] = {plan.category: [] for plan in plans}
    work = partial(_gather, trials=trials)
    wanted = len(jobs)
    if workers <= 1:
        results = map(work, jobs)
        _collect(results, found, progress, wanted)
    else:
        with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
            _collect(pool.map(work, jobs), found, progress, wanted)
    return [entry for plan in plans for entry in _compose(plan, found[plan.category])]


def _jobs(plan: CategoryPlan, trials: int) -> list[tuple[str, str, Recipe, int]]:
    """(category, model, recipe, first seed) of every recipe of a category; seeds never overlap."""
    del trials
    order = [other.category for other in category_plans()].index(plan.category)
    return [
        (plan.category, plan.models[k % len(plan.models)], recipe, SEEDS_PER_CATEGORY * order + SEEDS_PER_RECIPE * k)
        for k, recipe in enumerate(plan.recipes)
    ]


def _gather(job: tuple[str, str, Recipe, int], trials: int) -> Experience:
    category, model, recipe, seed = job
    args = GatherArgs(
        category=category, model=model, recipe=recipe, trials=trials, first_seed=seed, id=f"{category}-{seed}"
    )
    return gather_experience(args, ToolContext())


def _collect(
    results: Iterable[Experience], found: dict[str, list[Experience]], progress: Progress | None, wanted: int
) -> None:
    for done, entry in enumerate(results, start=1):
        found[entry.category].append(entry)
        if progress is not None:
            progress(done, wanted, f"{entry.id}: {entry.n_success} of {entry.n_trials}")


def _compose(plan: CategoryPlan, gathered: list[Experience]) -> list[Experience]:
    """The wanted numbers of successes and failures, first come first served, numbered in order.

    Raises:
        BadInputError: if physics gave too few of either.
    """
    kept: list[Experience] = []
    quota = {True: plan.entries - plan.failures, False: plan.failures}
    for entry in gathered:
        if quota[entry.success] > 0:
            quota[entry.success] -= 1
            kept.append(entry)
    if any(quota.values()):
        what = f"{quota[True]} successes and {quota[False]} failures are missing for {plan.category}"
        raise BadInputError(what, where="recipes.yaml")
    return [
        entry.model_copy(update={"id": f"{plan.category}-{number:02d}"}) for number, entry in enumerate(kept, start=1)
    ]
