"""A placing in words, and what the robot believes of it by what it sensed while it moved (`agent.seen_placed` looks)."""

from __future__ import annotations

import math

from agent.agenda import NO_PLACE
from agent.attempt import Held
from agent.goal import Goal
from agent.phrases import place_words, plain, sentence
from kb.base import Vec2
from kb.sensing import Sensing


def putting(goal: Goal, held: Held) -> str:
    """What is to be put where, as in "put the cup on the left"."""
    if goal.placement is not None and goal.placement.kind == "hand_over":
        return f"hand you the {plain(held.category)}"
    return f"put the {plain(held.category)} {place_words(goal)}"


def placing_thought(goal: Goal, held: Held, point: Vec2 | None) -> str:
    """What a person is told before a placing."""
    if point is None:
        return sentence(f"I would {putting(goal, held)}")
    return (
        f"I would {putting(goal, held)}: {point[0] * 100:.0f} cm in front of my base, "
        f"{abs(point[1]) * 100:.0f} cm to your {'right' if point[1] >= 0 else 'left'}."
    )


def placing(goal: Goal, held: Held) -> str:
    """The placing motion that begins."""
    return f"place_object: the {plain(held.category)} {place_words(goal)}."


RETURNED = 0.04
"""Up to this distance from where it was a thing is back [m]; the observer judges by the same (sim.verdict_place)."""


def placed(sensing: Sensing, goal: Goal, wanted: Vec2 | None = None) -> tuple[bool, str]:
    """Whether the robot believes that it put the thing where it was to go, and in words.

    Args:
        sensing: Of the placing motion.
        goal: The goal in work.
        wanted: Where a thing that is to go back stood [m].
    """
    if sensing.stopped_by == "stop":
        return False, "I was stopped while placing it."
    if sensing.lost:
        return False, "It slipped out of my hand on the way."
    let_go = sensing.phase in ("release", "retreat", "home")
    # What stopped the arm after it had let go says nothing against the place: a look will tell.
    if sensing.stopped_by == "path" and not let_go:
        return False, NO_PLACE
    if sensing.stopped_by is not None and not let_go:
        return False, f"Placing it was ended by {plain(sensing.stopped_by)}."
    kind = goal.placement.kind if goal.placement else "aside"
    if kind == "hand_over":
        return True, "I hold it out to you."
    if not let_go:
        return False, "I could not put it down."
    if kind == "back" and wanted is not None and sensing.aimed_at is not None:
        off = math.dist(wanted, sensing.aimed_at)
        if off > RETURNED:
            return (
                False,
                f"I put it down {off * 100:.0f} cm from where it was: its place was not free or out of my reach.",
            )
    return True, f"I put it {place_words(goal)}."
