"""A force that a person named is kept: what is said where it does not do, and where a softer wish had to be exceeded."""

from __future__ import annotations

from agent.attempt import Attempt
from kb.grasp import MAX_FORCE, MIN_FORCE
from kb.sensing import Plan
from tools.correct_grasp import SQUEEZED_OUT
from tools.planning.demand import said_by_person

STRONGER = 1.4
"""Force offered at least after what was named let it slip, as a factor; gentler is offered by its inverse."""
NEAR_OWN = 1.25
"""Ratio to the planner's own force within which nothing is said about it."""
RAISED = 0.05
"""Raise of the grip from which it is told [N]."""


def force_kept(last: Attempt) -> str | None:
    """Why a failed attempt isn't tried again with the force that the person named, and what is offered; None to go on.

    Trying again would only repeat it: the correction of a slip is more force, that of a damage less, and neither may be
    taken. What was squeezed out is another matter: there the place was wrong.

    Args:
        last: the attempt that failed.
    """
    own, used = last.plan.own_force, last.plan.grasp.force
    if own is None or last.claimed:
        return None
    name = f"{used:.1f} N, which I kept because you {_told(last)}"
    if last.failure in ("SLIP", "DROP") and not _squeezed_out(last) and used < MAX_FORCE:
        offer = min(MAX_FORCE, max(own, STRONGER * used))
        firmer = "" if own > STRONGER * used else ' or "firmer"'
        return f'it slipped at {name}. I would take {offer:.0f} N: say "with {offer:.0f} N"{firmer}'
    if last.failure in ("FORCE_DAMAGE", "DEFORMATION") and used > MIN_FORCE:
        offer = max(MIN_FORCE, min(own, used / STRONGER))
        gentler = "" if own < used / STRONGER else ' or "gentler"'
        return f'it was pressed too hard by {name}. I would take {offer:.0f} N: say "with {offer:.0f} N"{gentler}'
    return None


def _squeezed_out(last: Attempt) -> bool:
    sensed = last.sensing
    return sensed.load_lifted < 0.01 and sensed.aperture_closed < SQUEEZED_OUT * last.plan.local_width


def _told(last: Attempt) -> str:
    """How the person said it."""
    said = [step.id for step in last.plan.provenance.get("force", ()) if step.id.startswith("person")]
    words = said[-1].removeprefix("person").removeprefix(": ") if said else ""
    return f"said {words}" if words else "set it"


def held_with(attempt: Attempt) -> float:
    """Force with which the hand held in the end [N]: a test lift may have raised it."""
    return attempt.plan.grasp.force + attempt.sensing.grip_raised


def warned(plan: Plan) -> str:
    """What may come of a force that is far from what the planner would have taken; empty where it is near or not named."""
    own, used = plan.own_force, plan.grasp.force
    if own is None or own / NEAR_OWN <= used <= own * NEAR_OWN:
        return ""
    risk = "it may slip" if used < own else "it may be pressed too hard"
    return f" Without your word I would take {own:.0f} N: with {used:.1f} N {risk}."


def raised_words(attempt: Attempt) -> tuple[str, ...]:
    """What the test lift did to the force, as a source of that number; nothing where it did nothing."""
    if attempt.sensing.grip_raised < RAISED:
        return ()
    return (f"the test lift raised it to {held_with(attempt):.1f} N, because it slipped or was heavy",)


def raised(attempt: Attempt) -> str:
    """That the grip was raised beyond a person's softer wish ("gently"); empty where it was not."""
    if attempt.sensing.grip_raised < RAISED or not said_by_person(attempt.plan, "force"):
        return ""
    return (
        f"With {attempt.plan.grasp.force:.1f} N it began to slip in the test lift, so I gripped it with "
        f"{held_with(attempt):.1f} N; name a number and I keep to it."
    )
