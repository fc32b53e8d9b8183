"""HAA-RAG on knowledge bases made for one question each."""

from __future__ import annotations

import numpy as np
import pytest

from kb.errors import BadInputError, EnvironmentFaultError
from kb.experience import Experience
from kb.priors import prior
from kb.switches import Switches
from tests.experience_fixtures import DIM, make_experience, make_store
from tools.context import ToolContext
from tools.retrieve_haarag import RetrieveArgs, affordance_similarity, retrieve_haarag

TABLE = (
    "cup",
    "apple",
    "bottle",
    "banana",
    "bowl",
    "cube",
    "vase",
    "wine_glass",
    "screwdriver",
    "smartphone",
    "tennis_ball",
    "block",
)
FLAT = (1.0,) * DIM


@pytest.fixture(autouse=True)
def _index_in_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RAGVLM_CACHE", "memory")


def query(category: str, **changes: object) -> RetrieveArgs:
    return RetrieveArgs.model_validate(
        {"category": category, "affordance": prior(category).affordance, "embedding": FLAT, **changes}
    )


def context_of(entries: list[Experience] | None = None, **switches: object) -> ToolContext:
    return ToolContext(store=make_store(entries), switches=Switches.model_validate(switches))


def similarity(one: str, other: str) -> float:
    return affordance_similarity(prior(one).affordance, prior(other).affordance)


def test_similarities_are_those_of_the_ledger() -> None:
    """Table I gives cup-bowl 0.35, apple-bottle 0.30, cube-ball 0.30, mug-vase 0.075; equal types at least 0.77."""
    assert similarity("cup", "bowl") == pytest.approx(0.35)
    assert similarity("apple", "bottle") == pytest.approx(0.30)
    assert similarity("cube", "tennis_ball") == pytest.approx(0.30)
    assert similarity("mug", "vase") == pytest.approx(0.075)
    for one in TABLE:
        for other in TABLE:
            if prior(one).affordance.type == prior(other).affordance.type and "FRAGILE" != prior(one).affordance.type:
                assert similarity(one, other) >= 0.77 - 1e-9


@pytest.mark.parametrize("category", TABLE)
def test_each_table_object_finds_its_own_affordance_first(category: str) -> None:
    """With true descriptors e_1 has the query's affordance type and region for all 12 objects: P@1 = 12/12."""
    best = retrieve_haarag(query(category), context_of()).best()
    assert best is not None
    assert best.experience.affordance.type == prior(category).affordance.type
    assert best.experience.affordance.region == prior(category).affordance.region


def test_the_funnel_counts_every_level() -> None:
    """Cup: 116 entries, 16 of drinkware pass level 1, all of them level 2, three are returned; no fallback."""
    funnel = retrieve_haarag(query("cup"), context_of()).funnel
    assert (funnel.total, funnel.level1, funnel.level2, funnel.level3) == (116, 16, 16, 3)
    assert not funnel.fallback


def test_a_score_exactly_at_the_threshold_survives() -> None:
    """Cube asked, only balls known: s_aff = 0.30 = tau passes level 2 despite rounding (ledger G14d)."""
    entries = [make_experience(f"b{i}", "tennis_ball") for i in range(4)]
    found = retrieve_haarag(query("cube"), context_of(entries))
    assert found.funnel.level2 == 4
    assert found.top[0].s_aff == pytest.approx(0.3)


def test_below_the_threshold_nothing_is_returned() -> None:
    """Mug asked, only vases known: s_aff = 0.075 is discarded at level 2 and there is no experience."""
    found = retrieve_haarag(query("mug"), context_of([make_experience(f"v{i}", "vase") for i in range(4)]))
    assert (found.funnel.level1, found.funnel.level2, found.top) == (4, 0, ())


def test_an_unknown_category_falls_back_to_every_entry() -> None:
    """Outside every superclass fewer than three survive level 1, so all 116 are admitted with s_cat = 0 (G14b)."""
    args = query("bottle").model_copy(update={"category": "teapot"})
    found = retrieve_haarag(args, context_of())
    assert found.funnel.fallback
    assert found.funnel.level1 == 116
    assert {item.s_cat for item in found.top} == {0.0}
    assert found.best() is not None
    strict = retrieve_haarag(args, context_of(strict_l1=True))
    assert (strict.top, strict.funnel.fallback) == ((), False)


def test_two_survivors_keep_their_category_score_in_the_fallback() -> None:
    """With two exact entries the fallback opens, and the two still score s_cat = 1."""
    entries = [make_experience(f"k{i}", "key", embedding=FLAT) for i in range(2)]
    entries += [make_experience(f"p{i}", "banana", embedding=FLAT) for i in range(5)]
    found = retrieve_haarag(query("key"), context_of(entries))
    assert found.funnel.fallback
    assert [item.s_cat for item in found.top if item.experience.category == "key"] == [1.0, 1.0]


