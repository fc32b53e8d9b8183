"""Reads one clause: a verb, the things it is about, and where they are to go."""

from __future__ import annotations

import re

from agent.goal import Goal, Placement, Reference
from agent.language import lexicon
from agent.language.ask_back import CANNOT_READ, AskBack
from agent.language.clauses import HAND_ME, drop_first, find_verb
from agent.language.cut_phrase import TABLE
from agent.language.read_clearing import read_clearing
from agent.language.read_place import read_place
from agent.language.read_reference import is_reference, read_reference
from agent.language.read_sort import read_sort

LET_GO = re.compile(r"^(?:let go|open (?:your|the) (?:hand|gripper|fingers)|release|drop|let it go|free your hand)$")
HAND_TO_ME = re.compile(
    r"^(?:hand|give|pass|bring|offer|deliver|hand over|pass over|take|get)\s+(?P<what>.+?)\s+(?<!nearest )(?<!closest )(?<!farthest )(?<!furthest )(?<!next )(?<!close )"
    r"(?:over )?(?:to|for) me(?: please)?$"
)
CARRIED_TO = re.compile(
    r" (?:over )?to the (?:left|right|front|back|rear|middle|cent(?:er|re))(?: side| end| edge| of the table)?$"
)
GRIP_OF = re.compile(r"^(?:the |its |a )?(?:handle|rim|body|stem|neck|edge|shaft) of (?:the )?")
GRIP = re.compile(
    r" (?:by|at|on|from|with|using) (?:the |its |a |one |an )?(?:handle|rim|body|stem|neck|edge|edges|top|above|side|sides|below|grip|"
    r"(?:pinch|power|side|firm|gentle|soft|tight|strong|light) (?:grasp|grip))$"
)


OFF_THE_TABLE = re.compile(r" (?:off|from|off of|up from|up off) (?:the |my |your )?(?:table|desk|tabletop|table top)$")
"""Where everything is taken from; it tells nothing of the thing."""
IN_ORDER = re.compile(
    r" (?:in|into) (?:an? |the )?(?:[a-z]+ )?(?:order|sequence|row|line)(?: (?:of|by|from|according to))? (?P<how>.+)$"
)


def read_clause(clause: list[str], before: list[Goal]) -> list[Goal] | AskBack | str:
    """The goals of one clause, what to ask back, or why it cannot be done.

    Args:
        clause: tokens without openers and fillers.
        before: goals of earlier clauses, whose verb and object carry over ("then the apple", "put it in the bin").
    """
    line = " ".join(clause)
    whole = read_clearing(line)
    if whole is not None:
        return whole
    if LET_GO.match(line):
        it = Reference(words="it", pronoun=True)
        return [Goal(kind="place", reference=it, placement=Placement(kind="aside", from_hand=True))]
    found = HAND_TO_ME.match(line) or HAND_ME.match(line)
    if found:
        return _each(found["what"].split(), "pick", Placement(kind="hand_over"))
    verb = find_verb(clause)
    if verb is None:
        return _verbless(clause, before)
    action, length = verb
    rest = clause[length:]
    ordered = IN_ORDER.search(" ".join(rest))
    if action == "place" and ordered:
        return read_sort([*" ".join(rest)[: ordered.start()].split(), "by", *ordered["how"].split()])
    if action == "sort":
        return read_sort(rest)
    if action == "discard":
        return _discard(rest)
    if action == "place":
        return _let_go(_place(rest, default=_place_default(clause[:length], rest)), clause[:length], rest)
    if action == "hand":
        thing, placement = read_place(rest)
        if (
            thing
            and placement is not None
            and placement.kind in ("bin", "side", "on", "beside")
            and not {"me", "us"} & set(rest)
        ):
            return _each(thing, "place", placement)  # "bring the cup to the left"
        return _each([t for t in rest if t not in ("me", "over", "us")], "pick", Placement(kind="hand_over"))
    return _pick(rest)


