"""Reads an instruction in free wording into typed goals, a refusal, or a question back.

The order is: clean, recognise questions, cut into clauses ("first ..., then ..."), read each clause as verb, things and
place, and at last look whether it all fits together. What is not understood is refused with a reason; nothing is guessed
that would move the robot.
"""

from __future__ import annotations

import re

from agent.goal import Goal, Reference, Understanding
from agent.language import courtesies, lexicon
from agent.language.asides import untouchable, without_asides
from agent.language.clauses import GERUNDS, NOT_DO, find_verb, split_clauses, strip_opener, trim
from agent.language.read_clause import CANNOT_READ, AskBack, read_clause, read_measure
from agent.language.read_place import read_place
from agent.language.read_question import read_question
from agent.language.read_reference import is_reference, read_reference
from agent.language.refusals import refuse
from agent.language.rephrase import rephrased
from agent.language.stop import says_stop
from agent.language.words import words

OR = re.compile(r"\bor\b")
NO_OP = re.compile(
    r"^(?:go|come|drive|move|return)(?: back)?(?: to)?(?: (?:home|your (?:home|start) ?(?:position|pose)?|back|rest))+$"
)
THEM = ("them", "these", "those", "them all", "all of them")
CORRECTED = re.compile(
    r"(?:the|a|an) [a-z ]+? ,? ?(?:no|sorry|i mean|rather|actually|wait|oops)(?: ,)?(?: i mean)?(?: ,)? (?=(?:the|a|an) )"
)
LEAVE_ALONE = re.compile(
    r"^(?:leave|keep) (?P<what>.+?) (?:alone|as (?:it|they) (?:is|are)|untouched|where (?:it|they) (?:is|are)|there|in place)$"
)


def understand(text: str, *, pending: Goal | None = None) -> Understanding:
    """What the instruction means.

    Args:
        text: the instruction as typed, at most 10,000 characters.
        pending: the goal about which the agent asked back last, which a bare noun phrase then completes.
    """
    said = trim(words(text))
    if not said:
        return Understanding(refusal=CANNOT_READ)
    if says_stop(" ".join(said)):
        return Understanding(goals=(Goal(kind="answer", query="stop"),))
    tokens = trim(rephrased(" ".join(said)).split())
    line = " ".join(tokens)
    asked = read_question(" ".join(said)) or read_question(line)
    if asked is None and line.startswith(courtesies.OPENERS):
        asked = read_question(" ".join(strip_opener(tokens)))
    if isinstance(asked, str):
        return Understanding(refusal=asked)
    if asked is not None:
        return Understanding(goals=(asked,))
    refusal = refuse(line)
    if refusal is not None:
        return Understanding(refusal=refusal)
    if OR.search(line) and (find_verb(strip_opener(tokens)) is not None or _alternatives(tokens)):
        return Understanding(question=f"One thing or the other: {line}? Please tell me which.")
    if untouchable(line):
        return Understanding(refusal="That contradicts itself: I cannot take a thing without touching it.")
    if pending is not None:
        completed = _complete(tokens, pending)
        if completed is not None:
            return completed
    return _commands(trim(without_asides(CORRECTED.sub("", " ".join(strip_opener(tokens)))).split()))


def _alternatives(tokens: list[str]) -> bool:
    """Whether it names things one of which is meant ("either the cup or the mug")."""
    parts = " ".join(t for t in tokens if t != "either").split(" or ")
    if any(find_verb(part.split()) or part == "it" for part in parts):
        return False
    readings = [read_reference(part.split()) for part in parts]
    return all(is_reference(r) and not r.unknown and not r.contradiction for r in readings)


def _complete(tokens: list[str], pending: Goal) -> Understanding | None:
    """A bare phrase answers the question that was asked back: "the red one", "the second", "in the bin", "by size"."""
    if pending.kind == "place" and pending.placement is None:
        thing, placement = read_place([t for t in tokens if t not in ("put", "place", "it")])
        at_all = placement is not None and (not thing or thing == ["it"])
        return Understanding(goals=(pending.model_copy(update={"placement": placement}),)) if at_all else None
    if pending.kind == "sort" and pending.measure is None:
        measure = read_measure(tokens)
        return Understanding(goals=(pending.model_copy(update={"measure": measure}),)) if measure else None
    if find_verb(strip_opener(tokens)) is not None:
        return None
    if " ".join(tokens) in ("none", "neither", "none of them", "no", "neither of them", "nothing"):
        return Understanding(refusal="All right, I leave everything as it is.")
    reading = read_reference(
        [t for t in tokens if t not in ("i", "mean", "meant", "am", "yes", "no", ",", "take", "think", "want")]
    )
    if reading.unknown or reading.contradiction or not is_reference(reading):
        return None
    said, before = Reference(**reading.found), pending.reference or Reference()
    if said.categories or not said.known:
        merged = said
    else:
        new = {
            k: v for k, v in reading.found.items() if k not in ("noun", "words", "categories", "known", "pronoun") and v
        }
        merged = before.model_copy(update={**new, "words": f"{before.words} ({said.words})"})
    return Understanding(goals=(pending.model_copy(update={"reference": merged, "target": None}),))