def test_more_than_thirty_exact_entries_keep_the_highest_affordance_scores() -> None:
    """Of 40 exact entries the 30 with the highest s_aff pass level 1 (ledger G14c)."""
    entries = [make_experience(f"c{i:02d}", "cup", fragility=i / 40) for i in range(40)]
    args = query("cup", k=50)
    kept = retrieve_haarag(args, context_of(entries)).top
    assert len(kept) == 30
    nearest = sorted(range(40), key=lambda i: (abs(i / 40 - 0.3), i))[:30]
    assert {item.experience.id for item in kept} == {f"c{i:02d}" for i in nearest}


def test_failures_are_penalised_before_the_cut_and_returned_as_warnings() -> None:
    """Four equal entries, two failed: successes come first, the failures score 0.7 of them and stand in `avoid`."""
    entries = [make_experience(f"c{i}", "cup", success=i > 1, embedding=FLAT) for i in range(4)]
    found = retrieve_haarag(query("cup"), context_of(entries))
    assert [item.experience.id for item in found.top] == ["c2", "c3", "c0"]
    assert found.top[2].score == pytest.approx(0.7 * found.top[0].score)
    assert [item.experience.id for item in found.avoid] == ["c0", "c1"]


def test_a_success_is_returned_even_behind_three_better_failures() -> None:
    """Three failures outscore the only success: it takes the last place, so that e_1 exists (ledger G14f)."""
    entries = [make_experience(f"c{i}", "cup", success=False, embedding=FLAT) for i in range(3)]
    entries.append(make_experience("mug", "mug", embedding=(1.0, *(0.0,) * (DIM - 1)), material="metal"))
    found = retrieve_haarag(query("cup"), context_of(entries))
    assert [item.experience.id for item in found.top] == ["c0", "c1", "mug"]
    best = found.best()
    assert best is not None
    assert best.experience.id == "mug"


def test_ties_are_broken_by_affordance_then_looks_then_id() -> None:
    """Entries equal in every score come in the order of their ids (ledger G14c)."""
    entries = [make_experience(name, "cup", embedding=FLAT) for name in ("z", "a", "m")]
    assert [item.experience.id for item in retrieve_haarag(query("cup"), context_of(entries)).top] == ["a", "m", "z"]


def test_random_in_category_draws_from_the_category_by_the_generator_alone() -> None:
    """The ablation returns exact-category entries, the same for the same seed and others for another."""
    context = context_of(retrieval="random_in_category")
    drawn = [retrieve_haarag(query("cup"), context.with_rng(np.random.default_rng(seed))).top for seed in (1, 1, 2, 3)]
    assert all(item.experience.category == "cup" for top in drawn for item in top)
    assert drawn[0] == drawn[1]
    assert len({tuple(item.experience.id for item in top) for top in drawn}) > 1


def test_switched_off_it_returns_nothing() -> None:
    """`retrieval: none` returns an empty answer whose funnel says so."""
    found = retrieve_haarag(query("cup"), context_of(retrieval="none"))
    assert (found.top, found.funnel.level1) == ((), 0)


def test_without_a_picture_the_visual_level_is_zero() -> None:
    """An empty embedding gives s_vis = 0 for every entry instead of an error."""
    found = retrieve_haarag(query("cup", embedding=()), context_of())
    assert {item.s_vis for item in found.top} == {0.0}


def test_a_wrong_embedding_length_is_refused() -> None:
    """A query of another length names both lengths."""
    with pytest.raises(BadInputError, match=f"3 numbers.*{DIM}"):
        retrieve_haarag(query("cup", embedding=(1.0, 0.0, 0.0)), context_of())


def test_another_embedder_is_refused_with_the_mend() -> None:
    """Embeddings of two embedders are never compared; the message says how to rebuild."""

    class Other:
        name = "clip-vit-l14"
        dim = DIM

        def embed(self, rgb: object, mask: object, depth: object = None) -> np.ndarray:
            return np.ones(DIM)

    context = context_of()
    context.embedder = Other()
    with pytest.raises(EnvironmentFaultError, match="ragvlm kb build"):
        retrieve_haarag(query("cup"), context)


def test_without_a_store_it_says_what_to_restore() -> None:
    """A session without a knowledge base is an environment fault, not a crash."""
    with pytest.raises(EnvironmentFaultError, match="knowledge base"):
        retrieve_haarag(query("cup"), ToolContext())
