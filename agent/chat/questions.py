"""Questions about what was done, answered by tools of the conversation: from the record or by simulating."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from agent.chat.decisions import Decisions
from agent.chat.turns import refused
from agent.conversation import begin
from kb.errors import RagVlmError

if TYPE_CHECKING:
    from agent.chat.call import ToolName
    from agent.events import BaseStep


class Questions(Decisions):
    """Part of a conversation: why, compare, what if, and the memory."""

    def why(self, attempt: int | None = None) -> Iterator[BaseStep]:
        """Why a grasp was chosen (`Explained`): of the attempt of that number, or the last."""
        yield from self._use("why", "why", {} if attempt is None else {"attempt": attempt})

    def compare(self, first: int | None = None, second: int | None = None) -> Iterator[BaseStep]:
        """Two attempts side by side (`Compared`), by their numbers (`state.attempts[i].number`); the last two by default."""
        given = {"first": first, "second": second}
        yield from self._use("compare", "compare", {k: v for k, v in given.items() if v is not None})

    def whatif(self, attempt: int | None = None, **changes: Any) -> Iterator[BaseStep]:
        """Simulates an attempt otherwise, from the saved moment before it (`WhatIf`); the world stays as it is.

        Args:
            attempt: Number of the attempt; the last by default.
            changes: force [N], aperture [m], yaw [rad], speed, type, approach ("top", "tilted", "side"), region,
                candidate (a name, or "other").
        """
        from agent.chat.whatif import check_changes

        try:
            check_changes(changes)
        except RagVlmError as error:
            yield refused(error)
            return
        said = " ".join(f"{name}={value}" for name, value in changes.items())
        values = changes if attempt is None else {**changes, "attempt": attempt}
        yield from self._use("whatif", f"what if {said}", values)

    def remember(self) -> Iterator[BaseStep]:
        """Keeps what worked last for every later conversation."""
        yield from self._use("remember", "remember that", {})

    def forget(self, category: str | None = None) -> Iterator[BaseStep]:
        """Drops what was kept for later conversations, of a category or all."""
        yield from self._use("forget", "forget what you remember", {} if category is None else {"category": category})

    def recall(self) -> Iterator[BaseStep]:
        """Says what is remembered of this conversation and for good."""
        yield from self._use("recall", "what do you remember", {})

    def report(self) -> Iterator[BaseStep]:
        """Says what was done in this conversation."""
        yield from self._use("report", "report", {})

    def _use(self, tool: ToolName, words: str, values: dict[str, Any]) -> Iterator[BaseStep]:
        from agent.chat.call import Call

        if self.pending is not None:
            yield from self._answered(words)
            return
        call = Call(tool=tool, words=words, values=values)
        yield from self._turn({**begin(words), "calls": (call,)})
