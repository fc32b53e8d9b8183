"""Reads an instruction in free wording into typed goals, a refusal, or a question back.

The order is: clean, recognise questions, cut into clauses ("first ..., then ..."), read each clause as verb, things and
place, and at last look whether it all fits together. What is not understood is refused with a reason; nothing is guessed
that would move the robot.
"""

from __future__ import annotations

import re

from agent.goal import Goal, Measure, Placement, Reference, Understanding
from agent.language import lexicon
from agent.language.asides import without_asides
from agent.language.read_place import read_place
from agent.language.read_question import read_question
from agent.language.read_reference import is_reference, read_reference
from agent.language.refusals import refuse
from agent.language.words import mend, words

CANNOT_READ = (
    "I did not understand that. I can pick things up, put them somewhere, clear the table, sort things, and answer "
    'questions about what I see and why I did what I did. Say "help" for examples.'
)
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
LET_GO = re.compile(r"^(?:let go|open (?:your|the) (?:hand|gripper|fingers)|release|drop|let it go|free your hand)$")
GERUNDS = {
    "handing": "hand", "picking": "pick", "putting": "put", "giving": "give", "passing": "pass", "bringing": "bring",
    "taking": "take", "grabbing": "grab", "lifting": "lift", "moving": "move", "placing": "place", "clearing": "clear",
    "sorting": "sort", "getting": "get", "fetching": "fetch", "grasping": "grasp", "holding": "hold", "removing": "remove",
    "throwing": "throw", "dropping": "drop", "setting": "set", "tidying": "tidy", "cleaning": "clean", "ordering": "order",
    "arranging": "arrange", "raising": "raise", "collecting": "collect",
}  # fmt: skip
HAND_ME = re.compile(
    r"^(?:i (?:want|need|would like(?: to have)?|could use|would love)|(?:can|could|may|might) i (?:please )?(?:have|get)|"
    r"let me have|i will (?:have|take)|i am looking for|get me|fetch me|bring me|grab me|give me|hand me|pass me|"
    r"hand over|pass over)\s+(?!to\b|you\b)(?P<what>.+)$"
)
HAND_TO_ME = re.compile(
    r"^(?:hand|give|pass|bring|offer|deliver|hand over|pass over|take|get)\s+(?P<what>.+?)\s+(?:over )?(?:to|for) me(?: please)?$"
)
CLEAR = re.compile(
    r"^(?:clear|clean|tidy|empty|free)(?: up| off| away| out)?(?: the| my| this| up the| your)? (?:whole |entire )?"
    r"(?:table|desk|tabletop|workspace|surface|scene|mess|everything|place|all)(?: up| off| away| please| completely)*"
    r"(?: (?:into|in|to) (?:the )?(?:bin|trash|basket))?(?P<rest> .*)?$"
)
CLEAN_UP = re.compile(r"^(?:clean|tidy|clear) (?:up|away)(?: here)?(?P<rest> (?:except|but|without|apart from) .*)?$")
EVERYTHING_AWAY = re.compile(
    r"^(?:put|place|move|throw|get|take|remove|discard|drop|toss|bring|pick up|pick|bin|trash|dispose of|get rid of|put away|"
    r"throw away|collect|dump|throw out) (?:away )?(?P<what>(?:everything|all(?: of)?(?: the| these| those)? (?:things|objects|items|stuff)"
    r"|all of (?:it|them)|it all|the (?:objects|things|items)|all|them all|every (?:object|thing|item)|each (?:object|thing|item)).*?)"
    r"(?P<where> (?:away|out|off|up|(?:off|from) the table|(?:in|into|to|inside) (?:the |a )?(?:bin|trash(?: can)?|basket|garbage|"
    r"rubbish(?: bin)?|tray|dustbin)))*(?P<rest> (?:except|but|apart from|other than|without) .*)?$"
)
SORTED_BY = re.compile(
    r"\b(?:by|according to|based on|after|in order of|in terms of|with respect to|how|from|on)\s+(?P<how>.+)$"
)
DESCENDING = re.compile(
    r"\b(?:descending|decreasing|(?:most|biggest|largest|heaviest|tallest|most fragile) (?:one |ones |fragile |things |objects )?"
    r"first|from (?:the )?(?:most|big|biggest|large|largest|heavy|heaviest|tall|tallest|high|fragile)\b|reverse)"
)
FROM_RIGHT = re.compile(r"\bfrom (?:the )?right to (?:the )?left\b")
NOT_DO = re.compile(
    r"^(?:please )?(?:do not|never|not|you (?:must|should|shall|may) not|avoid|refrain from)\s+(?P<rest>.+)$"
)
GRIP_OF = re.compile(r"^(?:the |its |a )?(?:handle|rim|body|stem|neck|edge|shaft) of (?:the )?")
GRIP = re.compile(
    r" (?:by|at|on|from|with|using) (?:the |its |a |one |an )?(?:handle|rim|body|stem|neck|edge|edges|top|above|side|sides|below|grip|"
    r"(?:pinch|power|side|firm|gentle|soft|tight|strong|light) (?:grasp|grip))$"
)
LEAVE_ALONE = re.compile(
    r"^(?:leave|keep) (?P<what>.+?) (?:alone|as (?:it|they) (?:is|are)|untouched|where (?:it|they) (?:is|are)|there|in place)$"
)


