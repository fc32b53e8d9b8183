"""Cuts an instruction into clauses: takes away politeness, finds verbs, and puts "after ..., do" into the order of doing."""

from __future__ import annotations

import re

from agent.language import courtesies, lexicon

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
    "arranging": "arrange", "raising": "raise", "collecting": "collect", "gripping": "grip", "seizing": "seize",
    "retrieving": "retrieve", "depositing": "deposit", "discarding": "discard", "laying": "lay", "carrying": "carry",
    "binning": "bin", "tossing": "toss", "dumping": "dump", "shifting": "shift", "transferring": "transfer",
    "delivering": "deliver", "offering": "offer", "emptying": "clear", "stacking": "stack", "leaving": "leave",
}  # fmt: skip
"""Gerund -> verb."""
PAST = {
    "took": "take",
    "taken": "take",
    "picked": "pick",
    "placed": "place",
    "grabbed": "grab",
    "moved": "move",
    "put": "put",
    "got": "get",
    "gotten": "get",
    "lifted": "lift",
    "cleared": "clear",
    "removed": "remove",
    "threw": "throw",
    "thrown": "throw",
    "gave": "give",
    "given": "give",
    "brought": "bring",
    "handed": "hand",
    "passed": "pass",
    "sorted": "sort",
    "dropped": "drop",
    "fetched": "fetch",
    "tidied": "tidy",
    "cleaned": "clean",
    "laid": "lay",
}
"""Past form -> verb."""
TEMPORAL = ("after", "before", "once", "when", "as soon as")
_DOERS = ("you", "have", "had", "that", "are", "done", "finished", "just", "first")
HAND_ME = re.compile(
    r"^(?:i (?:want|need|would like(?: to have)?|could use|would love)|(?:can|could|may|might) i (?:please )?(?:have|get)|"
    r"let me have|have(?= (?:the|a|an|that|this|my|some)\b)|i will (?:have|take)|i am looking for|i could (?:do with|use)|i would (?:also )?(?:like|love|appreciate)(?: to have| to get)?|"
    r"i could really use|i require|i fancy|may we have|can we have|we need|"
    r"(?:get|fetch|bring|grab|give|hand|pass|find|send|serve|lend|offer|pick) me|"
    r"hand over|pass over)\s+(?:over )?(?!to\b|you\b)(?P<what>.+)$"
)
NOT_DO = re.compile(
    r"^(?:please )?(?:do not|never|not|you (?:must|should|shall|may) not|avoid|refrain from)\s+(?P<rest>.+)$"
)
ASKS_START = re.compile(
    r"^(?:tell me|show me (?:where|what|how)|describe|what (?:is|do|can)|where is|how many|say (?:what|how)|list|count) "
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
        for filler in sorted(courtesies.FILLERS, key=lambda f: -len(f.split())):
            parts = filler.split()
            says = parts == ["there"] and tokens[1:2] in (["is"], ["are"])
            if tokens[: len(parts)] == parts and (len(tokens) > len(parts)) and not says:
                tokens, changed = tokens[len(parts) :], True
            if tokens[-len(parts) :] == parts and len(tokens) > len(parts) and filler not in ("next", "now there"):
                tokens, changed = tokens[: -len(parts)], True
        for tag in courtesies.TAGS:
            parts = tag.split()
            if tokens[-len(parts) - 1 :] == [",", *parts] and len(tokens) > len(parts) + 1:
                tokens, changed = tokens[: -len(parts) - 1], True
            elif parts[-1] == "you" and tokens[-len(parts) :] == parts and find_verb(tokens) is not None:
                tokens, changed = tokens[: -len(parts)], True  # "grab me the apple will you"
    return tokens


def strip_opener(tokens: list[str]) -> list[str]:
    """Takes away polite beginnings: "could you please"."""
    changed = True
    while changed:
        changed = False
        for opener in sorted(courtesies.OPENERS, key=lambda o: -len(o.split())):
            parts = opener.split()
            if tokens[: len(parts)] == parts and len(tokens) > len(parts):
                tokens, changed = trim(tokens[len(parts) :]), True
                if parts[-1] == "you" and tokens:  # "i would be grateful if you picked up the mug"
                    tokens = [PAST.get(tokens[0], tokens[0]), *tokens[1:]]
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
    kept = [_drop_trailing(clause, index) for index, clause in enumerate(c for c in clauses if c)]
    return [clause if index and clause[0] == "first" else drop_first(clause) for index, clause in enumerate(kept)]


def _drop_trailing(clause: list[str], index: int) -> list[str]:
    """Takes "pick up the apple first" as a word about the order; in a later clause it comes before what was said."""
    sorts = find_verb(clause)
    if (
        len(clause) < 3
        or (sorts is not None and sorts[0] == "sort")  # "the heaviest one first" is the order that is wanted
        or clause[-1] not in ("first", "second", "last", "next")
        or clause[-2] in ("the", "my", "a", *lexicon.EXTREMES, *lexicon.QUALITIES)
    ):
        return clause
    return ["first", *clause[:-1]] if index and clause[-1] == "first" else clause[:-1]


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
        first, second = [t for t in tokens[1:cut] if t not in ("soon", "as")], tokens[cut + 1 :]
        done = _action(first)
        if done is None and {"with", "i", "we", "he", "she", "they"} & set(first):
            return second if "with" in first else tokens  # "once you are done with the cup" asks for nothing
        first = done if done is not None else [t for t in first if t not in _DOERS]
        return [*second, "then", *first] if tokens[0] == "before" else [*first, "then", *second]
    if tokens and tokens[0] in ("after", "before", "once", "when"):  # no comma: the second verb begins what comes then
        for cut in range(4, len(tokens) - 1):
            if find_verb(tokens[cut:]) and tokens[cut - 1] not in (
                "the",
                "a",
                "an",
                "to",
                "my",
                "and",
                "in",
                "into",
                "on",
                "of",
            ):
                done = _action(tokens[1:cut])
                if done is None or len(done) < 3:
                    break
                later = tokens[cut:]
                return [*later, "then", *done] if tokens[0] == "before" else [*done, "then", *later]
    for cut, token in enumerate(tokens):  # "take the bowl after putting the block in the bin"
        if not cut or token not in TEMPORAL or tokens[cut - 1] in (",", "and", "then", "the"):
            continue
        first, later = tokens[:cut], _action(tokens[cut + 1 :])
        if later is None and token in ("after", "before") and _is_pick(first) and tokens[cut + 1 : cut + 2] == ["the"]:
            later = tokens[cut + 1 :]  # "take the apple after the banana": both are taken
            first, later = (first, later) if token == "before" else ([first[0], *later], first[1:])
            return [*first, "then", *later]
        if later is not None:
            return [*first, "then", *later] if token == "before" else [*later, "then", *first]
    return tokens


def _action(tokens: list[str]) -> list[str] | None:
    """What "you have taken the cup" or "taking the cup" says to do, or None if it is no action."""
    while tokens and tokens[0] in _DOERS:
        tokens = tokens[1:]
    if not tokens:
        return None
    tokens = [{**GERUNDS, **PAST}.get(tokens[0], tokens[0]), *tokens[1:]]
    return tokens if find_verb(tokens) is not None else None


def _is_pick(tokens: list[str]) -> bool:
    verb = find_verb(strip_opener(tokens))
    return verb is not None and verb[0] == "pick" and verb[1] == 1 and len(tokens) > 2


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
        starts_verb = starts_verb or bool(ASKS_START.match(" ".join(rest)))
        starts_verb = starts_verb or bool(UNABLE_START.match(" ".join(rest)))
        if strong or starts_verb:
            return start - i + len(parts)
    if tokens[i] == ",":
        rest = strip_opener(trim(tokens[i + 1 :]))
        if rest and (find_verb(rest) is not None or NOT_DO.match(" ".join(rest))):
            return 1
    return 0


def find_verb(tokens: list[str]) -> tuple[str, int] | None:
    """(action, length) of the verb at the start of a clause, or None."""
    for verb, action in VERBS:
        parts = verb.split()
        if tokens[: len(parts)] == parts:
            return action, len(parts)
    return None
