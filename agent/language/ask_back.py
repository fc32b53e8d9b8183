"""What a clause that is not understood comes back as: a question about what is missing, or a refusal."""

from __future__ import annotations

from dataclasses import dataclass

from agent.goal import Goal

CANNOT_READ = (
    "I did not understand that. I can pick things up, put them somewhere, clear the table, sort things, and answer "
    'questions about what I see and why I did what I did. Say "help" for examples.'
)


@dataclass(frozen=True)
class AskBack:
    """The clause is understood but for one thing, which is asked."""

    question: str
    goal: Goal
    """What is understood so far."""