def understand(text: str, *, pending: Goal | None = None) -> Understanding:
    """What the instruction means.

    Args:
        text: the instruction as typed, at most 10,000 characters.
        pending: the goal about which the agent asked back last, which a bare noun phrase then completes.
    """
    tokens = trim(words(text))
    if not tokens:
        return Understanding(refusal=CANNOT_READ)
    line = " ".join(tokens)
    asked = read_question(line)
    if asked is None and line.startswith(lexicon.OPENERS):
        asked = read_question(" ".join(strip_opener(tokens)))
    if isinstance(asked, str):
        return Understanding(refusal=asked)
    if asked is not None:
        return Understanding(goals=(asked,))
    refusal = refuse(line)
    if refusal is not None:
        return Understanding(refusal=refusal)
    if pending is not None:
        completed = _complete(tokens, pending)
        if completed is not None:
            return completed
    return _commands(trim(without_asides(" ".join(strip_opener(tokens))).split()))


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


def _complete(tokens: list[str], pending: Goal) -> Understanding | None:
    """A bare noun phrase answers the question that was asked back: "the red one", "the left one", "the second"."""
    if find_verb(strip_opener(tokens)) is not None:
        return None
    if " ".join(tokens) in ("none", "neither", "none of them", "no", "neither of them", "nothing"):
        return Understanding(refusal="All right, I leave everything as it is.")
    reading = read_reference(
        [t for t in tokens if t not in ("i", "mean", "meant", "am", "yes", "no", ",", "take", "think", "want")]
    )
    if reading.unknown or reading.contradiction or not is_reference(reading):
        return None
    said, before = Reference(**reading.found), pending.reference or Reference()
    if said.categories or not said.known:
        merged = said
    else:
        new = {
            k: v for k, v in reading.found.items() if k not in ("noun", "words", "categories", "known", "pronoun") and v
        }
        merged = before.model_copy(update={**new, "words": f"{before.words} ({said.words})"})
    return Understanding(goals=(pending.model_copy(update={"reference": merged, "target": None}),))


def _commands(tokens: list[str]) -> Understanding:
    goals: list[Goal] = []
    forbidden: list[Reference] = []
    clauses = split_clauses(strip_opener(tokens))
    for index, clause in enumerate(clauses):
        # "take the bowl, but first remove what is on it"
        before = index > 0 and clause[:1] == ["first"] and find_verb(clause[1:]) is not None
        clause = strip_opener(trim(clause[1:] if before else clause))
        clause = [GERUNDS.get(clause[0], clause[0]), *clause[1:]]
        line = " ".join(clause)
        negative = NOT_DO.match(line) or LEAVE_ALONE.match(line)
        if negative:
            forbidden += _forbidden(negative)
            continue
        asked = read_question(line)
        if isinstance(asked, Goal):
            if asked.query != "stop":
                goals.append(asked)
            continue
        refusal = refuse(line)
        if refusal is not None:
            return Understanding(refusal=refusal)
        got = read_clause(clause, goals)
        if isinstance(got, str):
            return Understanding(refusal=got)
        goals += [goal.model_copy(update={"parent": 0}) for goal in got] if before and goals else got
    if len(clauses) > 1:  # "first the cup, then the apple": an order of things says that they are to be taken
        goals = [g if g.moves or g.query else g.model_copy(update={"kind": "pick"}) for g in goals]
    return _fit(goals, forbidden)