def _let_go(got: list[Goal] | AskBack | str, verb: list[str], rest: list[str]) -> list[Goal] | AskBack | str:
    """The goals of "drop it", "put it down" and "release the cup": about what is in the hand, and nothing else."""
    if not isinstance(got, list):
        return got
    said = " ".join(verb)
    down = "down" in rest or "down" in verb or said in ("drop", "drop off", "lower")
    goals: list[Goal] = []
    for goal in got:
        place, thing = goal.placement, goal.reference
        held = said in ("release", "let go of") or (down and thing is not None and thing.pronoun)
        if place is not None and place.kind == "aside" and held:
            goal = goal.model_copy(update={"placement": place.model_copy(update={"from_hand": True})})
        goals.append(goal)
    return goals


def _place_default(verb: list[str], rest: list[str]) -> Placement | None:
    """Where things go if no place is said: "put it down", "let go of it", "throw it away"."""
    said = " ".join(verb)
    if said in ("dump", "throw", "toss", "chuck") or (said == "put" and "away" in rest):
        return Placement(kind="bin")
    if (
        "down" in rest
        or "aside" in rest
        or "down" in verb
        or said in ("release", "let go of", "drop off", "drop", "leave", "deposit", "lower", "stand", "park")
    ):
        return Placement(kind="aside")
    return Placement(kind="aside") if said in ("move", "shift", "relocate", "carry", "slide", "transfer") else None


def _pick(rest: list[str]) -> list[Goal] | str:
    if rest and rest[-1] == "up":
        rest = rest[:-1]
    if rest and rest[0] == "up":
        rest = rest[1:]
    rest = OFF_THE_TABLE.sub("", " ".join(rest)).split()
    thing, placement = read_place(_without_grip(rest))
    if placement is not None and placement.kind == "aside" and thing and "way" in rest:
        return _each(thing, "place", placement)  # "get the cup out of the way"
    if placement is not None and placement.kind == "side" and CARRIED_TO.search(" ".join(rest)):
        return _each(thing, "place", placement)  # "take the bottle to the right side"
    if placement is not None and thing and placement.kind in ("bin", "hand_over"):
        kind = "pick" if placement.kind == "hand_over" else "place"
        return _each(thing, kind, placement)
    return _each(_without_grip(rest), "pick", None)


def _without_grip(tokens: list[str]) -> list[str]:
    """Takes away "by the handle" and "from above": where and how to grip is planned, not told."""
    line, shorter = "", " ".join(tokens)
    while line != shorter:
        line, shorter = shorter, GRIP.sub("", shorter)
    return GRIP_OF.sub("the ", line).split()


def _place(rest: list[str], default: Placement | None) -> list[Goal] | AskBack | str:
    for i, token in enumerate(rest):  # "the cup on the left and the apple on the right"
        if token in ("and", ",") and _has_place(rest[:i]) and _has_place(rest[i + 1 :]):
            first, second = _place(rest[:i], default), _place(rest[i + 1 :], default)
            return [*first, *second] if isinstance(first, list) and isinstance(second, list) else CANNOT_READ
    if default is not None and " ".join(rest).find("away from") < 0:
        rest = [t for t in rest if t not in ("away", "down", "aside", "off", "out")]
    thing, placement = read_place(rest)
    placement = placement or default
    if placement is None:
        got = _each(thing or ["it"], "place", None)
        where = "Where shall I put it? In the bin, on the left, next to something?"
        return AskBack(where, got[0]) if isinstance(got, list) and len(got) == 1 and thing else where
    if not thing:
        thing = ["it"]
    return _each(thing, "place", placement)


def _has_place(tokens: list[str]) -> bool:
    thing, placement = read_place(tokens)
    if placement is not None and placement.kind in ("on", "beside"):
        return bool(thing) and "between" not in tokens
    return bool(thing) and placement is not None and placement.kind in ("bin", "side", "aside", "hand_over")


def _discard(rest: list[str]) -> list[Goal] | str:
    """Into the bin, unless another fixed place is said; "remove what is on the bowl" says where from, not where to."""
    thing, placement = read_place(rest)
    if placement is not None and placement.kind in ("bin", "side", "aside", "hand_over") and thing:
        return _each(thing, "place", placement)
    rest = [t for t in rest if t not in ("away", "down", "aside", "out")]
    return _each(rest, "place", Placement(kind="bin", or_aside=True))


