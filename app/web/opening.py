"""Conversations as the page opens them, and the points to which one can go back in them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from agent.chat import Conversation
    from app.options import RunOptions

MAX_POINTS, MAX_BACK = 300, 12
"""Saved steps looked through for the ends of turns, and ends offered to go back to."""


def open_conversation(options: RunOptions) -> Conversation:
    """The conversation that the options describe.

    Raises:
        RagVlmError: as `Conversation.open`.
    """
    from agent.chat import Conversation as Talk

    return Talk.open(
        options.scene, options.seed, thread=options.thread, asks=options.approve, brain=options.brain,
        perception=options.perception, evaluator=options.evaluator, configuration=options.configuration,
        dry_run=options.dry_run, base_url=options.base_url,
    )  # fmt: skip


def ends_of_turns(talk: Conversation | None) -> list[dict[str, Any]]:
    """The ends of the latest turns, to which one can go back; nothing while a turn is running."""
    if talk is None or talk.busy:
        return []
    # Of several saved steps between two turns the first one is the end of the turn itself.
    ended = {point.turn: point for point in talk.history(MAX_POINTS) if not point.next and point.said}
    return [{"id": p.id, "said": p.said[:60], "turn": p.turn + 1} for p in ended.values()][:MAX_BACK]