def _forbidden(found: re.Match[str]) -> list[Reference]:
    """The things that a "do not ..." clause protects."""
    rest = (found.groupdict().get("rest") or found.groupdict().get("what") or "").split()
    verb = find_verb(rest)
    things = (
        rest[verb[1] :] if verb else [t for t in rest if t not in ("touch", "touching", "break", "moving", "damage")]
    )
    reading = read_reference(things)
    return [Reference(**reading.found)] if is_reference(reading) and not reading.contradiction else []


def _fit(goals: list[Goal], forbidden: list[Reference]) -> Understanding:
    """Checks that the clauses agree with each other."""
    if not goals:
        if forbidden:
            return Understanding(refusal=f"All right: I leave {_the(forbidden[0])} alone. There is nothing else to do.")
        return Understanding(refusal=CANNOT_READ)
    for goal in goals:
        for taboo in forbidden:
            if goal.moves and goal.reference is not None and _same(goal.reference, taboo):
                return Understanding(
                    refusal=f"That contradicts itself: I am to handle {_the(taboo)} and not to. Nothing was moved."
                )
    goals = _bound(_without_repeats(goals))
    spared = tuple(forbidden)
    if spared:
        goals = [_sparing(goal, spared) if goal.kind in ("clear", "sort") else goal for goal in goals]
    return Understanding(goals=tuple(goals))


def _without_repeats(goals: list[Goal]) -> list[Goal]:
    """Drops "... and lift it" after "grip the cup", and a second clearing of the table."""
    kept: list[Goal] = []
    for goal in goals:
        reference = goal.reference
        again = bool(kept) and reference is not None and reference.pronoun and kept[-1].moves
        if again and goal.kind == "pick" and goal.placement is None and kept[-1].kind == "pick":
            continue
        if kept and kept[-1].kind == "clear" and (goal.kind == "clear" or (again and goal.kind == "place")):
            continue
        kept.append(goal)
    return kept


def _bound(goals: list[Goal]) -> list[Goal]:
    """In "take the bowl, but first remove what is on it" the pronoun means the bowl."""
    bound: list[Goal] = []
    for index, goal in enumerate(goals):
        reference = goal.reference
        others = [
            g.reference for i, g in enumerate(goals) if i != index and g.reference is not None and g.reference.noun
        ]
        relation = reference.relation if reference is not None else None
        if reference is not None and relation is not None and others and any(o.pronoun for o in relation.others):
            named = tuple(others[0] if o.pronoun else o for o in relation.others)
            relation = relation.model_copy(update={"others": named})
            goal = goal.model_copy(update={"reference": reference.model_copy(update={"relation": relation})})
        bound.append(goal)
    return bound


def _sparing(goal: Goal, spared: tuple[Reference, ...]) -> Goal:
    reference = goal.reference or Reference(words="everything", noun="everything", plural=True)
    return goal.model_copy(
        update={"reference": reference.model_copy(update={"excluding": (*reference.excluding, *spared)})}
    )


def _the(reference: Reference) -> str:
    text = "it" if reference.pronoun else reference.words or reference.noun or "it"
    return (
        text
        if text.split()[0] in ("the", "it", "that", "this", "my", "your", "all", "any", "a", "an")
        else f"the {text}"
    )


def _same(one: Reference, other: Reference) -> bool:
    """Whether two references speak of the same thing for all that was said."""
    if one.pronoun or other.pronoun:
        return other.pronoun
    plain = (one.noun, one.colour, one.material, one.side, one.ordinal, one.extreme, one.relation)
    return plain == (other.noun, other.colour, other.material, other.side, other.ordinal, other.extreme, other.relation)


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
    return [clause if index else _drop_first(clause) for index, clause in enumerate(c for c in clauses if c)]


def _drop_first(clause: list[str]) -> list[str]:
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


UNABLE_START = re.compile(r"^(?:" + "|".join(sorted(lexicon.UNABLE, key=len, reverse=True)) + r")\b")


def find_verb(tokens: list[str]) -> tuple[str, int] | None:
    """(action, length) of the verb at the start of a clause, or None."""
    for verb, action in VERBS:
        parts = verb.split()
        if tokens[: len(parts)] == parts:
            return action, len(parts)
    return None


