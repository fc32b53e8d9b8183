"""Laws of HAA-RAG for arbitrary queries and knowledge bases (ledger A2, G14-G14g)."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from kb.affordance import AffordanceDescriptor
from kb.experience import Experience
from kb.switches import Switches
from kb.taxonomy import CATEGORIES
from kb.vocabulary import AFFORDANCE_TYPES, MATERIALS, REGIONS
from tests.experience_fixtures import DIM, make_experience, make_store
from tools.context import ToolContext
from tools.retrieve_haarag import (
    K1,
    TAU_AFFORDANCE,
    RetrieveArgs,
    affordance_similarity,
    fused_score,
    retrieve_haarag,
)

descriptors = st.builds(
    AffordanceDescriptor,
    type=st.sampled_from(AFFORDANCE_TYPES),
    material=st.sampled_from(MATERIALS),
    fragility=st.floats(0.0, 1.0),
    region=st.sampled_from(REGIONS),
)
embeddings = st.lists(st.floats(0.0, 1.0), min_size=DIM, max_size=DIM).map(tuple)
categories = st.sampled_from([*CATEGORIES, "thermos", "teapot", "unknown"])


@st.composite
def knowledge_bases(draw: st.DrawFn) -> list[Experience]:
    rows = draw(st.lists(st.tuples(categories, descriptors, st.booleans(), embeddings), min_size=1, max_size=40))
    return [
        make_experience(f"e{i:02d}", category, success=success, embedding=embedding).model_copy(
            update={"affordance": descriptor}
        )
        for i, (category, descriptor, success, embedding) in enumerate(rows)
    ]


queries = st.builds(RetrieveArgs, category=categories, affordance=descriptors, embedding=embeddings)
few = settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


@pytest.fixture(autouse=True)
def _index_in_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RAGVLM_CACHE", "memory")


def context_of(entries: list[Experience], **switches: object) -> ToolContext:
    return ToolContext(store=make_store(entries), switches=Switches.model_validate(switches))


@given(a=descriptors, b=descriptors)
def test_affordance_similarity_is_symmetric_and_between_zero_and_one(
    a: AffordanceDescriptor, b: AffordanceDescriptor
) -> None:
    """Eq. (1): s_aff(a, b) = s_aff(b, a), in [0, 1], and 1 exactly for equal descriptors."""
    value = affordance_similarity(a, b)
    assert value == affordance_similarity(b, a)
    assert -1e-12 <= value <= 1.0 + 1e-12
    assert affordance_similarity(a, a) == pytest.approx(1.0)


@given(st.floats(0, 1), st.floats(0, 1), st.floats(0, 1), st.floats(0, 1))
def test_fused_score_grows_with_each_part_and_failures_score_less(
    cat: float, aff: float, vis: float, more: float
) -> None:
    """s_final is monotone in every level's score, lies in [0, 1], and a failure has 0.7 of it."""
    score = fused_score(cat, aff, vis, success=True)
    assert 0.0 <= score <= 1.0 + 1e-12
    assert fused_score(max(cat, more), aff, vis, success=True) >= score
    assert fused_score(cat, max(aff, more), vis, success=True) >= score
    assert fused_score(cat, aff, max(vis, more), success=True) >= score
    assert fused_score(cat, aff, vis, success=False) == pytest.approx(0.7 * score)


@few
@given(entries=knowledge_bases(), args=queries)
def test_scores_lie_between_zero_and_one_and_the_funnel_narrows(entries: list[Experience], args: RetrieveArgs) -> None:
    """Every returned score is in [0, 1] and follows from its parts; each level keeps no more than the one before."""
    found = retrieve_haarag(args, context_of(entries))
    for item in (*found.top, *found.avoid):
        assert item.s_cat in (0.0, 0.5, 1.0)
        assert TAU_AFFORDANCE - 1e-9 <= item.s_aff <= 1.0 + 1e-12
        assert 0.0 <= item.s_vis <= 1.0
        assert item.score == fused_score(item.s_cat, item.s_aff, item.s_vis, success=item.experience.success)
    funnel = found.funnel
    assert funnel.total >= funnel.level1 >= funnel.level2 >= funnel.level3 == len(found.top) <= args.k
    assert funnel.fallback or funnel.level1 <= K1


@few
@given(entries=knowledge_bases(), args=queries, seed=st.integers(0, 2**32 - 1))
def test_the_order_of_the_knowledge_base_does_not_matter(
    entries: list[Experience], args: RetrieveArgs, seed: int
) -> None:
    """Shuffling the entries leaves the whole answer unchanged."""
    shuffled = [entries[i] for i in np.random.default_rng(seed).permutation(len(entries))]
    assert retrieve_haarag(args, context_of(entries)) == retrieve_haarag(args, context_of(shuffled))


@few
@given(entries=knowledge_bases(), args=queries)
def test_the_best_success_has_the_type_asked_for_if_any_success_has(
    entries: list[Experience], args: RetrieveArgs
) -> None:
    """A type-mismatched entry is never e_1 while a matching success passes the levels (ledger G14d, G14f)."""
    everything = retrieve_haarag(args.model_copy(update={"k": 50}), context_of(entries)).top
    successes = [item for item in everything if item.experience.success]
    best = retrieve_haarag(args, context_of(entries)).best()
    assert (best is None) == (not successes)
    if any(item.experience.affordance.type == args.affordance.type for item in successes):
        assert best is not None
        assert best.experience.affordance.type == args.affordance.type


@few
@given(entries=knowledge_bases(), args=queries, which=st.integers(0, 39))
def test_success_never_lowers_a_rank(entries: list[Experience], args: RetrieveArgs, which: int) -> None:
    """Turning one failed entry into a success never moves it down the ranking (contrastive penalty is monotone)."""
    i = which % len(entries)
    wide = args.model_copy(update={"k": 50})

    def rank_of(success: bool) -> int | None:
        changed = [*entries]
        changed[i] = entries[i].model_copy(update={"success": success})
        ids = [item.experience.id for item in retrieve_haarag(wide, context_of(changed)).top]
        return ids.index(entries[i].id) if entries[i].id in ids else None

    as_failure, as_success = rank_of(False), rank_of(True)
    assert (as_failure is None) == (as_success is None)
    if as_failure is not None:
        assert as_success is not None
        assert as_success <= as_failure


@few
@given(entries=knowledge_bases(), args=queries)
def test_strict_level_one_returns_related_categories_only(entries: list[Experience], args: RetrieveArgs) -> None:
    """With `strict_l1` nothing unrelated is returned, and there is no fallback (ledger G14b)."""
    found = retrieve_haarag(args, context_of(entries, strict_l1=True))
    assert not found.funnel.fallback
    assert all(item.s_cat > 0.0 for item in found.top)
