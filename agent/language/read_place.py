"""Finds where a thing is to go: "in the bin", "on the left", "next to the vase", "back where it was"."""

from __future__ import annotations

import re

from agent.goal import Placement, Reference, RelationWord, Side
from agent.language import lexicon
from agent.language.read_reference import is_reference, read_reference

SIDE = re.compile(
    r"^(?:(?:in|on|to|at|onto|into|toward|towards|over|more|further|a bit|little|the|far|very)\s+)*"
    r"(?P<side>left|right|front|back|rear|middle|centre|center)(?:\s*(?:hand )?(?:side|part|edge|end|half|corner|of the (?:table|desk)|"
    r"over there|there|please))*$"
)
BIN = re.compile(
    r"^(?:in|into|inside|to|onto|on|inside of|towards|over)\s+(?:the |a |that |my )?(?:"
    + "|".join(lexicon.BINS)
    + r")$"
)
BACK = re.compile(r"^back(?: (?:down|again|where .*|in(?:to)? .*|on .*|to .*))?$")
ASIDE = re.compile(
    r"^(?:(?:far |further )?away from .+|aside|away|down|somewhere(?: else| safe| nice| suitable| free| better| out of the way)?|elsewhere|out of the way|to (?:the|one) side|anywhere|to a free (?:place|spot)|"
    r"(?:on|onto|down on|back on|back onto) the (?:table|desk)|off|over)$"
)
ME = re.compile(r"^(?:over )?(?:to|for|in(?:to)? my hand|in front of) ?(?:me|us|my hand)?$")
RELATIONS: dict[RelationWord, RelationWord] = {
    "near": "near", "left_of": "left_of", "right_of": "right_of", "behind": "behind", "in_front_of": "in_front_of",
    "between": "between", "nearest_to": "near", "touching": "near",
}  # fmt: skip


def read_place(tokens: list[str]) -> tuple[list[str], Placement | None]:
    """Cuts a clause's rest into the thing and its destination: (tokens of the thing, placement or None).

    The last phrase that can be a destination is one, so that "the cup on the left next to the vase" keeps its first
    qualifier with the thing, and goes next to the vase.
    """
    for start in range(1, len(tokens)):
        placement = _fixed(" ".join(tokens[start:]))
        if placement is not None and tokens[start - 1] in (
            "closest",
            "nearest",
            "close",
            "near",
            "next",
            "furthest",
            "farthest",
        ):
            continue  # "the cup closest to me" is a thing, not a destination
        if placement is not None:
            return _without_comma(tokens[:start]), placement
    best: tuple[list[str], Placement | None] = (tokens, None)
    for start in range(len(tokens)):
        placement = _fixed(" ".join(tokens[start:])) if start == 0 else None
        placement = placement or _beside(tokens[start:])
        if placement is not None and (start == 0 or not _dangling(tokens[:start])):
            best = (_without_comma(tokens[:start]), placement)
    return best


def _fixed(text: str) -> Placement | None:
    if BIN.match(text):
        return Placement(kind="bin")
    if BACK.match(text):
        return Placement(kind="back")
    if ASIDE.match(text):
        return Placement(kind="aside")
    if ME.match(text) and text.split()[-1] in ("me", "us", "hand"):
        return Placement(kind="hand_over")
    found = SIDE.match(text)
    if found and text != found["side"]:
        side: Side = lexicon.SIDES[found["side"]]
        return Placement(kind="side", side=side)
    return None


def _beside(tokens: list[str]) -> Placement | None:
    """A destination relative to another thing."""
    for phrase, relation in lexicon.RELATIONS:
        parts = phrase.split()
        if tokens[: len(parts)] != parts or parts[0] in ("from", "off", "out"):
            continue
        rest = [t for t in tokens[len(parts) :] if t != "to"]
        reading = read_reference(["thing", *tokens]) if relation == "between" else read_reference(rest)
        if relation == "between":
            found = reading.found.get("relation")
            if found is None or reading.unknown:
                return None
            return Placement(
                kind="beside", relation="between", reference=Reference(words=" ".join(tokens), relation=found)
            )
        if reading.unknown or reading.contradiction or not is_reference(reading):
            return None
        if reading.found.get("noun") is None and not reading.found.get("pronoun") and "colour" not in reading.found:
            return None
        other = Reference(**reading.found)
        if relation in ("on", "in", "under"):
            return None if relation == "under" else Placement(kind="on", relation=relation, reference=other)
        return Placement(kind="beside", relation=RELATIONS[relation], reference=other)
    if tokens[:1] == ["to"] and tokens[1:2] and tokens[1] in ("the", "that", "this", "my", "a"):
        reading = read_reference(tokens[1:])  # "to the bowl" is into it, "to the vase" beside it
        if reading.unknown or reading.found.get("side") or not reading.found.get("categories"):
            return None
        into = reading.found["noun"] in lexicon.CONTAINERS
        return _beside(["in" if into else "near", *tokens[1:]])
    return None


def _dangling(tokens: list[str]) -> bool:
    """Whether what is left as the thing ends in half a phrase ("the cup to")."""
    if tokens[-1] == "right" and tokens[-2:-1] != ["the"]:
        return True
    return tokens[-1] in (
        "next",
        "close",
        "closer",
        "nearer",
        "near",
        "nearest",
        "closest",
        "adjacent",
        "up",
        "to",
        "on",
        "in",
        "at",
        "the",
        "of",
        "standing",
        "lying",
        "is",
        "that",
    )


def _without_comma(tokens: list[str]) -> list[str]:
    while tokens and tokens[-1] in (",", "is", "that", "over", "right", "up"):
        tokens = tokens[:-1]
    return tokens
