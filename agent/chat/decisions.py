"""The person's word on a motion that waits: approve, reject, other numbers, or plain words."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from agent.chat.turns import Turns, refused
from kb.errors import BadInputError

if TYPE_CHECKING:
    from agent.events import BaseStep


class Decisions(Turns):
    """Part of a conversation: what it does while a motion waits."""

    def approve(self) -> Iterator[BaseStep]:
        """Lets the pending motion happen."""
        yield from self.decide({"verdict": "approve"})

    def reject(self) -> Iterator[BaseStep]:
        """Refuses the pending motion."""
        yield from self.decide({"verdict": "reject"})

    def edit(self, **changes: Any) -> Iterator[BaseStep]:
        """Lets the pending motion happen with other numbers.

        Args:
            changes: For a grasp fields of `kb.grasp.Grasp`, within the hand's limits; for a placing x and y [m] from the
                robot's base, on the table.
        """
        from agent.approval import edited

        waiting = self.pending
        try:
            if waiting is None:
                raise BadInputError("nothing waits for approval", where="edit")
            decision = edited(waiting, changes)
        except BadInputError as error:
            yield refused(error)
            return
        yield from self.decide(decision.model_dump(mode="json"))

    def decide(self, decision: dict[str, Any]) -> Iterator[BaseStep]:
        """The person's word on the pending motion, as plain data of `agent.approval.Decision`."""
        from langgraph.types import Command

        if self.agent.waiting is None:
            yield refused(BadInputError("nothing waits for approval", where="approval"))
            return
        yield from self._turn(Command(resume=decision))

    def _answered(self, words: str) -> Iterator[BaseStep]:
        """What was said while a motion waits: yes, no, how else, or why."""
        from agent.chat.answered import about_pending, verdict

        said = verdict(words, self.state)
        if said is not None:
            yield from self.decide(said)
        else:
            yield about_pending(words, self.state, self.agent.context.tools.store)
