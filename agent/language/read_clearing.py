"""Reads the wordings of clearing the table: "clear the table", "put everything in the bin", "tidy up but leave the glass"."""

from __future__ import annotations

import re

from agent.goal import Goal, Placement, Reference
from agent.language import lexicon
from agent.language.read_reference import read_reference

CLEAR = re.compile(
    r"^(?:clear|clean|tidy|empty|free)(?: up| off| away| out)?(?: the| my| this| up the| your)? (?:whole |entire )?"
    r"(?:table|desk|tabletop|workspace|surface|scene|mess|everything|place|all)(?: up| off| away| please| completely)*"
    r"(?: (?:into|in|to) (?:the )?(?:bin|trash|basket))?(?P<rest> .*)?$"
)
CLEAN_UP = re.compile(r"^(?:clean|tidy|clear) (?:up|away)(?: here)?(?P<rest> (?:except|but|without|apart from) .*)?$")
EVERYTHING_AWAY = re.compile(
    r"^(?:put|place|move|throw|get|take|remove|discard|drop|toss|bring|pick up|pick|bin|trash|dispose of|get rid of|put away|"
    r"throw away|collect|dump|throw out) (?:away )?(?P<what>(?:everything|all(?: of)?(?: the| these| those)? (?:things|objects|items|stuff)"
    r"|all of it|it all|the (?:objects|things|items)|all|every (?:object|thing|item)|each (?:object|thing|item)).*?)"
    r"(?P<where> (?:away|out|off|up|(?:off|from) the table|(?:in|into|to|inside) (?:the |a )?(?:bin|trash(?: can)?|basket|garbage|"
    r"rubbish(?: bin)?|tray|dustbin)))*(?P<rest> (?:except|but|apart from|other than|without) .*)?$"
)
KEEPING = re.compile(r"^(?:pick|take|get(?! rid)|collect|put(?! away)|place|move|bring)\b")
"""Verbs that clear only where the bin is said (or "away", "off the table")."""
OTHER_PLACE = re.compile(
    r"\b(?:on|to|in|at|into|onto) (?:the )?(?:left|right|middle|cent(?:er|re)|front|back|bowl|box|cup|mug|other side|side)\b|\bto (?:me|us)\b|"
    r"\b(?:next to|beside|behind|in front of|on top of|between|near)\b"
)
BIN_SAID = re.compile(r"\b(?:" + "|".join(lexicon.BINS) + r")\b")


def read_clearing(line: str) -> list[Goal] | None:
    """Clearing the table in any of its wordings."""
    for regex in (CLEAR, CLEAN_UP, EVERYTHING_AWAY):
        found = regex.match(line)
        if not found:
            continue
        if regex is EVERYTHING_AWAY and KEEPING.match(line) and (found["where"] or "").strip() in ("", "up"):
            return None
        if regex is EVERYTHING_AWAY and OTHER_PLACE.search(line) and not BIN_SAID.search(line):
            return None
        spared = (found["rest"] or "").split()
        what = (found.groupdict().get("what") or "everything").split()
        reading = read_reference([*what, *spared])
        if reading.contradiction or reading.unknown:
            return None
        noun = reading.found.get("noun")
        if noun is None or noun in lexicon.GENERIC:  # "all the cups" are the cups, not everything
            noun = "everything"
        reference = Reference(**{**reading.found, "plural": True, "noun": noun})
        return [Goal(kind="clear", reference=reference, placement=Placement(kind="bin"))]
    return None
