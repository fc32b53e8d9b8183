"""What grounding comes to: an update of the state and the steps to tell, or a plain word that ends the turn."""

from __future__ import annotations

from dataclasses import dataclass

from agent import events
from agent.goal import Goal
from agent.state import State, Update


@dataclass(frozen=True)
class Grounded:
    """The update of the state, and the steps to tell."""

    update: Update
    steps: tuple[events.BaseStep, ...] = ()


def say(state: State, text: str) -> Grounded:
    """Says why nothing is done; the turn is over."""
    update = Update(refused=True, answer=text, agenda=(), goals=failed(state, text))
    return Grounded(update, (events.Grounding(text=text, goal=state.current),))


def failed(state: State, note: str) -> tuple[Goal, ...]:
    """The goals, those that were open with the note why they are not done."""
    return tuple(
        g.model_copy(update={"status": "failed", "note": note}) if g.status == "open" else g for g in state.goals
    )