def _commands(tokens: list[str]) -> Understanding:
    goals: list[Goal] = []
    forbidden: list[Reference] = []
    clauses = split_clauses(strip_opener(tokens))
    for index, clause in enumerate(clauses):
        # "take the bowl, but first remove what is on it"
        before = index > 0 and clause[:1] == ["first"] and find_verb(clause[1:]) is not None
        clause = strip_opener(trim(clause[1:] if before else clause))
        clause = [GERUNDS.get(clause[0], clause[0]), *clause[1:]]
        line = " ".join(clause)
        negative = NOT_DO.match(line) or LEAVE_ALONE.match(line)
        if negative:
            forbidden += _forbidden(negative)
            continue
        if clause[0] in ("leave", "keep", "spare", "skip") and _stays(clause[1:]):
            reading = read_reference(_stays(clause[1:]))
            if is_reference(reading) and not reading.contradiction:
                forbidden.append(Reference(**reading.found))
                continue
        if NO_OP.match(line) and len(clauses) > 1:
            continue
        asked = read_question(line)
        if isinstance(asked, Goal):
            if asked.query != "stop":
                goals.append(asked)
            continue
        refusal = refuse(line)
        if refusal is not None:
            return Understanding(refusal=refusal)
        got = read_clause(clause, goals)
        if isinstance(got, AskBack):
            return Understanding(question=got.question, pending=None if goals else got.goal)
        if isinstance(got, str):
            return Understanding(refusal=got)
        goals += [goal.model_copy(update={"parent": 0}) for goal in got] if before and goals else got
    if len(clauses) > 1:  # "first the cup, then the apple": an order of things says that they are to be taken
        goals = [g if g.moves or g.query else g.model_copy(update={"kind": "pick"}) for g in goals]
    return _fit(goals, forbidden)


def _stays(tokens: list[str]) -> list[str]:
    """The thing of "leave the glass (on the table)", empty where another destination is said."""
    thing, placement = read_place(tokens)
    return thing if placement is None or placement.kind == "aside" else []


def _forbidden(found: re.Match[str]) -> list[Reference]:
    """The things that a "do not ..." clause protects."""
    rest = (found.groupdict().get("rest") or found.groupdict().get("what") or "").split()
    verb = find_verb(rest)
    things = (
        rest[verb[1] :] if verb else [t for t in rest if t not in ("touch", "touching", "break", "moving", "damage")]
    )
    reading = read_reference(things)
    return [Reference(**reading.found)] if is_reference(reading) and not reading.contradiction else []


def _fit(goals: list[Goal], forbidden: list[Reference]) -> Understanding:
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
        goals = [_sparing(goal, spared) if goal.kind in ("clear", "sort") else goal for goal in goals]
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
            named = () if goal.kind in ("clear", "sort") else tuple(forbidden)  # those are spared in any case
            spared = (*reference.excluding, *named, *(r for r in said if r not in forbidden))
            update = {"noun": "everything", "other": not (spared or forbidden), "excluding": spared}
            goal = goal.model_copy(update={"reference": reference.model_copy(update=update)})
        elif reference is not None and not reference.pronoun:
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


def _sparing(goal: Goal, spared: tuple[Reference, ...]) -> Goal:
    reference = goal.reference or Reference(words="everything", noun="everything", plural=True)
    return goal.model_copy(
        update={"reference": reference.model_copy(update={"excluding": (*reference.excluding, *spared)})}
    )


def _the(reference: Reference) -> str:
    text = "it" if reference.pronoun else reference.words or reference.noun or "it"
    return (
        text
        if text.split()[0] in ("the", "it", "that", "this", "my", "your", "all", "any", "a", "an")
        else f"the {text}"
    )


def _same(one: Reference, other: Reference) -> bool:
    """Whether two references speak of the same thing for all that was said."""
    if one.pronoun or other.pronoun:
        return other.pronoun
    plain = (one.noun, one.colour, one.material, one.side, one.ordinal, one.extreme, one.relation)
    return plain == (other.noun, other.colour, other.material, other.side, other.ordinal, other.extreme, other.relation)
