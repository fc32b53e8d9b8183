"""The 116 experiences that are shipped: composition, trials, and retrieval for the paper's twelve objects."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from kb.experience import SUCCESS_RATE
from kb.priors import prior
from kb.store import ExperienceStore
from tools.context import ToolContext
from tools.retrieve_haarag import RetrieveArgs, retrieve_haarag

TABLE = (
    "cup", "apple", "bottle", "banana", "bowl", "cube", "vase", "wine_glass", "screwdriver", "smartphone",
    "tennis_ball", "block",
)  # fmt: skip


@pytest.fixture(scope="module")
def store() -> ExperienceStore:
    return ExperienceStore.open()


def test_the_composition_is_the_ledgers(store: ExperienceStore) -> None:
    """116 entries: 10 or 6-8 a category, blocks and cubes together 10, pens and keys together 10 (ledger G12)."""
    count = Counter(entry.category for entry in store.all())
    merged = {
        "block": count.pop("block") + count.pop("cube"),
        "small": count.pop("pen") + count.pop("key"),
        **count,
    }
    assert merged == {
        "cup": 10, "mug": 6, "apple": 8, "bottle": 10, "banana": 8, "bowl": 10, "block": 10, "vase": 8,
        "wine_glass": 10, "screwdriver": 10, "smartphone": 8, "tennis_ball": 8, "small": 10,
    }  # fmt: skip


def test_failures_are_a_quarter_and_every_category_has_successes(store: ExperienceStore) -> None:
    """29 of 116 are failures (ledger G12), and no category knows failures only."""
    assert sum(not entry.success for entry in store.all()) == 29
    assert {entry.category for entry in store.all()} == {entry.category for entry in store.all() if entry.success}


def test_every_entry_is_the_outcome_of_physical_trials(store: ExperienceStore) -> None:
    """At least ten trials each, seeds 0-9999, y from the success rate, and failures accounted for by type."""
    for entry in store.all():
        assert entry.n_trials >= 10
        assert entry.success == (entry.n_success / entry.n_trials >= SUCCESS_RATE)
        assert 0 <= entry.seeds[0] <= entry.seeds[1] <= 9999
        assert sum(entry.failures.values()) == entry.n_trials - entry.n_success
        assert np.linalg.norm(entry.embedding) == pytest.approx(1.0, abs=1e-3)
        assert entry.strategy.force_band[0] <= entry.strategy.force <= entry.strategy.force_band[1] or not entry.success


@pytest.mark.parametrize("category", TABLE)
@pytest.mark.parametrize("picture", ["own", "none"])
def test_each_table_object_finds_its_affordance_first(
    store: ExperienceStore, category: str, picture: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """P@1 = 12/12 on affordance type and region with true descriptors, with a picture of the object and without."""
    monkeypatch.setenv("RAGVLM_CACHE", "memory")
    embedding = next(e.embedding for e in store.all() if e.category == category) if picture == "own" else ()
    args = RetrieveArgs(category=category, affordance=prior(category).affordance, embedding=embedding)
    best = retrieve_haarag(args, ToolContext(store=store)).best()
    assert best is not None
    wanted = prior(category).affordance
    assert (best.experience.affordance.type, best.experience.affordance.region) == (wanted.type, wanted.region)
    assert best.experience.success
