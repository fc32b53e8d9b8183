"""Episodic memory M as an immutable value with a reducer, and its lookup (Sec. IV-C; ledger A6, G22).

Items form a set: merging is associative, commutative and idempotent, so that parallel branches, replays and resumed runs
reach the same memory.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

from kb.affordance import AffordanceDescriptor
from kb.base import Noun
from memory.item import MemoryItem

Match = Literal["category", "superclass", "affordance"]

DEFAULT_CAPACITY = 200
"""Items that a session keeps at most; the latest stay."""


class EpisodicMemory(Noun):
    """Proven grasps of a session, in a canonical order without duplicates."""

    items: tuple[MemoryItem, ...] = ()

    def __len__(self) -> int:
        return len(self.items)


class Recollection(Noun):
    """What a lookup found, and how."""

    item: MemoryItem
    match: Match
    """Which step of the lookup order fitted."""


def remember(memory: EpisodicMemory, item: MemoryItem) -> EpisodicMemory:
    """M <- M + {item}; an item without a running number above all others gets the next one."""
    newest = max((known.order for known in memory.items), default=-1)
    if item in memory.items:
        return memory
    numbered = item if item.order > newest else item.model_copy(update={"order": newest + 1})
    return merge_memory(memory, EpisodicMemory(items=(numbered,)))


def merge_memory(left: EpisodicMemory, right: EpisodicMemory | MemoryItem | None) -> EpisodicMemory:
    """Reducer of the agent's state: the union of both, canonical, cut to the latest `DEFAULT_CAPACITY` items.

    Cutting keeps the greatest by (order, text), which does not depend on the order of merging.
    """
    if right is None:
        return left
    added = (right,) if isinstance(right, MemoryItem) else right.items
    union = {_key(item): item for item in (*left.items, *added)}
    kept = [union[key] for key in sorted(union)][-DEFAULT_CAPACITY:]
    return EpisodicMemory(items=tuple(kept))


def recall(
    memory: EpisodicMemory,
    category: str,
    affordance: AffordanceDescriptor,
    superclass: Callable[[str], str | None],
) -> Recollection | None:
    """The latest item that fits: exact category, else superclass, else affordance type with the same region (G22).

    Args:
        memory: What is remembered.
        category: Category of the object to be grasped; "unknown" never matches as a category.
        affordance: Its descriptor, as perceived.
        superclass: Gives the superclass of a category, or None (from `kb.taxonomy`).
    """
    wanted = superclass(category)
    tests: tuple[tuple[Match, Callable[[MemoryItem], bool]], ...] = (
        ("category", lambda item: category != "unknown" and item.category == category),
        ("superclass", lambda item: wanted is not None and (item.superclass or superclass(item.category)) == wanted),
        (
            "affordance",
            lambda item: item.affordance.type == affordance.type and item.affordance.region == affordance.region,
        ),
    )
    for match, fits in tests:
        found = [item for item in memory.items if fits(item)]
        if found:
            return Recollection(item=max(found, key=_key), match=match)
    return None


def _key(item: MemoryItem) -> tuple[int, str]:
    return item.order, item.model_dump_json()
