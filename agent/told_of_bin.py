"""What can be said of things in the bin: its walls hide them from every look, so that only the memory of putting them tells."""

from __future__ import annotations

from agent.goal import Goal, Reference
from agent.language import lexicon
from agent.language.describe import listing
from agent.phrases import object_name
from kb.percept import PerceivedObject, Percept


def means_bin(reference: Reference | None) -> bool:
    """Whether the bin itself is spoken of, or what is in it."""
    if reference is None:
        return False
    if reference.relation is not None and reference.relation.relation in ("in", "on"):
        return any(means_bin(other) for other in reference.relation.others if other.relation is None)
    return reference.noun is not None and reference.noun in lexicon.BINS


def contents(in_bin: tuple[PerceivedObject, ...], percept: Percept) -> str:
    """What lies in the bin, as far as is known."""
    if percept.bin is None:
        return "I see no bin here."
    if not in_bin:
        return "I have put nothing into the bin, and I cannot look into it."
    return f"I put {listing(in_bin)} into the bin; I cannot look into it."


def binned(reference: Reference | None, in_bin: tuple[PerceivedObject, ...]) -> str | None:
    """That the thing which is seen nowhere was put into the bin, or None."""
    if reference is None or not reference.categories:
        return None
    there = [obj for obj in in_bin if obj.category in reference.categories]
    if not there:
        return None
    return f"I put the {object_name(there[-1].category)} into the bin, and I cannot take things out of it."


def not_back(goal: Goal, moved: str | None, in_bin: tuple[PerceivedObject, ...]) -> str | None:
    """Why what was moved last cannot be put back, or None: it lies in the bin."""
    if goal.placement is None or goal.placement.kind != "back" or goal.reference is None or not goal.reference.pronoun:
        return None
    there = next((obj for obj in in_bin if obj.id == moved), None)
    if there is None:
        return None
    return f"The {object_name(there.category)} is in the bin, and I cannot take things out of it; nothing moves."
