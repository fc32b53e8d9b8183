"""Lets a person hear what a model says while it says it: inert words that count for nothing until the gate has judged them."""

from __future__ import annotations

from agent import events
from agent.brains.words import words_so_far
from agent.context import AgentContext

EVERY_S = 0.1
"""Shortest time between two tellings [s]: a fast model must not flood a page."""


class Aloud:
    """The replies to one question, told as they grow."""

    def __init__(self, context: AgentContext, role: str, goal: int | None) -> None:
        """Args: listener and clock; what is asked for; and whose goal it serves."""
        self._context, self._role, self._goal = context, role, goal
        self._reply = self._told = ""
        self._at = 0.0

    def hear(self, reply: str) -> None:
        """Takes a reply so far; a shorter one than before is a new trial."""
        self._reply = reply
        now = self._context.clock()
        if now - self._at >= EVERY_S:
            self._at = now
            self._tell()

    def end(self) -> None:
        """The reply is whole, or will never be: what was not told yet is told."""
        self._tell()
        self._reply = self._told = ""
        self._at = 0.0

    def _tell(self) -> None:
        from agent.chat.heard import heard

        words = heard(words_so_far(self._role, self._reply))
        if words != self._told:
            self._told = words
            self._context.emit(events.Saying(text=words, goal=self._goal, role=self._role))
