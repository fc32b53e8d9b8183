"""Reads a noun phrase: "the biggest red cup on the left next to the vase", "everything except the glass", "it"."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from agent.goal import Reference, RelationTo, RelationWord
from agent.language import lexicon
from agent.language.cut_phrase import ARTICLES, TABLE, split_exceptions, split_list, split_relation
from agent.language.words import singular

INDEFINITE = ("a", "an", "any", "some", "either", "whichever")
PRONOUNS = ("it", "that", "this", "them", "him", "these", "those", "that one", "this one")
CLAUSE_WORDS = ("that", "which", "who", "is", "are", "was", "were", "standing", "lying", "sitting", "placed", "located",
                "you", "see", "can", "there", "currently", "situated", "here")  # fmt: skip
STATES = {"filled": "filled", "full": "filled", "empty": "empty"}
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
UNITS = (
    "kg",
    "kilo",
    "kilos",
    "kilogram",
    "kilograms",
    "g",
    "gram",
    "grams",
    "pound",
    "pounds",
    "lb",
    "lbs",
    "cm",
    "mm",
    "n",
)


@dataclass
class Reading:
    """A noun phrase being read: the fields found, what was not understood, and what contradicts itself."""

    found: dict[str, Any] = field(default_factory=dict)
    unknown: list[str] = field(default_factory=list)
    contradiction: str | None = None
    any: bool = False


def read_reference(tokens: list[str]) -> Reading:
    """Reads all of `tokens` as one noun phrase.

    `Reading.found` has the fields of a `Reference`; words that are neither known nor in the place of the head noun are
    left in `unknown`. The caller decides whether that is still understandable.
    """
    reading = Reading()
    tokens, excluded = split_exceptions(tokens)
    head, relation, others = split_relation(tokens)
    _read_head(head, reading)
    if relation is not None:
        _read_relation(relation, others, reading)
    if excluded:
        _read_exclusions(excluded, reading)
    reading.found["words"] = " ".join(tokens)
    if reading.any:
        reading.found["anyone"] = True
    return reading


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


def _longest(
    tokens: list[str], start: int, table: Any, most: int = 3, *, plural: bool = False
) -> tuple[str | None, int]:
    """The longest phrase of `table` at `start` (singular form allowed), and its length."""
    for length in range(min(most, len(tokens) - start), 0, -1):
        phrase = " ".join(tokens[start : start + length])
        if phrase in table:
            return phrase, length
        if plural:
            single = " ".join([*tokens[start : start + length - 1], singular(tokens[start + length - 1])])
            if single in table:
                return single, length
    return None, 0


def _read_head(tokens: list[str], reading: Reading) -> None:
    """Reads adjectives, numbers and the head noun, left to right."""
    found, i = reading.found, 0
    if " ".join(tokens) in PRONOUNS:
        found["pronoun"] = True
        return
    while i < len(tokens):
        token = tokens[i]
        step = _read_number(tokens, i, reading) or _read_adjective(tokens, i, reading) or _read_noun(tokens, i, reading)
        if step:
            i += step
            continue
        if token in INDEFINITE:
            reading.any = True
        elif token in ("all", "every", "each", "whole"):
            found["plural"] = True
        elif token in ("other", "another", "else", "different", "remaining", "rest"):
            found["other"] = True
            found["plural"] = found.get("plural", False) or token in ("remaining", "rest")
        elif token in ("one", "ones", "it"):
            found["noun"] = found.get("noun") or ("one" if token != "it" else None)
            found["pronoun"] = found.get("pronoun", False) or token == "it"
        elif token not in (*ARTICLES, *CLAUSE_WORDS, ",", "from", "on", "in", "at", "to", "with", "side", "hand", "colored",
                           "coloured", "color", "colour", "shaped", "looking", "made", "kind", "ish", "end", "edge", "part",
                           "corner", "for", "me", "by", "only", "as", "well", "too", "please", "near", "it", "far",
                           *TABLE):  # fmt: skip
            reading.unknown.append(token)
        elif token in TABLE and i + 1 < len(tokens) and (i == 0 or tokens[i - 1] not in ARTICLES):
            reading.unknown.append(token)  # "table objects" is no phrase of ours
        i += 1
    if found.get("noun") is None and reading.unknown:
        _take_unknown_noun(tokens, reading)


def _read_number(tokens: list[str], i: int, reading: Reading) -> int:
    found, token = reading.found, tokens[i]
    if token in lexicon.ORDINALS and not (token == "second" and tokens[i + 1 : i + 2] == ["s"]):
        found["ordinal"] = lexicon.ORDINALS[token]
        rest = tokens[i + 1 :]
        for side in ("left", "right", "front", "back"):
            if "from" in rest and side in rest:
                found["ordinal_from"] = side
        return 1
    if token.replace(".", "", 1).isdigit() and tokens[i + 1 : i + 2] and tokens[i + 1] in UNITS:
        return 2
    if token in lexicon.NUMBERS or token.isdigit():
        count = lexicon.NUMBERS.get(token) or int(token)
        found["count"] = count
        found["plural"] = True
        return 1
    if token in ("obj", "object") and i + 1 < len(tokens) and tokens[i + 1].isdigit():
        found["ids"] = (f"obj_{tokens[i + 1]}",)
        found["noun"] = "object"
        return 2
    return 0


def _read_adjective(tokens: list[str], i: int, reading: Reading) -> int:
    found, token = reading.found, tokens[i]
    phrase, length = _longest(tokens, i, lexicon.EXTREMES, 2)
    if phrase and not (phrase in ("middle", "centre", "center", "central") and _says_side(tokens, i)):
        _set(reading, "extreme", lexicon.EXTREMES[phrase])
        return length
    if token in lexicon.COLOURS and not _is_head_noun(tokens, i):
        _set(reading, "colour", token)
        return 1
    if token in lexicon.MATERIALS and (not _is_head_noun(tokens, i) or token not in lexicon.NOUNS):
        if _longest(tokens, i, lexicon.NOUNS, plural=True)[1] > 1:
            return 0
        _set(reading, "material", lexicon.MATERIALS[token])
        return 1
    if token in lexicon.QUALITIES:
        _set(reading, "quality", lexicon.QUALITIES[token])
        return 1
    if token in lexicon.SHAPES:
        _set(reading, "shape", token)
        return 1
    if token in STATES:
        _set(reading, "state", STATES[token])
        return 1
    if token in lexicon.SIDES and "ordinal" not in found:
        _set(reading, "side", lexicon.SIDES[token])
        return 1
    if token in lexicon.SIDES:
        return 1
    return 0


def _read_noun(tokens: list[str], i: int, reading: Reading) -> int:
    found = reading.found
    phrase, length = _longest(tokens, i, lexicon.NOUNS, plural=True)
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
    phrase, length = _longest(tokens, i, lexicon.UNSEEN_NOUNS, plural=True)
    if phrase and not found.get("noun"):
        found.update(noun=phrase, categories=(), known=False)
        return length
    return 0


def _note_second_noun(phrase: str, reading: Reading) -> None:
    """Two head nouns in a row: "apple banana" says no single thing, "phone box" neither."""
    if lexicon.NOUNS[phrase] != reading.found.get("categories"):
        reading.contradiction = reading.contradiction or f"{reading.found['noun']} and {phrase} at once"


def _is_head_noun(tokens: list[str], i: int) -> bool:
    """Whether the word at `i` is the last of its phrase, so that "the glass" and "the orange" are nouns."""
    if tokens[i] not in ("glass", "orange", "china", "tool"):
        return False
    rest = [t for t in tokens[i + 1 :] if t not in (*ARTICLES, *CLAUSE_WORDS, ",")]
    if not rest:
        return True
    nouns = (*lexicon.NOUNS, *lexicon.GENERIC, *lexicon.UNSEEN_NOUNS)
    return not any(singular(t) in nouns or t in lexicon.COLOURS for t in rest)


def _says_side(tokens: list[str], i: int) -> bool:
    return i > 0 and tokens[i - 1] == "the" and i > 1 and tokens[i - 2] in ("in", "on", "at", "to")


def _take_unknown_noun(tokens: list[str], reading: Reading) -> None:
    """A word we don't know in the place of the head noun ("the gizmo") is a noun that we don't know."""
    determined = any(t in (*ARTICLES, *INDEFINITE) for t in tokens) or reading.found
    last = reading.unknown[-1]
    if determined and last.isalpha() and len(last) > 2 and last not in QUESTION_WORDS:
        reading.found.update(noun=singular(last), categories=(), known=False)
        reading.unknown = reading.unknown[:-1]


def _set(reading: Reading, key: str, value: Any) -> None:
    """Sets a field; two different values for it contradict each other."""
    old = reading.found.get(key)
    if old is not None and old != value:
        reading.contradiction = reading.contradiction or f"{old} and {value} at once".replace("_", " ")
    reading.found[key] = value
