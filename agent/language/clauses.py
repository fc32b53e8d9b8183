"""Cuts an instruction into clauses: takes away politeness, finds verbs, and puts "after ..., do" into the order of doing."""

from __future__ import annotations

import re

from agent.language import lexicon

VERBS: tuple[tuple[str, str], ...] = tuple(
    sorted(
        (
            *((verb, "pick") for verb in lexicon.PICK_VERBS),
            *((verb, "hand") for verb in lexicon.HAND_VERBS),
            *((verb, "place") for verb in lexicon.PLACE_VERBS),
            *((verb, "discard") for verb in lexicon.DISCARD_VERBS if verb not in lexicon.PLACE_VERBS),
            *((verb, "sort") for verb in lexicon.SORT_VERBS),
        ),
        key=lambda pair: -len(pair[0].split()),
    )
)
"""Verb -> action, the longer phrases first."""
SEQUENCE = ("and then", "then", "after that", "afterwards", "and afterwards", "and after that", "followed by", "next", "and next",
            "finally", "and finally", "lastly", "and lastly", "subsequently", "after which", "and", "plus", "as well as", "but",
            "before that", "once that is done", "when you are done", "once you have it", "once done", "when done")  # fmt: skip
GERUNDS = {
    "handing": "hand", "picking": "pick", "putting": "put", "giving": "give", "passing": "pass", "bringing": "bring",
    "taking": "take", "grabbing": "grab", "lifting": "lift", "moving": "move", "placing": "place", "clearing": "clear",
    "sorting": "sort", "getting": "get", "fetching": "fetch", "grasping": "grasp", "holding": "hold", "removing": "remove",
    "throwing": "throw", "dropping": "drop", "setting": "set", "tidying": "tidy", "cleaning": "clean", "ordering": "order",
    "arranging": "arrange", "raising": "raise", "collecting": "collect",
}  # fmt: skip
"""Gerund -> verb."""
HAND_ME = re.compile(
    r"^(?:i (?:want|need|would like(?: to have)?|could use|would love)|(?:can|could|may|might) i (?:please )?(?:have|get)|"
    r"let me have|i will (?:have|take)|i am looking for|get me|fetch me|bring me|grab me|give me|hand me|pass me|"
    r"hand over|pass over)\s+(?:over )?(?!to\b|you\b)(?P<what>.+)$"
)
NOT_DO = re.compile(
    r"^(?:please )?(?:do not|never|not|you (?:must|should|shall|may) not|avoid|refrain from)\s+(?P<rest>.+)$"
)
UNABLE_START = re.compile(r"^(?:" + "|".join(sorted(lexicon.UNABLE, key=len, reverse=True)) + r")\b")


def trim(tokens: list[str]) -> list[str]:
    """Takes away separators and fillers at both ends."""
    changed = True
    while changed and tokens:
        changed = False
        while tokens and tokens[0] in (",", ".", ";"):
            tokens, changed = tokens[1:], True
        while tokens and tokens[-1] in (",", ".", ";", "and"):
            tokens, changed = tokens[:-1], True
        for filler in sorted(lexicon.FILLERS, key=lambda f: -len(f.split())):
            parts = filler.split()
            if tokens[: len(parts)] == parts and (len(tokens) > len(parts)):
                tokens, changed = tokens[len(parts) :], True
            if tokens[-len(parts) :] == parts and len(tokens) > len(parts) and filler not in ("next", "now there"):
                tokens, changed = tokens[: -len(parts)], True
        for tag in lexicon.TAGS:
            parts = tag.split()
            if tokens[-len(parts) - 1 :] == [",", *parts] and len(tokens) > len(parts) + 1:
                tokens, changed = tokens[: -len(parts) - 1], True
    return tokens


def strip_opener(tokens: list[str]) -> list[str]:
    """Takes away polite beginnings: "could you please"."""
    changed = True
    while changed:
        changed = False
        for opener in sorted(lexicon.OPENERS, key=lambda o: -len(o.split())):
            parts = opener.split()
            if tokens[: len(parts)] == parts and len(tokens) > len(parts):
                tokens, changed = trim(tokens[len(parts) :]), True
    return tokens


