"""The conversation that a command's options describe, the same for the terminal and the page."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from agent.chat import Conversation
from agent.chat.events import Finished

if TYPE_CHECKING:
    from agent.events import BaseStep
    from app.learning import Learner
    from app.options import RunOptions


class LearningConversation(Conversation):
    """Enters the outcome of each turn into a learning knowledge base (`--learn`)."""

    learner: Learner | None = None

    def _turn(self, entry: Any) -> Iterator[BaseStep]:
        """As every turn; what was learnt from it is told before its end."""
        for event in super()._turn(entry):
            if isinstance(event, Finished) and self.learner is not None:
                yield from self.learner.after(self.agent)
            yield event


def open_conversation(options: RunOptions, thread: str | None) -> Conversation:
    """Opens it.

    Args:
        options: What to build.
        thread: Name under which it is kept, or None to forget it with the process.

    Raises:
        RagVlmError: as `Conversation.open`, or a knowledge base that cannot be used.
    """
    from app.learning import Learner, store_of

    learner = Learner(options) if options.learn else None
    talk = LearningConversation.open(
        options.scene,
        options.seed,
        thread=thread,
        asks=options.approve,
        brain=options.brain,
        perception=options.perception,
        evaluator=options.evaluator,
        configuration=options.configuration,
        dry_run=options.dry_run,
        base_url=options.base_url,
        store=store_of(options) if learner is None else learner.store,
        embedder=options.embedder,
        learn=options.learn,
        record_brain=options.record_brain,
        brain_pictures=options.brain_pictures,
        aloud=True,
    )
    talk.learner = learner
    return talk
