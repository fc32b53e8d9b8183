"""What the person wants remembered beyond this conversation: proven grasps per category, in a LangGraph store on SQLite."""

from __future__ import annotations

import sqlite3
from pathlib import Path
from typing import Any

from agent import phrases
from agent.attempt import Attempt
from agent.episode import item_of
from agent.state import State
from kb.errors import EnvironmentFaultError
from memory import EpisodicMemory, MemoryItem, merge_memory

ROOT = "grasps"
"""First part of the namespace; the second is the category."""
KEPT = 10
"""Grasps kept per category; the latest stay."""
MANY = 1000
"""More are never read at once."""


def open_store(path: Path | None) -> Any:
    """The store: on disk, or in memory without a path.

    Raises:
        EnvironmentFaultError: the file cannot be used.
    """
    if path is None:
        from langgraph.store.memory import InMemoryStore

        return InMemoryStore()
    from langgraph.store.sqlite import SqliteStore

    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        connection = sqlite3.connect(str(path), check_same_thread=False, isolation_level=None, timeout=30.0)
        store = SqliteStore(connection)
        store.setup()
    except (OSError, sqlite3.Error) as error:
        raise EnvironmentFaultError(
            f"cannot use the memory in {path}: {error}", mend="set RAGVLM_HOME to a folder that can be written"
        ) from error
    return store


def keep(store: Any, state: State, thread: str) -> str:
    """Keeps what worked last, and says so; or says why there is nothing to keep."""
    attempt = next((a for a in reversed(state.attempts) if a.claimed), None)
    if attempt is None:
        return "There is nothing to remember yet: nothing has worked in this conversation."
    item = item_of(attempt, _tries(state, attempt)).model_copy(
        update={"source": f"{thread}, attempt {attempt.number + 1}"}
    )
    known = _items(store, item.category)
    order = 1 + max((entry.order for _, entry in known), default=-1)
    store.put((ROOT, item.category), f"{order:09d}", item.model_copy(update={"order": order}).model_dump(mode="json"))
    for key, _ in sorted(known)[: max(0, len(known) + 1 - KEPT)]:
        store.delete((ROOT, item.category), key)
    name, used = phrases.plain(item.category), attempt.plan.grasp.force
    alone = f" ({used:.1f} N beside what stood near it)" if abs(used - item.force) >= 0.05 else ""
    return (
        f"I will remember for every later conversation how I took the {name}: {item.type} grasp of the {item.region} "
        f"with {item.force:.1f} N{alone}, opening {item.aperture * 1000:.0f} mm."
    )


def forget(store: Any, category: str | None) -> str:
    """Drops what is kept of a category, or everything."""
    gone = 0
    for namespace in store.list_namespaces(prefix=(ROOT,), limit=MANY):
        if category is not None and namespace[1] != category.replace(" ", "_"):
            continue
        for item in store.search(namespace, limit=MANY):
            store.delete(namespace, item.key)
            gone += 1
    about = f" about the {phrases.plain(category)}" if category else ""
    return f"Forgotten: {gone} grasp{'s' if gone != 1 else ''}{about}." if gone else f"I had kept nothing{about}."


def kept(store: Any) -> tuple[MemoryItem, ...]:
    """All that is kept, by category and age."""
    found: list[MemoryItem] = []
    for namespace in sorted(store.list_namespaces(prefix=(ROOT,), limit=MANY)):
        found += [item for _, item in sorted(_items(store, namespace[1]), key=lambda pair: pair[0])]
    return tuple(found)


def as_memory(store: Any) -> EpisodicMemory:
    """What is kept, as an episodic memory to begin a turn with."""
    return merge_memory(EpisodicMemory(), EpisodicMemory(items=kept(store)))


def recalled(items: tuple[MemoryItem, ...], lasting: tuple[MemoryItem, ...]) -> str:
    """What is remembered, in words."""
    lines = [f"In this conversation: {_line(item)}" for item in items if item not in lasting]
    lines += [f"For good: {_line(item)}" for item in lasting]
    return "\n".join(lines) or "I remember nothing yet. After something worked, say: remember that."


def _line(item: MemoryItem) -> str:
    return (
        f"{phrases.plain(item.category)}: {item.type} grasp of the {item.region}, {item.force:.1f} N, "
        f"opening {item.aperture * 1000:.0f} mm ({item.source or 'this conversation'})."
    )


def _items(store: Any, category: str) -> list[tuple[str, MemoryItem]]:
    """Key and item; what cannot be read any more (another version) is left alone."""
    found: list[tuple[str, MemoryItem]] = []
    for entry in store.search((ROOT, category), limit=MANY):
        try:
            found.append((entry.key, MemoryItem.model_validate(entry.value)))
        except ValueError:
            continue
    return found


def _tries(state: State, attempt: Attempt) -> int:
    return sum(a.turn == attempt.turn and a.goal == attempt.goal for a in state.attempts)
