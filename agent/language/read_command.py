"""Reads an instruction in free wording into typed goals, a refusal, or a question back.

The order is: clean, recognise questions, cut into clauses ("first ..., then ..."), read each clause as verb, things and
place, and at last look whether it all fits together. What is not understood is refused with a reason; nothing is guessed
that would move the robot.
"""

from __future__ import annotations

import re
from functools import lru_cache

from agent.goal import Goal, Reference, Understanding
from agent.language import courtesies
from agent.language.asides import untouchable, without_asides
from agent.language.ask_back import CANNOT_READ, AskBack
from agent.language.clauses import GERUNDS, NOT_DO, find_verb, split_clauses, strip_opener, trim
from agent.language.fit_goals import fitted
from agent.language.read_clause import read_clause
from agent.language.read_place import read_place
from agent.language.read_question import read_question
from agent.language.read_reference import is_reference, read_reference
from agent.language.read_sort import read_measure
from agent.language.refusals import CODE, refuse
from agent.language.rephrase import as_seen_by_person, rephrased
from agent.language.stop import says_stop
from agent.language.words import words

OR = re.compile(r"\bor\b")
VAGUE = re.compile(
    r"\b(?:put|place|move|take) something (?:somewhere|anywhere|else)\b|\b(?:half|most|many|some|several|a few|few|part|a part|a couple|a third|a quarter|a lot|lots|a bunch) of (?:the|my|these|those|them|all)\b|"
    r"\b(?:half|several|a few|some|a couple|many|most|a bunch of|a lot of|lots of) (?:the )?(?:[a-z]+ )?(?:cups|mugs|bottles|blocks|cubes|boxes|apples|bananas|glasses|vases|bowls|"
    r"pens|keys|phones|balls|things|objects|items|toys|tools|fruits|ones)\b"
)
"""A number of things that is not said: more than was meant might be moved."""
NO_OP = re.compile(
    r"^(?:go|come|drive|move|return)(?: back)?(?: to)?(?: (?:home|your (?:home|start) ?(?:position|pose)?|back|rest))+$"
)
CORRECTED = re.compile(
    r"(?:the|a|an) [a-z ]+? [,.;]? ?(?:(?:no|sorry|i mean|rather|actually|wait|oops)(?: [,.;])? )+(?=(?:the|a|an) )"
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
    return _understood(text, pending)  # pyright: ignore[reportArgumentType]  frozen nouns have a hash


@lru_cache(maxsize=128)
def _understood(text: str, pending: Goal | None) -> Understanding:
    """As `understand`, read once: a turn reads its instruction twice, and a benchmark the same few ones all the time."""
    said = trim(as_seen_by_person(" ".join(words(text))).split())
    if not said:
        return Understanding(refusal=CANNOT_READ)
    if CODE.search(text) and not says_stop(" ".join(said)):
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
    if VAGUE.search(line):
        return Understanding(question="How many of them, and which? Please tell me a number, or name them.")
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
        goals = _with_last_place(goals)
        goals = [g if g.moves or g.query else g.model_copy(update={"kind": "pick"}) for g in goals]
    return fitted(goals, forbidden)


def _with_last_place(goals: list[Goal]) -> list[Goal]:
    """In "first the apple, then the banana into the bin" both go there."""
    said = [g for g in goals if g.kind == "answer" and g.query is None]
    if len(said) == len(goals) - 1 and said == goals[:-1] and goals[-1].kind == "place":
        return [*(g.model_copy(update={"kind": "place", "placement": goals[-1].placement}) for g in said), goals[-1]]
    return goals


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
