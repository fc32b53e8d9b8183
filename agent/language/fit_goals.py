"""Looks whether the goals of an instruction agree with each other, and binds what one says of another."""

from __future__ import annotations

from agent.goal import Goal, Reference, Understanding
from agent.language import lexicon
from agent.language.ask_back import CANNOT_READ
from agent.language.describe import spoken

THEM = ("them", "these", "those", "them all", "all of them")


def fitted(goals: list[Goal], forbidden: list[Reference]) -> Understanding:
    """Checks that the clauses agree with each other."""
    if not goals:
        if forbidden:
            return Understanding(refusal=f"All right: I leave {_the(forbidden[0])} alone. There is nothing else to do.")
        return Understanding(refusal=CANNOT_READ)
    for goal in goals:
        if goal.placement is not None and _onto_itself(goal.reference, goal.placement.reference):
            return Understanding(refusal="That contradicts itself: a thing cannot be put beside, on or in itself.")
        for taboo in forbidden:
            if goal.moves and goal.reference is not None and _same(goal.reference, taboo):
                return Understanding(
                    refusal=f"That contradicts itself: I am to handle {_the(taboo)} and not to. Nothing was moved."
                )
    goals = _bound(_without_repeats(_resting(goals, forbidden)))
    spared = tuple(forbidden)
    if spared:
        goals = [_sparing(goal, spared) if _may_spare(goal) else goal for goal in goals]
    return Understanding(goals=tuple(goals))


def _resting(goals: list[Goal], forbidden: list[Reference]) -> list[Goal]:
    """In "put the cup on the left and clear the rest" the rest is everything but the cup."""
    said: list[Reference] = []
    resting: list[Goal] = []
    for goal in goals:
        reference = goal.reference
        rest = (
            reference is not None
            and reference.other
            and reference.plural
            and reference.noun in (None, *lexicon.GENERIC)
        )
        if reference is not None and rest:
            into_bin = goal.kind == "place" and goal.placement is not None and goal.placement.kind == "bin"
            goal = goal.model_copy(update={"kind": "clear"}) if into_bin else goal
            named = () if goal.kind in ("clear", "sort") else tuple(forbidden)  # those are spared in any case
            spared = (*reference.excluding, *named, *(r for r in said if r not in forbidden))
            update = {"noun": "everything", "other": not (spared or forbidden), "excluding": spared}
            goal = goal.model_copy(update={"reference": reference.model_copy(update=update)})
        elif (
            reference is not None
            and not reference.pronoun
            and not (reference.plural and reference.noun in lexicon.GENERIC)
        ):
            said.append(reference)
        resting.append(goal)
    return resting


def _onto_itself(thing: Reference | None, other: Reference | None) -> bool:
    """Whether the destination is the very thing that is to be moved ("put the cup in the cup")."""
    if thing is None or other is None or other.other or other.anyone or thing.anyone or thing.plural:
        return False
    return (other.words == "itself") or (not thing.pronoun and not other.pronoun and _same(thing, other))


def _without_repeats(goals: list[Goal]) -> list[Goal]:
    """Drops "... and lift it" after "grip the cup", and a second clearing of the table."""
    kept: list[Goal] = []
    for goal in goals:
        reference = goal.reference
        if reference is not None and reference.words in THEM and goal.kind == "place" and kept:
            kept = [
                g.model_copy(update={"kind": "place", "placement": goal.placement})
                if g.kind == "pick" and g.placement is None
                else g
                for g in kept
            ]
            continue
        again = bool(kept) and reference is not None and reference.pronoun and kept[-1].moves
        if again and goal.kind == "pick" and goal.placement is None and kept[-1].kind == "pick":
            continue
        if kept and kept[-1].kind == "clear" and (goal.kind == "clear" or (again and goal.kind == "place")):
            continue
        kept.append(goal)
    return kept


def _bound(goals: list[Goal]) -> list[Goal]:
    """In "take the bowl, but first remove what is on it" the pronoun means the bowl."""
    bound: list[Goal] = []
    for index, goal in enumerate(goals):
        reference = goal.reference
        others = [
            g.reference for i, g in enumerate(goals) if i != index and g.reference is not None and g.reference.noun
        ]
        relation = reference.relation if reference is not None else None
        if reference is not None and relation is not None and others and any(o.pronoun for o in relation.others):
            named = tuple(others[0] if o.pronoun else o for o in relation.others)
            relation = relation.model_copy(update={"others": named})
            goal = goal.model_copy(update={"reference": reference.model_copy(update={"relation": relation})})
        bound.append(goal)
    return bound


def _may_spare(goal: Goal) -> bool:
    """Whether the goal is about several things, or whichever of several, from which some may be left out."""
    reference = goal.reference
    return goal.kind in ("clear", "sort") or (
        goal.moves and reference is not None and (reference.plural or reference.anyone)
    )


def _sparing(goal: Goal, spared: tuple[Reference, ...]) -> Goal:
    reference = goal.reference or Reference(words="everything", noun="everything", plural=True)
    return goal.model_copy(
        update={"reference": reference.model_copy(update={"excluding": (*reference.excluding, *spared)})}
    )


def _the(reference: Reference) -> str:
    return spoken(reference)


def _same(one: Reference, other: Reference) -> bool:
    """Whether two references speak of the same thing for all that was said."""
    if one.pronoun or other.pronoun:
        return other.pronoun
    plain = (
        one.noun,
        one.colour,
        one.material,
        one.side,
        one.ordinal,
        one.extreme,
        one.relation,
        one.quality,
        one.state,
        one.shape,
    )
    return plain == (
        other.noun,
        other.colour,
        other.material,
        other.side,
        other.ordinal,
        other.extreme,
        other.relation,
        other.quality,
        other.state,
        other.shape,
    )
