"""The points of a conversation to which a page can go back."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from agent.chat import Conversation

MAX_POINTS, MAX_BACK = 300, 12
"""Saved steps looked through for the ends of turns, and ends offered to go back to."""


def ends_of_turns(talk: Conversation | None) -> list[dict[str, Any]]:
    """The ends of the latest turns, to which one can go back; nothing while a turn is running."""
    if talk is None or talk.busy:
        return []
    # Of several saved steps between two turns the first one is the end of the turn itself.
    ended = {point.turn: point for point in talk.history(MAX_POINTS) if not point.next and point.said}
    return [{"id": p.id, "said": p.said[:60], "turn": p.turn + 1} for p in ended.values()][:MAX_BACK]
