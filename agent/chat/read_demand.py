"""How something is to be done, read from free wording: "by the handle", "gently", "from the side", "with 5 N"."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from typing import Any

from agent.language.words import words
from kb.errors import BadInputError
from kb.grasp import MAX_APERTURE, MAX_FORCE, MIN_FORCE
from tools.planning.demand import Demand

GENTLER, FIRMER = 0.7, 1.4
"""What "gentler" and "firmer" do to the force."""
SLOWER, FASTER = 0.5, 1.5
"""What "slower" and "faster" do to the speed."""

_REGIONS = {
    "handle": "handle", "grip": "handle", "rim": "rim", "lip": "rim", "brim": "rim", "edge": "edge", "border": "edge",
    "stem": "stem", "neck": "neck", "body": "body", "middle": "body", "belly": "body", "waist": "body", "centre": "body",
    "center": "body",
}  # fmt: skip
_PLACE = "|".join(_REGIONS)
_PREPOSITION = r"(?:by|at|using|use|only by|take|grab|grasp|hold|grip)"
_MORE = r"(?:much |a bit |a little |even |way |far |more |still |very |really |too |so |please )*"
_NUMBER = r"(\d+(?:\.\d+)?)"

Reader = Callable[[re.Match[str]], dict[str, Any]]


def _region(found: re.Match[str]) -> dict[str, Any]:
    return {"region": _REGIONS[found[1]]}


def _not_region(found: re.Match[str]) -> dict[str, Any]:
    return {"not_region": _REGIONS[found[1]]}


def _force(found: re.Match[str]) -> dict[str, Any]:
    force = float(found[1])
    if not MIN_FORCE <= force <= MAX_FORCE:
        raise BadInputError(
            f"the hand closes with {MIN_FORCE:g} to {MAX_FORCE:g} N, not with {force:g} N", where="force"
        )
    return {"force": force}


def _aperture(found: re.Match[str]) -> dict[str, Any]:
    metres = float(found[1]) * (0.01 if found[2] == "cm" else 0.001)
    if not 0.0 < metres <= MAX_APERTURE:
        raise BadInputError(f"the hand opens up to {MAX_APERTURE * 1000:g} mm", where="opening")
    return {"aperture": metres}


def _fixed(**values: Any) -> Reader:
    return lambda _found: values


_READERS: tuple[tuple[re.Pattern[str], Reader], ...] = tuple(
    (re.compile(rf"(?:^|(?<= ))(?:{pattern})(?= |$)"), reader)
    for pattern, reader in (
        (rf"(?:but |and )?(?:not|never|do not use|do not take|avoid|do not touch) (?:{_PREPOSITION} )?(?:the|its|that|his) ({_PLACE})", _not_region),
        (rf"(?:{_PREPOSITION} )(?:it )?(?:{_PREPOSITION} )?(?:the|its|that) ({_PLACE})(?: of it)?(?: instead| this time| only| rather)*", _region),
        (rf"(?:the|its) ({_PLACE}) (?:instead|rather|this time)", _region),
        (rf"(?:with |using |at |use |only |and )*{_NUMBER} ?(?:n|newtons?)(?: of force)?(?: of force| instead| this time| only)*", _force),
        (rf"(?:with |using |at )?(?:a )?force(?: of|=| =| to| at)? ?{_NUMBER}(?: ?(?:n|newtons?))?", _force),
        (rf"(?:with |using )?(?:an? |the )?(?:hand |fingers )?(?:opening|aperture|opened|open)(?: by| of| to| at)? ?{_NUMBER} ?(mm|cm)(?: wide| open)*", _aperture),
        (rf"{_NUMBER} ?(mm|cm) (?:opening|aperture|open|wide)(?: opening)?", _aperture),
        (r"from (?:the |its )?sides?(?: of it)?|sideways|horizontally|with a side (?:grasp|grip)|side (?:grasp|grip)", _fixed(approach="side")),
        (r"(?:from|straight from) (?:above|the top|on top|overhead)|top down|vertically|straight down|from straight above", _fixed(approach="top")),
        (r"(?:at an angle|tilted|obliquely|diagonally|slanted)", _fixed(approach="tilted")),
        (r"(?:with |using |by )?(?:a |an )?pinch(?:ing)?(?: grasp| grip)?|pinch it", _fixed(type="pinch")),
        (r"(?:with |using |by )?(?:a |an )?power (?:grasp|grip)", _fixed(type="power")),
        (rf"{_MORE}(?:gentler|softer|lighter|gently|softly|lightly|tenderly)|{_MORE}(?:with )?less force|not (?:so|that|too) (?:hard|tight|tightly|firmly|strongly)|{_MORE}less (?:hard|tight|tightly|firmly)|{_MORE}looser|do not squeeze(?: it)?(?: so| too)?(?: hard| much)?",
         _fixed(force_scale=GENTLER)),
        (rf"{_MORE}(?:firmer|tighter|harder|stronger|firmly|tightly|strongly)|{_MORE}(?:with )?more force", _fixed(force_scale=FIRMER)),
        (rf"{_MORE}(?:slower|slowly|carefully)|not (?:so|that|too) fast|less fast", _fixed(speed_scale=SLOWER)),
        (rf"{_MORE}(?:faster|quicker|quickly|fast)", _fixed(speed_scale=FASTER)),
        (r"(?:open (?:the hand |your hand )?wider|with (?:the |your )?hand wide open|wide open|open wide)", _fixed(aperture=MAX_APERTURE)),
        (r"(?:with (?:the )?|and )?(?:yaw|turn(?:ed)?|rotated?)(?: (?:the )?(?:hand|wrist|gripper|it))?(?: by| to| of| =)? ?(-?\d+(?:\.\d+)?) ?(?:deg(?:rees?)?|°)",
         lambda found: {"yaw": math.radians(float(found[1]))}),
    )
)  # fmt: skip
"""Phrase -> fields of a demand, tried in this order over the cleaned text."""

_GLUE = re.compile(
    r"^(?:no|nope|wait|but|and|rather|instead|please|then|this time|hold it|take it|grab it|grasp it|,|\.|;|try|it|now|do it|make it|be|go|a bit|a little|once|just|better|i mean|i said|the|to|with|use)\b ?|^[,.;] ?"
)


NEWTONS = re.compile(r"(\d) ?n\b")


def plain(text: str) -> str:
    """The text in cleaned words joined by spaces."""
    return " ".join(words(text))


def read_demand(text: str) -> tuple[str, Demand | None]:
    """What is left of the cleaned text without its demands, and the demand (None if there is none).

    Raises:
        BadInputError: a number that the hand cannot do.
    """
    values: dict[str, Any] = {}
    said: list[tuple[int, str]] = []
    rest = text
    for pattern, reader in _READERS:
        found = pattern.search(rest)
        if found is None:
            continue
        values = reader(found) | values
        said.append((text.find(found[0]), found[0]))
        rest = f"{rest[: found.start()].rstrip()} {rest[found.end() :].lstrip()}".strip()
    if not values:
        return text, None
    wording = NEWTONS.sub(r"\1 N", ", ".join(part for _, part in sorted(said)).strip(" ,."))
    return rest, Demand(words=wording, **values)


def only_demand(text: str) -> Demand | None:
    """The demand, if the cleaned text says nothing else ("no, by the handle")."""
    rest, demand = read_demand(text)
    while demand is not None and rest:
        shorter = _GLUE.sub("", rest, count=1).strip()
        if shorter == rest:
            return None
        rest = shorter
    return demand
