"""Reads a noun phrase: "the biggest red cup on the left next to the vase", "everything except the glass", "it"."""

from __future__ import annotations

import re

from agent.goal import Reference, RelationTo, RelationWord
from agent.language import lexicon
from agent.language.cut_phrase import ARTICLES, TABLE, split_exceptions, split_list, split_relation
from agent.language.read_adjective import CLAUSE_WORDS, Reading, longest, read_adjective, read_number
from agent.language.words import singular

INDEFINITE = ("a", "an", "any", "some", "either", "whichever")
PRONOUNS = (
    "it",
    "that",
    "this",
    "them",
    *lexicon.ALL_OF,
    *lexicon.BOTH_OF,
    "same",
    "the same",
    "the same one",
    "him",
    "these",
    "those",
    "that one",
    "this one",
)
FAR_FROM = re.compile(
    r" (?:(?:that|which) is |standing |the )?(?:far|farther|farthest|furthest|further|far away|most distant|not near|not next) (?:from|to) "
)
_ANY_ONE = ("one", "any", "either", "a", "whichever", "just", "single", "only", "1")
_SINGLING = frozenset(
    word
    for word in (*lexicon.EXTREMES, *lexicon.QUALITIES, *lexicon.ORDINALS, *lexicon.COLOURS, *lexicon.SIDES)
    if " " not in word
)
QUESTION_WORDS = (
    "what",
    "who",
    "how",
    "when",
    "which",
    "why",
    "where",
    "whose",
    "is",
    "are",
    "do",
    "does",
    "did",
    "can",
    "will",
)


_MANNERS = frozenset(
    "somewhere anywhere upright straight level steady flat sideways together around along aside again now first last "
    "standing lying upside down open closed".split()
)
"""Words that may follow a noun without being part of it."""


def read_reference(tokens: list[str]) -> Reading:
    """Reads all of `tokens` as one noun phrase.

    `Reading.found` has the fields of a `Reference`; words that are neither known nor in the place of the head noun are
    left in `unknown`. The caller decides whether that is still understandable.
    """
    reading = Reading()
    tokens, excluded = split_exceptions(tokens)
    tokens, far_from = _far_from(tokens)
    tokens, one_of = _partitive(tokens)
    head, relation, others = split_relation(tokens)
    _read_head(head, reading)
    if one_of:
        reading.found.update(plural=False, count=None)
        reading.any = one_of == "any"
    if relation is not None:
        _read_relation(relation, others, reading)
    if excluded:
        _read_exclusions(excluded, reading)
    if far_from is not None:
        near = Reference(
            words="thing near", noun="thing", plural=True, relation=RelationTo(relation="near", others=(far_from,))
        )
        reading.found["excluding"] = (*reading.found.get("excluding", ()), near)
    reading.found["words"] = " ".join(tokens)
    if reading.any:
        reading.found["anyone"] = True
    return reading


def _far_from(tokens: list[str]) -> tuple[list[str], Reference | None]:
    """Takes "the cup far from the vase" as the cup that is not near the vase."""
    line = " ".join(tokens)
    found = FAR_FROM.search(line)
    if found is None or found.start() == 0:
        return tokens, None
    inner = read_reference(line[found.end() :].split())
    if inner.unknown or inner.contradiction or not is_reference(inner):
        return tokens, None
    return line[: found.start()].split(), Reference(**inner.found)


def _partitive(tokens: list[str]) -> tuple[list[str], str]:
    """For "one of the cups", "the smaller of the two boxes": (the phrase without "of the", how one of several is singled out)."""
    for cut, token in enumerate(tokens[:-1]):
        if token != "of" or tokens[cut + 1] not in ("the", "these", "those", "my", "your", "them", "all"):
            continue
        before = [t for t in tokens[:cut] if t != "the"]
        rest = ["one"] if tokens[cut + 1] == "them" else tokens[cut + 2 :]
        if before and before[-1] in lexicon.SIDES:
            break  # "left of the bowl" is a place
        single = [t for t in before if t in _SINGLING]
        if before and all(t in _ANY_ONE for t in before):
            return rest, "any"
        if single and before[-1] in ("one", *single):
            return [
                *[t for t in before if t != "one"],
                *[t for t in rest if t not in lexicon.NUMBERS and not t.isdigit()],
            ], "one"
        break
    return tokens, ""


def reference(tokens: list[str]) -> Reference | None:
    """The reference that `tokens` say, or None if they say none (or contradict themselves)."""
    reading = read_reference(tokens)
    if reading.contradiction or not is_reference(reading) or reading.unknown:
        return None
    return Reference(**reading.found)


def is_reference(reading: Reading) -> bool:
    """Whether something that can be looked for was said at all."""
    if reading.found.get("count") and not reading.found.get("noun"):
        return False
    keys = (
        "noun",
        "colour",
        "material",
        "shape",
        "extreme",
        "ordinal",
        "pronoun",
        "other",
        "plural",
        "side",
        "quality",
        "ids",
    )
    return any(reading.found.get(key) for key in keys)


