"""Reads the words before a noun: numbers, ordinals, colours, materials, sizes, states and sides."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from agent.language import lexicon
from agent.language.cut_phrase import ARTICLES
from agent.language.words import singular

CLAUSE_WORDS = ("that", "which", "who", "is", "are", "was", "were", "standing", "lying", "sitting", "placed", "located",
                "you", "see", "can", "there", "currently", "situated", "here")  # fmt: skip
STATES = {"filled": "filled", "full": "filled", "empty": "empty"}
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

SHADES = ("light", "dark", "bright", "pale", "deep", "bluish", "reddish")
"""Words before a colour that say which kind of it."""


@dataclass
class Reading:
    """A noun phrase being read: the fields found, what was not understood, and what contradicts itself."""

    found: dict[str, Any] = field(default_factory=dict)
    unknown: list[str] = field(default_factory=list)
    contradiction: str | None = None
    any: bool = False


def longest(
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


def read_number(tokens: list[str], i: int, reading: Reading) -> int:
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


def read_adjective(tokens: list[str], i: int, reading: Reading) -> int:
    found, token = reading.found, tokens[i]
    phrase, length = longest(tokens, i, lexicon.EXTREMES, 2)
    if phrase and not (phrase in ("middle", "centre", "center", "central") and _says_side(tokens, i)):
        set_field(reading, "extreme", lexicon.EXTREMES[phrase])
        return length
    if token in SHADES and tokens[i + 1 : i + 2] and tokens[i + 1] in lexicon.COLOURS:
        return 1  # "light green" is a green
    if token in lexicon.COLOURS and not _is_head_noun(tokens, i):
        set_field(reading, "colour", token)
        return 1
    if token in lexicon.MATERIALS and (not _is_head_noun(tokens, i) or token not in lexicon.NOUNS):
        if longest(tokens, i, lexicon.NOUNS, plural=True)[1] > 1:
            return 0
        set_field(reading, "material", lexicon.MATERIALS[token])
        return 1
    if token in lexicon.QUALITIES:
        set_field(reading, "quality", lexicon.QUALITIES[token])
        return 1
    if token in lexicon.SHAPES:
        set_field(reading, "shape", token)
        return 1
    if token in STATES:
        set_field(reading, "state", STATES[token])
        return 1
    if token in lexicon.SIDES and "ordinal" not in found:
        set_field(reading, "side", lexicon.SIDES[token])
        return 1
    if token in lexicon.SIDES:
        return 1
    return 0


def _is_head_noun(tokens: list[str], i: int) -> bool:
    """Whether the word at `i` is the last of its phrase, so that "the glass" and "the orange" are nouns."""
    if tokens[i] not in ("glass", "orange", "china", "tool"):
        return False
    if "made" in tokens[:i]:
        return False
    rest = [t for t in tokens[i + 1 :] if t not in (*ARTICLES, *CLAUSE_WORDS, ",")]
    if not rest:
        return True
    nouns = (*lexicon.NOUNS, *lexicon.GENERIC, *lexicon.UNSEEN_NOUNS)
    return not any(singular(t) in nouns or t in lexicon.COLOURS for t in rest)


def _says_side(tokens: list[str], i: int) -> bool:
    return i > 0 and tokens[i - 1] == "the" and i > 1 and tokens[i - 2] in ("in", "on", "at", "to")


def set_field(reading: Reading, key: str, value: Any) -> None:
    """Sets a field; two different values for it contradict each other."""
    old = reading.found.get(key)
    if old is not None and old != value:
        reading.contradiction = reading.contradiction or f"{old} and {value} at once".replace("_", " ")
    reading.found[key] = value