def read_clause(clause: list[str], before: list[Goal]) -> list[Goal] | str:
    """The goals of one clause, or why it cannot be done.

    Args:
        clause: tokens without openers and fillers.
        before: goals of earlier clauses, whose verb and object carry over ("then the apple", "put it in the bin").
    """
    line = " ".join(clause)
    whole = _whole_table(line)
    if whole is not None:
        return whole
    if LET_GO.match(line):
        return [Goal(kind="place", reference=Reference(words="it", pronoun=True), placement=Placement(kind="aside"))]
    found = HAND_TO_ME.match(line) or HAND_ME.match(line)
    if found:
        return _each(found["what"].split(), "pick", Placement(kind="hand_over"))
    verb = find_verb(clause)
    if verb is None:
        return _verbless(clause, before)
    action, length = verb
    rest = clause[length:]
    if action == "sort":
        return _sort(rest)
    if action == "discard":
        return _discard(rest)
    if action == "place":
        return _place(rest, default=_place_default(clause[:length], rest))
    if action == "hand":
        return _each([t for t in rest if t not in ("me", "over", "us")], "pick", Placement(kind="hand_over"))
    return _pick(rest)


def _place_default(verb: list[str], rest: list[str]) -> Placement | None:
    """Where things go if no place is said: "put it down", "let go of it", "throw it away"."""
    said = " ".join(verb)
    if said in ("dump", "throw", "toss", "chuck") or (said == "put" and "away" in rest):
        return Placement(kind="bin")
    if (
        "down" in rest
        or "aside" in rest
        or "down" in verb
        or said in ("release", "let go of", "drop off", "drop", "leave", "deposit")
    ):
        return Placement(kind="aside")
    return Placement(kind="aside") if said in ("move", "shift", "relocate", "carry", "slide", "transfer") else None


def _whole_table(line: str) -> list[Goal] | None:
    """Clearing the table in any of its wordings."""
    for regex in (CLEAR, CLEAN_UP, EVERYTHING_AWAY):
        found = regex.match(line)
        if not found:
            continue
        if regex is EVERYTHING_AWAY and line.split()[0] in ("pick", "take", "get", "collect") and not found["where"]:
            return None
        spared = (found["rest"] or "").split()
        what = (found.groupdict().get("what") or "everything").split()
        reading = read_reference([*what, *spared])
        if reading.contradiction or reading.unknown:
            return None
        reference = Reference(**{**reading.found, "plural": True, "noun": "everything"})
        return [Goal(kind="clear", reference=reference, placement=Placement(kind="bin"))]
    return None


def _sort(rest: list[str]) -> list[Goal] | str:
    line = " ".join(rest)
    by = SORTED_BY.search(line)
    measure: Measure | None = None
    for token in (by["how"] if by else line).split():
        measure = measure or lexicon.MEASURES.get(mend(token)) or _measure_of(token)
    if measure is None:
        return "I can sort by fragility, by size or by weight. By which?"
    what = line[: by.start()].split() if by else []
    what = [
        t for t in what if t not in ("out", "up", "them", "it", "from", "left", "to", "right", "in", "a", "row", "line")
    ]
    reading = read_reference(what or ["everything"])
    if reading.unknown or reading.contradiction:
        return CANNOT_READ
    reference = Reference(**{**reading.found, "plural": True})
    descending = bool(DESCENDING.search(line)) != bool(FROM_RIGHT.search(line))
    return [Goal(kind="sort", reference=reference, measure=measure, descending=descending)]


def _measure_of(token: str) -> Measure | None:
    extremes: dict[str, Measure] = {
        "biggest": "size", "smallest": "size", "largest": "size", "tallest": "size", "shortest": "size",
        "heaviest": "weight", "lightest": "weight", "sturdiest": "fragility", "lighter": "weight", "heavier": "weight",
        "bigger": "size", "smaller": "size", "larger": "size", "sturdy": "fragility", "robust": "fragility",
    }  # fmt: skip
    return extremes.get(token)


def _pick(rest: list[str]) -> list[Goal] | str:
    if rest and rest[-1] == "up":
        rest = rest[:-1]
    if rest and rest[0] == "up":
        rest = rest[1:]
    thing, placement = read_place(_without_grip(rest))
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


def _place(rest: list[str], default: Placement | None) -> list[Goal] | str:
    rest = [t for t in rest if t not in ("away", "down", "aside", "off", "out")] if default is not None else rest
    thing, placement = read_place(rest)
    placement = placement or default
    if placement is None:
        return "Where shall I put it? In the bin, on the left, next to something?"
    if not thing:
        thing = ["it"]
    return _each(thing, "place", placement)


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
    for part in _enumeration(tokens):
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


def _readable(unknown: list[str], found: dict[str, object], strict: bool) -> bool:
    """An unknown adjective before a known noun may pass; more than one, or where no verb was said, may not."""
    if not unknown:
        return True
    return not strict and len(unknown) == 1 and bool(found.get("noun"))


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