def _verbless(clause: list[str], before: list[Goal]) -> list[Goal] | str:
    """For "then the apple": the verb of the clause before; "into the bin": its object; a bare thing: a question."""
    thing, placement = read_place(clause)
    moving = [goal for goal in before if goal.moves]
    if placement is not None and not thing and moving:
        return [Goal(kind="place", reference=Reference(words="it", pronoun=True), placement=placement)]
    last = moving[-1] if moving else None
    got = _each(thing or clause, "place" if placement else "pick", placement, strict=True)
    if isinstance(got, str) or not got:
        return CANNOT_READ
    if last is not None:
        return [g.model_copy(update={"kind": last.kind, "placement": placement or last.placement}) for g in got]
    if placement is not None and placement.kind == "bin":
        return got
    if placement is not None:
        return _verbless_thing(clause)
    return [g.model_copy(update={"kind": "answer", "query": None}) for g in got]


def _verbless_thing(clause: list[str]) -> list[Goal] | str:
    """Reads "the one on the left" as a thing, not as a place to put one."""
    got = _each(clause, "pick", None, strict=True)
    return got if isinstance(got, str) else [g.model_copy(update={"kind": "answer", "query": None}) for g in got]


def _each(tokens: list[str], kind: str, placement: Placement | None, *, strict: bool = False) -> list[Goal] | str:
    """One goal per thing of an enumeration ("the cup, the apple and the ball")."""
    goals: list[Goal] = []
    for part in map(drop_first, _apposed(_enumeration(tokens))):
        reading = read_reference(part)
        if reading.contradiction:
            return f"That contradicts itself: {reading.contradiction}."
        if goals and reading.found.get("side") and not reading.found.get("noun") and goals[-1].reference is not None:
            if goals[-1].reference.side is not None:
                return f"That contradicts itself: {goals[-1].reference.side} and {reading.found['side']} at once."
        if not is_reference(reading) or not _readable(reading.unknown, reading.found, strict):
            return CANNOT_READ
        goals.append(
            Goal(kind="pick" if kind == "pick" else "place", reference=Reference(**reading.found), placement=placement)
        )
    return goals or CANNOT_READ


def _apposed(parts: list[list[str]]) -> list[list[str]]:
    """Takes "the cup, the full one" as one thing: the second part only says which."""
    if len(parts) == 2 and parts[1][0] == "any" and parts[1][-1:] == parts[0][-1:]:
        return parts[1:]  # "a cup, any cup"
    if len(parts) != 2 or "one" not in parts[1] or parts[1][0] not in ("the", "that"):
        return parts
    first = read_reference(parts[0]).found
    bare = set(first) <= {"noun", "categories", "known", "words", "plural", "count"} and first.get("noun") != "one"
    return [[*parts[0], *(t for t in parts[1] if t not in ("the", "that", "one"))]] if bare else parts


def _readable(unknown: list[str], found: dict[str, object], strict: bool) -> bool:
    """An unknown adjective before a known noun may pass; more than one, or where no verb was said, may not."""
    if not unknown:
        return True
    if found.get("noun") in lexicon.GENERIC:
        return False  # "something to write with": what is meant is in the word that was not understood
    return not strict and len(unknown) == 1 and unknown[0] not in TABLE and bool(found.get("noun"))


def _enumeration(tokens: list[str]) -> list[list[str]]:
    """Cuts at "and" and commas between things; "between A and B", "except A and B" stay whole."""
    parts: list[list[str]] = [[]]
    for i, token in enumerate(tokens):
        whole = any(word in parts[-1] for word in ("between", "except", "but", "without", "not"))
        correction = token == "," and i + 1 < len(tokens) and tokens[i + 1] in ("not", "but", "except", "which", "that")
        head = bool(parts[-1]) and parts[-1][0] == "not"
        if token in ("and", ",", "&") and not whole and not correction and not head:
            parts.append([])
        else:
            parts[-1].append(token)
    return [part for part in parts if part]
