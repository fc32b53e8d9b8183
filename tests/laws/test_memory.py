"""Laws of the reducers of memory and history."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from kb.affordance import AffordanceDescriptor
from kb.taxonomy import CATEGORIES, superclass
from kb.vocabulary import AFFORDANCE_TYPES, FAILURE_TYPES, MATERIALS, REGIONS
from memory import (
    EpisodicMemory,
    HistoryEntry,
    MemoryItem,
    merge_history,
    merge_memory,
    recall,
    remember,
)

descriptors = st.builds(
    AffordanceDescriptor,
    type=st.sampled_from(AFFORDANCE_TYPES),
    material=st.sampled_from(MATERIALS),
    fragility=st.floats(0.0, 1.0),
    region=st.sampled_from(REGIONS),
)
items = st.builds(
    MemoryItem,
    category=st.sampled_from(CATEGORIES),
    affordance=descriptors,
    region=st.sampled_from(REGIONS),
    type=st.sampled_from(["power", "pinch", "side"]),
    tilt=st.floats(0.0, 1.6),
    force=st.floats(1.0, 70.0),
    depth=st.floats(0.0, 1.0),
    aperture=st.floats(0.0, 0.08),
    mass=st.none() | st.floats(0.01, 2.0),
    order=st.integers(0, 6),
)
memories = st.lists(items, max_size=6).map(
    lambda found: merge_memory(EpisodicMemory(), EpisodicMemory(items=tuple(found)))
)
entries = st.builds(
    HistoryEntry,
    goal=st.integers(0, 2),
    attempt=st.integers(0, 3),
    grasp=st.none(),
    failure=st.sampled_from(FAILURE_TYPES),
)
histories = st.lists(entries, max_size=6).map(lambda found: merge_history((), found))
some = settings(max_examples=60, deadline=None)


@some
@given(memories, memories, memories)
def test_merging_memories_is_a_union(a: EpisodicMemory, b: EpisodicMemory, c: EpisodicMemory) -> None:
    """Associative, commutative, idempotent, with the empty memory as neutral element."""
    assert merge_memory(merge_memory(a, b), c) == merge_memory(a, merge_memory(b, c))
    assert merge_memory(a, b) == merge_memory(b, a)
    assert merge_memory(a, a) == a
    assert merge_memory(a, EpisodicMemory()) == merge_memory(a, None) == a


@some
@given(memories)
def test_memories_survive_json(memory: EpisodicMemory) -> None:
    """A memory written as JSON and read back is equal."""
    assert EpisodicMemory.model_validate_json(memory.model_dump_json()) == memory


@some
@given(memories, items)
def test_what_was_just_remembered_is_recalled(memory: EpisodicMemory, item: MemoryItem) -> None:
    """Right after `remember`, asking for the item's category gives its parameters, found by category."""
    found = recall(remember(memory, item.model_copy(update={"order": 0})), item.category, item.affordance, superclass)
    assert found is not None
    assert found.match == "category"
    if item.model_copy(update={"order": 0}) not in memory.items:
        assert found.item.model_copy(update={"order": 0}) == item.model_copy(update={"order": 0})


@some
@given(memories, items)
def test_recall_does_not_depend_on_the_stored_order(memory: EpisodicMemory, item: MemoryItem) -> None:
    """Reversing the tuple leaves the answer unchanged."""
    backwards = EpisodicMemory(items=memory.items[::-1])
    assert recall(memory, item.category, item.affordance, superclass) == recall(
        backwards, item.category, item.affordance, superclass
    )


@some
@given(histories, histories, histories)
def test_merging_histories_is_associative_and_idempotent(
    a: tuple[HistoryEntry, ...], b: tuple[HistoryEntry, ...], c: tuple[HistoryEntry, ...]
) -> None:
    """History's reducer is associative and idempotent, and the left one's word stands."""
    assert merge_history(merge_history(a, b), c) == merge_history(a, merge_history(b, c))
    assert merge_history(a, a) == a
    assert set(a) <= set(merge_history(a, b))
