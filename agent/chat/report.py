"""What was done in this conversation, turn by turn, from the recorded attempts."""

from __future__ import annotations

from agent import phrases
from agent.attempt import Attempt
from agent.kept_force import held_with
from agent.state import State


def report(state: State) -> str:
    """A line for each attempt, and what is in the hand."""
    if not state.attempts:
        moved = "" if not state.displaced else f" I have put {len(state.displaced)} things somewhere."
        return f"I have grasped nothing yet in this conversation.{moved}"
    lines = [_line(attempt) for attempt in state.attempts]
    good = sum(a.claimed for a in state.attempts)
    head = f"{len(state.attempts)} attempt{'s' if len(state.attempts) != 1 else ''}, {good} of them held:"
    held = f"In my hand: the {phrases.plain(state.held.category)}." if state.held is not None else "My hand is empty."
    return "\n".join([head, *lines, held])


def _line(attempt: Attempt) -> str:
    grasp = attempt.plan.grasp
    level = f", level {attempt.level}" if attempt.level else ""
    return (
        f"{attempt.number + 1}. {phrases.plain(attempt.target.category)}: {grasp.type} grasp of the {attempt.plan.region}, "
        f"{held_with(attempt):.1f} N{level}: {phrases.ended(attempt)}."
    )