def _read_relation(relation: RelationWord, others: list[str], reading: Reading) -> None:
    groups = split_list(others) if relation == "between" else [others]
    named: list[Reference] = []
    for group in groups:
        inner = read_reference(group)
        reading.unknown += inner.unknown
        reading.contradiction = reading.contradiction or inner.contradiction
        if is_reference(inner):
            named.append(Reference(**inner.found))
    if relation == "between" and len(named) == 1 and named[0].count == 2:
        named = [named[0].model_copy(update={"count": None, "plural": True})]
    if named:
        reading.found["relation"] = RelationTo(relation=relation, others=tuple(named))
    else:
        reading.unknown += others


def _read_exclusions(groups: list[list[str]], reading: Reading) -> None:
    refused: list[Reference] = []
    for group in groups:
        inner = read_reference(group)
        if is_reference(inner):
            refused.append(Reference(**inner.found))
        reading.unknown += inner.unknown
    reading.found["excluding"] = tuple(refused)


def _read_head(tokens: list[str], reading: Reading) -> None:
    """Reads adjectives, numbers and the head noun, left to right."""
    found, i, after_noun = reading.found, 0, -1
    if " ".join(tokens) in PRONOUNS:
        found["pronoun"] = True
        return
    while i < len(tokens):
        token = tokens[i]
        step = read_number(tokens, i, reading) or read_adjective(tokens, i, reading)
        if not step:
            step = _read_noun(tokens, i, reading)
            after_noun = i + step if step else after_noun
        if step:
            i += step
            continue
        if token in INDEFINITE:
            reading.any = True
        elif token in ("all", "every", "each", "whole"):
            found["plural"] = True
        elif token in ("other", "another", "else", "different", "remaining", "rest"):
            found["other"] = True
            found["plural"] = found.get("plural", False) or token == "rest" or tokens[i:] == ["remaining"]
        elif token in ("one", "ones", "it"):
            found["noun"] = found.get("noun") or ("one" if token != "it" else None)
            found["pronoun"] = found.get("pronoun", False) or token == "it"
        elif token not in (*ARTICLES, *CLAUSE_WORDS, ",", "from", "on", "in", "at", "to", "with", "side", "hand", "colored",
                           "coloured", "color", "colour", "shaped", "looking", "made", "kind", "ish", "end", "edge", "part",
                           "corner", "for", "me", "by", "only", "as", "well", "too", "please", "near", "it", "far", "like", "want", "prefer", "wish", "random", "whatever", "we", "i", "us",
                           *TABLE):  # fmt: skip
            reading.unknown.append(token)
        elif token in TABLE and i + 1 < len(tokens) and (i == 0 or tokens[i - 1] not in ARTICLES):
            reading.unknown.append(token)  # "table objects" is no phrase of ours
        i += 1
    if found.get("noun") is None and reading.unknown:
        _take_unknown_noun(tokens, reading)
    if 0 < after_noun == len(tokens) - 1 and reading.unknown and reading.unknown[-1] == tokens[-1]:
        _take_compound(tokens[-1], reading)


def _read_noun(tokens: list[str], i: int, reading: Reading) -> int:
    found = reading.found
    phrase, length = longest(tokens, i, lexicon.NOUNS, plural=True)
    if phrase:
        plural = phrase != " ".join(tokens[i : i + length])
        if found.get("noun") and found["noun"] != "one":
            _note_second_noun(phrase, reading)
            return length
        found.update(noun=phrase, categories=lexicon.NOUNS[phrase], known=True)
        if plural:
            found["plural"] = True
        return length
    single = singular(tokens[i])
    if single in lexicon.GENERIC or tokens[i] == "ones":
        found["noun"] = found.get("noun") or single
        if tokens[i] in ("everything", "things", "objects", "items", "stuff", "pieces", "ones"):
            found["plural"] = True
        if tokens[i] in ("anything", "something"):
            reading.any = True
        return 1
    phrase, length = longest(tokens, i, lexicon.UNSEEN_NOUNS, plural=True)
    if phrase and not found.get("noun"):
        found.update(noun=phrase, categories=(), known=False)
        return length
    return 0


def _note_second_noun(phrase: str, reading: Reading) -> None:
    """Two head nouns in a row: "apple banana" says no single thing, "phone box" neither."""
    if lexicon.NOUNS[phrase] != reading.found.get("categories"):
        reading.contradiction = reading.contradiction or f"{reading.found['noun']} and {phrase} at once"


def _take_compound(last: str, reading: Reading) -> None:
    """Takes "bottle opener" as a thing that we don't know, and not as a bottle."""
    noun = reading.found.get("noun")
    if (
        noun not in (None, "one", *lexicon.GENERIC)
        and last.isalpha()
        and len(last) > 2
        and not last.endswith("ly")
        and last not in _MANNERS
    ):
        reading.found.update(noun=f"{noun} {singular(last)}", categories=(), known=False)
        reading.unknown = reading.unknown[:-1]


def _take_unknown_noun(tokens: list[str], reading: Reading) -> None:
    """A word we don't know in the place of the head noun ("the gizmo") is a noun that we don't know."""
    determined = any(t in (*ARTICLES, *INDEFINITE) for t in tokens) or reading.found
    last = reading.unknown[-1]
    if determined and last.isalpha() and len(last) > 2 and last not in QUESTION_WORDS:
        reading.found.update(noun=singular(last), categories=(), known=False)
        reading.unknown = reading.unknown[:-1]
