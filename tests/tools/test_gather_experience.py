"""Experience is what physics said: ten trials, their outcomes, and what was learnt from them."""

from __future__ import annotations

import math

import pytest

from kb.errors import BadInputError
from kb.store import ExperienceStore
from tests.planning_fixtures import context
from tools.experience.recipe import Recipe, category_plans
from tools.experience.trial import run_trial
from tools.gather_experience import LAST_SEED, GatherArgs, gather_experience, trial_force

GOOD = Recipe(name="across", region="body", type="power", approach="top", force=15)
HIGH = Recipe(name="too high", region="body", type="power", approach="top", force=15, depth=1.6)


def gathered(recipe: Recipe, **fields: object) -> GatherArgs:
    return GatherArgs.model_validate(
        {"category": "cube", "model": "wood_cube", "recipe": recipe, "first_seed": 40, "id": "x"} | fields
    )


def test_a_sensible_way_succeeds_and_its_mass_and_force_band_are_learnt() -> None:
    """Ten cubes of 90 g +- 20 %: at least eight successes, mass within the range, band within the forces tried."""
    entry = gather_experience(gathered(GOOD), context())
    assert entry.success
    assert (entry.n_trials, entry.seeds) == (10, (40, 49))
    assert 0.07 < entry.mass < 0.11
    assert 0.84 * 15 <= entry.strategy.force_band[0] <= entry.strategy.force_band[1] <= 1.21 * 15
    assert sum(entry.failures.values()) == entry.n_trials - entry.n_success
    assert math.isclose(math.fsum(value * value for value in entry.embedding), 1.0, abs_tol=1e-3)


def test_a_deliberately_bad_way_fails_with_the_observers_label() -> None:
    """Closing above the cube grips nothing: a position error, and y = 0."""
    outcome = run_trial("wood_cube", HIGH, 60, 15.0)
    assert (outcome.success, outcome.failure) == (False, "POSITION_ERROR")


def test_the_same_trial_gives_the_same_outcome() -> None:
    """Same model, recipe, seed and force: equal in every number."""
    assert run_trial("wood_cube", GOOD, 41, 14.0) == run_trial("wood_cube", GOOD, 41, 14.0)


def test_forces_are_spread_over_the_trials() -> None:
    """From 85 to 120 % of the recipe's force, every share once."""
    forces = sorted(trial_force(GOOD, number, 10) for number in range(10))
    assert forces[0] == pytest.approx(0.85 * 15)
    assert forces[-1] == pytest.approx(1.20 * 15)
    assert len({round(force, 6) for force in forces}) == 10


def test_seeds_of_the_evaluation_are_out_of_bounds() -> None:
    """The knowledge base ends at seed 9999 (ledger G43)."""
    with pytest.raises(BadInputError):
        gather_experience(gathered(GOOD, first_seed=LAST_SEED - 3), context())
    with pytest.raises(BadInputError, match="model"):
        gather_experience(gathered(GOOD, model="teapot"), context())


def test_the_composition_is_the_ledgers() -> None:
    """116 entries with 29 failures, in the numbers per category of ledger G12."""
    plans = {plan.category: plan for plan in category_plans()}
    assert sum(plan.entries for plan in plans.values()) == 116
    assert sum(plan.failures for plan in plans.values()) == 29
    counts = {name: plan.entries for name, plan in plans.items()}
    assert counts["cube"] + counts["block"] == 10
    assert counts["pen"] + counts["key"] == 10
    assert {name: counts[name] for name in ("cup", "mug", "apple", "bottle", "banana", "bowl", "vase")} == {
        "cup": 10, "mug": 6, "apple": 8, "bottle": 10, "banana": 8, "bowl": 10, "vase": 8,
    }  # fmt: skip


def test_what_is_shipped_is_what_was_composed() -> None:
    """Counts, trials and seeds of the shipped file; failures are failures."""
    entries = ExperienceStore.open().all()
    assert (len(entries), sum(not entry.success for entry in entries)) == (116, 29)
    assert all(entry.n_trials >= 10 and entry.seeds[1] <= LAST_SEED for entry in entries)
    assert all(entry.success == (entry.n_success >= 0.8 * entry.n_trials) for entry in entries)
    assert len({entry.seeds for entry in entries}) == 116


def test_a_shipped_entry_is_what_physics_says_again() -> None:
    """The first trial of an entry of the shipped file, repeated: its outcome fits the entry."""
    entry = next(item for item in ExperienceStore.open().all() if item.id == "cube-01")
    outcome = run_trial("wood_cube", category_plans()[6].recipes[0], entry.seeds[0], entry.strategy.force)
    assert outcome.success == entry.success