def split_clauses(tokens: list[str]) -> list[list[str]]:
    """Cuts "first the cup, then the apple; and put it in the bin" into clauses.

    "and" and commas cut only before a verb, or before a noun phrase when the verb has one object already; the former are
    decided here, the latter in `read_clause`.
    """
    tokens = _reorder_after(tokens)
    clauses: list[list[str]] = [[]]
    i = 0
    while i < len(tokens):
        joined = _joint(tokens, i)
        if joined and (clauses[-1] or clauses[:-1]):
            if clauses[-1]:
                clauses.append([])
            i += joined
            continue
        clauses[-1].append(tokens[i])
        i += 1
    kept = [clause for clause in clauses if clause]
    return [clause if index and clause[0] == "first" else drop_first(clause) for index, clause in enumerate(kept)]


def drop_first(clause: list[str]) -> list[str]:
    """Takes "first the cup" as the beginning of a sequence, not "the first cup"."""
    leading = ("first", "firstly", "secondly", "second", "third", "thirdly")
    if (
        clause[0] in leading
        and len(clause) > 1
        and (clause[1] in ("the", "a", "an", ",", "of") or find_verb(clause[1:]))
    ):
        return clause[1:]
    return clause


def _reorder_after(tokens: list[str]) -> list[str]:
    """Puts "after you took the cup, take the apple" and "before you take B, take A" in the order of doing."""
    if tokens and tokens[0] in ("after", "before", "once", "when", "as") and "," in tokens:
        cut = tokens.index(",")
        first, second = tokens[1:cut], tokens[cut + 1 :]
        first = [t for t in first if t not in ("you", "have", "soon", "as", "that")]
        first = [{"took": "take", "taken": "take", "taking": "take", "picked": "pick", "picking": "pick", "putting": "put",
                  "placed": "place", "placing": "place", "grabbed": "grab", "grabbing": "grab"}.get(t, t) for t in first]  # fmt: skip
        return [*second, "then", *first] if tokens[0] == "before" else [*first, "then", *second]
    for cut, token in enumerate(tokens):  # "take the bowl after putting the block in the bin"
        if cut and token in ("after", "before") and tokens[cut + 1 : cut + 2] and tokens[cut + 1] in GERUNDS:
            first, second = tokens[:cut], [GERUNDS[tokens[cut + 1]], *tokens[cut + 2 :]]
            return [*second, "then", *first] if token == "after" else [*first, "then", *second]
    return tokens


def _joint(tokens: list[str], i: int) -> int:
    """Length of the separator at `i`, 0 if there is none."""
    if tokens[i] in (".", ";"):
        return 1
    start = i + 1 if tokens[i] == "," else i
    for phrase in sorted(SEQUENCE, key=lambda p: -len(p.split())):
        parts = phrase.split()
        if tokens[start : start + len(parts)] != parts:
            continue
        rest = strip_opener(trim(tokens[start + len(parts) :]))
        if not rest:
            return 0
        rest = rest[1:] if rest[0] == "first" else rest
        strong = phrase not in ("and", "but", "next", "plus", "as well as")
        starts_verb = (
            find_verb(rest) is not None or bool(NOT_DO.match(" ".join(rest))) or bool(HAND_ME.match(" ".join(rest)))
        )
        starts_verb = starts_verb or bool(UNABLE_START.match(" ".join(rest)))
        if strong or starts_verb:
            return start - i + len(parts)
    if tokens[i] == ",":
        rest = strip_opener(tokens[i + 1 :])
        if find_verb(rest) is not None or NOT_DO.match(" ".join(rest)):
            return 1
    return 0


def find_verb(tokens: list[str]) -> tuple[str, int] | None:
    """(action, length) of the verb at the start of a clause, or None."""
    for verb, action in VERBS:
        parts = verb.split()
        if tokens[: len(parts)] == parts:
            return action, len(parts)
    return None
