"""What can be said before anything moves: the hand is empty, or the thing would not stay where it is to go."""

from __future__ import annotations

from agent.carries import why_not
from agent.goal import Goal, Placement, Reference
from agent.language.resolve import Scope, resolve
from kb.percept import PerceivedObject

EMPTY_HAND = "There is nothing in my hand that I could put down; nothing moves."


def single(reference: Reference, scope: Scope) -> PerceivedObject | None:
    """The one thing that is meant, or None."""
    got = resolve(reference, scope)
    return next(obj for obj in scope.objects if obj.id == got.ids[0]) if got.clear else None


def lets_go_of_nothing(
    held: PerceivedObject | None, goal: Goal, meant: PerceivedObject | None, *, earlier: bool
) -> bool:
    """Whether it is to let go of what it does not hold: "drop it" with an empty hand takes nothing up first.

    Args:
        held: what is in the hand.
        goal: the goal that is looked at.
        meant: the thing that the goal names, if it is clear.
        earlier: an earlier part of the same instruction may have filled the hand by then.
    """
    if goal.placement is None or not goal.placement.from_hand or earlier:
        return False
    return held is None or (meant is not None and meant.id != held.id)


def impossible(goal: Goal, thing: PerceivedObject | None, scope: Scope, *, earlier: bool) -> str | None:
    """Why the goal can be done neither now nor after the earlier parts of the instruction, or None."""
    if lets_go_of_nothing(scope.held, goal, thing, earlier=earlier):
        return EMPTY_HAND
    return does_not_stay(goal.placement, thing, scope)


def does_not_stay(placement: Placement | None, thing: PerceivedObject | None, scope: Scope) -> str | None:
    """Why the thing would not stay in or on what it is to be put into or onto, or None."""
    if placement is None or placement.kind != "on" or placement.reference is None or thing is None:
        return None
    below = single(placement.reference, scope)
    return None if below is None else why_not(thing, placement, below)
