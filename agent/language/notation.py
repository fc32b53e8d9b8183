"""Goals in a notation made for reading, in which the corpora of commands are written.

`kind[/query][:measure][:descending] thing[*] qualifiers >destination`, goals separated by " ; ", "*" for plurals, "^0" for a
sub-goal of goal 0; "refuse" and "ask" for commands that move nothing.
"""

from __future__ import annotations

from agent.goal import Goal, Placement, Reference, RelationTo, Understanding


def head(reference: Reference) -> str:
    """The noun, or what stands in its place."""
    return "it" if reference.pronoun else (reference.noun or reference.colour or "")


def related(relation: RelationTo) -> str:
    """A relation to its first reference."""
    return f"{relation.relation}({head(relation.others[0])})"


def thing(reference: Reference) -> list[str]:
    """A reference in the notation."""
    words = [head(reference) + ("*" if reference.plural and not reference.pronoun else "")]
    words += [
        f"{key}={value}"
        for key in ("colour", "material", "shape", "quality", "state", "extreme", "ordinal", "side", "count")
        if (value := getattr(reference, key)) is not None
    ]
    words += [word for word, said in (("other", reference.other), ("any", reference.anyone)) if said]
    if reference.relation is not None:
        words.append(related(reference.relation))
    words += [f"not({head(refused)})" for refused in reference.excluding]
    return words


def destination(placement: Placement) -> str:
    """A placement in the notation."""
    if placement.kind == "side":
        return f">side:{placement.side}"
    if placement.reference is not None and placement.reference.noun:
        return f">{placement.kind}:{placement.relation}({head(placement.reference)})"
    return f">{placement.kind}" + (f":{placement.relation}" if placement.relation else "")


def written(goal: Goal) -> str:
    """A goal in the notation."""
    first = goal.kind + (f"/{goal.query}" if goal.query else "") + (f":{goal.measure}" if goal.measure else "")
    words = [first + (":descending" if goal.descending else "")]
    words += thing(goal.reference) if goal.reference else []
    words += [f"F={goal.force:g}"] if goal.force else []
    words += [destination(goal.placement)] if goal.placement else []
    words += [f"^{goal.parent}"] if goal.parent is not None else []
    words += ["unknown"] if goal.reference is not None and not goal.reference.known else []
    return " ".join(words)


def noted(got: Understanding) -> str:
    """What an instruction was taken to mean, in the notation."""
    if got.question is not None:
        return "ask"
    return "refuse" if got.refusal is not None else " ; ".join(written(goal) for goal in got.goals)
