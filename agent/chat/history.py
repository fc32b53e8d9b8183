"""The points of a conversation to which one can go back, and going there: both branches stay."""

from __future__ import annotations

from typing import Any

from kb.base import Noun
from kb.errors import BadInputError


class Point(Noun):
    """One saved step."""

    id: str
    """Checkpoint; what `fork` takes."""
    parent: str | None = None
    """The step before it, on its own branch."""
    turn: int = -1
    said: str = ""
    """The utterance that was dealt with."""
    next: str = ""
    """The node that came (or comes) next; empty where a turn had ended."""
    attempts: int = 0
    """Attempts made until then."""
    time: str = ""
    """ISO time of saving."""
    current: bool = False
    """Whether the conversation stands here."""


def points(graph: Any, config: dict[str, Any], limit: int | None = None) -> tuple[Point, ...]:
    """Saved steps, the latest first.

    Args:
        graph: The compiled graph with its checkpointer.
        config: Names the thread.
        limit: How many at most.
    """
    found: list[Point] = []
    for snapshot in graph.get_state_history(_thread(config), limit=limit):
        values, parent = snapshot.values, snapshot.parent_config
        found.append(
            Point(
                id=snapshot.config["configurable"]["checkpoint_id"],
                parent=parent["configurable"]["checkpoint_id"] if parent else None,
                turn=values.get("turn", -1),
                said=values.get("said") or values.get("instruction") or "",
                next=snapshot.next[0] if snapshot.next else "",
                attempts=len(values.get("attempts", ())),
                time=snapshot.created_at or "",
                current=not found,
            )
        )
    return tuple(found)


def go_to(graph: Any, config: dict[str, Any], wanted: str) -> None:
    """Makes a copy of that step the latest of its thread: what follows goes on from there.

    Raises:
        BadInputError: there is no such step (any more).
    """
    known = [point.id for point in points(graph, config)]
    fits = [name for name in known if name == wanted or (len(wanted) >= 4 and name.startswith(wanted))]
    if len(fits) != 1:
        what = f"{len(fits)} saved steps begin with {wanted!r}" if fits else f"there is no saved step {wanted!r}"
        raise BadInputError(what, where="fork", choices=known[:5])
    at = {"configurable": {**_thread(config)["configurable"], "checkpoint_id": fits[0], "checkpoint_ns": ""}}
    graph.update_state(at, None, as_node="__copy__")


def _thread(config: dict[str, Any]) -> dict[str, Any]:
    return {"configurable": {"thread_id": config["configurable"]["thread_id"]}}
