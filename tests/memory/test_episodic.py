"""Lookup order and writing of episodic memory (ledger A6, G22)."""

from __future__ import annotations

from kb.priors import prior
from kb.taxonomy import superclass
from memory import EpisodicMemory, MemoryItem, merge_memory, recall, remember
from memory.episodic import DEFAULT_CAPACITY


def item(category: str, **changes: object) -> MemoryItem:
    affordance = prior(category).affordance
    fields: dict[str, object] = {
        "category": category,
        "affordance": affordance,
        "region": affordance.region,
        "type": "pinch",
        "tilt": 0.0,
        "force": 12.0,
        "depth": 0.5,
        "aperture": 0.08,
    }
    return MemoryItem.model_validate(fields | changes)


def memory_of(*items: MemoryItem) -> EpisodicMemory:
    memory = EpisodicMemory()
    for one in items:
        memory = remember(memory, one)
    return memory


def look_up(memory: EpisodicMemory, category: str) -> tuple[str, str] | None:
    found = recall(memory, category, prior(category).affordance, superclass)
    return None if found is None else (found.item.category, found.match)


def test_lookup_prefers_category_then_superclass_then_affordance() -> None:
    """A cup finds the cup; without one the mug (drinkware); the apple finds the ball (wrappable body) only last."""
    memory = memory_of(item("cup"), item("mug"), item("tennis_ball"), item("banana"))
    assert look_up(memory, "cup") == ("cup", "category")
    assert look_up(memory_of(item("tennis_ball"), item("mug")), "cup") == ("mug", "superclass")
    assert look_up(memory, "apple") == ("banana", "superclass")
    assert look_up(memory_of(item("tennis_ball"), item("cup")), "apple") == ("tennis_ball", "affordance")


def test_nothing_fitting_gives_nothing() -> None:
    """A cup's grasp says nothing about a bottle; an empty memory says nothing at all."""
    assert look_up(memory_of(item("cup")), "bottle") is None
    assert look_up(EpisodicMemory(), "cup") is None


def test_same_type_with_another_region_is_not_transferred() -> None:
    """A wine glass is held by its stem: that is no advice for another FRAGILE thing that is held by its neck."""
    memory = memory_of(item("wine_glass", superclass="other"))
    assert recall(memory, "flask", prior("vase").affordance, superclass) is None


def test_two_unknown_things_are_not_the_same_category() -> None:
    """Unknown things never matches as a category; the affordance still may."""
    memory = memory_of(item("unknown"))
    found = recall(memory, "unknown", prior("unknown").affordance, superclass)
    assert found is not None
    assert found.match == "affordance"


def test_the_latest_of_several_counts() -> None:
    """Of two cups the grasp remembered last is recalled, whatever the order of the stored tuple."""
    memory = memory_of(item("cup", force=10.0), item("cup", force=15.0))
    for stored in (memory, EpisodicMemory(items=memory.items[::-1])):
        found = recall(stored, "cup", prior("cup").affordance, superclass)
        assert found is not None
        assert found.item.force == 15.0


def test_remembering_numbers_the_items() -> None:
    """Each remembered item gets the next running number; remembering the same stored item changes nothing."""
    memory = memory_of(item("cup"), item("bowl"), item("apple"))
    assert [one.order for one in memory.items] == [0, 1, 2]
    assert remember(memory, memory.items[1]) == memory


def test_the_memory_is_bounded_and_keeps_the_latest() -> None:
    """Beyond the capacity the oldest items go."""
    full = EpisodicMemory(items=tuple(item("cup", order=i) for i in range(DEFAULT_CAPACITY)))
    grown = merge_memory(full, item("bowl", order=DEFAULT_CAPACITY))
    assert len(grown) == DEFAULT_CAPACITY
    assert grown.items[0].order == 1
    assert grown.items[-1].category == "bowl"
