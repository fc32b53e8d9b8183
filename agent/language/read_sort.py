"""Reads what is to be sorted, and by what: "sort the cups by size", "line everything up, heaviest first"."""

from __future__ import annotations

import re

from agent.goal import Goal, Measure, Reference
from agent.language import lexicon
from agent.language.ask_back import CANNOT_READ, AskBack
from agent.language.cut_phrase import TABLE, split_list
from agent.language.read_adjective import Reading
from agent.language.read_reference import is_reference, read_reference
from agent.language.words import edits, mend, vocabulary

SORTED_BY = re.compile(
    r"\b(?:by|according to|based on|after|in order of|in terms of|with respect to|how|from|on)\s+(?P<how>.+)$"
)
DESCENDING = re.compile(
    r"\b(?:descending|decreasing|(?:most|biggest|largest|heaviest|tallest|most fragile) (?:one |ones |fragile |things |objects )?"
    r"first|from (?:the )?(?:most|big|biggest|large|largest|heavy|heaviest|tall|tallest|high|fragile)\b|reverse)"
)
FROM_RIGHT = re.compile(r"\bfrom (?:the )?right to (?:the )?left\b")
SPARED = re.compile(r"(?:except|but|apart from|other than|without|excluding)\b.+$")
FIRST = re.compile(r" ?(?:the )?(?:most |least )?[a-z]+ (?:ones |things |objects )?(?:first|last)$")


def read_sort(rest: list[str]) -> list[Goal] | AskBack | str:
    line = " ".join(rest)
    by = SORTED_BY.search(line)
    measure = read_measure((by["how"] if by else line).split())
    if measure is None and by:
        return "I can sort by fragility, by size or by weight, and by nothing else."
    what = line[: by.start()].split() if by else FIRST.sub("", line.split(" , ")[0]).split()
    spared = SPARED.search(by["how"]) if by else None
    if spared:
        what = [*(what or ["everything"]), *spared[0].split()]
    what = [
        t
        for t in what
        if t not in ("out", "up", "them", "it", "from", "left", "to", "right", "in", "a", "row", "line", *TABLE)
    ]
    reading = _joined([part for part in split_list(what) if part != ["the"]] or [["everything"]])
    if not is_reference(reading) and not reading.unknown:
        reading = read_reference(["everything"])
    if reading.unknown or reading.contradiction:
        return CANNOT_READ
    reference = Reference(**{**reading.found, "plural": True})
    descending = bool(DESCENDING.search(line)) != bool(FROM_RIGHT.search(line))
    goal = Goal(kind="sort", reference=reference, measure=measure, descending=descending)
    return [goal] if measure else AskBack("I can sort by fragility, by size or by weight. By which?", goal)


def _joined(parts: list[list[str]]) -> Reading:
    """For "the cups and mugs": one reference to things of either kind; "all but the cup and the vase" stays whole."""
    readings = [read_reference(part) for part in parts]
    first = readings[0]
    if len(parts) == 1 or first.found.get("excluding"):
        return first
    if not all(r.found.get("categories") and not r.unknown and not r.contradiction for r in readings):
        return Reading(unknown=[word for part in parts for word in part])
    kinds = tuple(dict.fromkeys(c for r in readings for c in r.found["categories"]))
    first.found["categories"] = kinds
    return first


def read_measure(tokens: list[str]) -> Measure | None:
    """What a sort goes by, or None where no word says it."""
    for token in tokens:
        measure = lexicon.MEASURES.get(mend(token)) or _measure_of(token)
        if measure is not None:
            return measure
    return None


def _measure_of(token: str) -> Measure | None:
    extremes: dict[str, Measure] = {
        "biggest": "size", "smallest": "size", "largest": "size", "tallest": "size", "shortest": "size",
        "heaviest": "weight", "lightest": "weight", "sturdiest": "fragility", "lighter": "weight", "heavier": "weight",
        "bigger": "size", "smaller": "size", "larger": "size", "sturdy": "fragility", "robust": "fragility",
    }  # fmt: skip
    near: set[Measure] = {
        measure
        for word, measure in lexicon.MEASURES.items()
        if len(word) > 3 and token not in vocabulary() and edits(token, word, 1) <= 1
    }
    return extremes.get(token) or (near.pop() if len(near) == 1 and len(token) > 3 else None)
