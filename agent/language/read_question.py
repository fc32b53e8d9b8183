"""Recognises questions and conversational commands: see, where, near, why, what if, help, stop, undo."""

from __future__ import annotations

import re
from dataclasses import dataclass

from agent.goal import Goal, Placement, Query, Reference, RelationTo
from agent.language.read_reference import is_reference, read_reference
from agent.language.words import words

NEAR_WORDS = (
    r"(?:right )?next to|near(?:by)?|close to|beside|around|by|in front of|behind|under(?:neath)?|beneath|"
    r"(?:to |on )?the left (?:side )?of|(?:to |on )?the right (?:side )?of|left of|right of|on top of|on|between|inside|in"
)


@dataclass(frozen=True)
class Pattern:
    """A regular expression over the cleaned text, and the query it asks."""

    query: Query
    regex: re.Pattern[str]


def _pattern(query: Query, *alternatives: str) -> Pattern:
    return Pattern(query, re.compile(r"^(?:" + "|".join(alternatives) + r")$"))


_GRASPED = (
    r"(?:grasp|grip|grab|pick|take|hold|choose|lift|place|put|do|approach|go|squeeze|use|select|get|decide|plan|come)"
)

PATTERNS: tuple[Pattern, ...] = (
    _pattern(
        "help", r"help(?: me| please)?", r"what (?:all )?can (?:you|i) (?:do|say|ask)(?: for me| here)?",
        r"what are (?:you able to do|you capable of|your (?:abilities|skills|commands|options))", r"how does this work",
        r"how (?:do|can) i (?:use|talk to|command|control) (?:you|this|it|the robot)", r"(?:show |list )?(?:the )?commands",
        r"(?:which|what) (?:commands|instructions|sentences|words) (?:do you (?:know|understand|have)|can i (?:use|say|give)|are there)",
        r"who are you", r"what are you", r"instructions", r"usage", r"manual", r"what do you understand",
    ),
    _pattern(
        "stop", r"(?:please )?(?:emergency )?stop(?: now| it| that| moving| everything| immediately| right now| the robot)*",
        r"halt(?: now)?", r"freeze", r"abort(?: that| it| the (?:task|motion|mission))?", r"wait(?: a (?:moment|second|minute))?",
        r"cancel(?: that| it| everything| the (?:task|motion))?", r"do not move(?: anything)?(?: now| anymore)?", r"hold on",
        r"stand still", r"stay(?: there| still| put)?", r"hold still", r"pause", r"quit moving", r"no stop", r"enough",
        r"never mind", r"nevermind", r"forget (?:it|that)", r"do nothing", r"leave everything(?: as it is)?", r"whoa",
        r"stop what you are doing", r"no do not(?: do (?:it|that))?", r"do not do (?:it|that|anything)",
    ),
    _pattern(
        "what_if",
        r"(?:and )?what (?:would|will|could|might) (?:have )?(?:happen(?:ed)?|be(?:en)?) (?:if|with|at|for|using)\b.*",
        r"(?:and )?(?:what|how) about (?:with |using )?\d+(?:\.\d+)? n(?:ewtons?)?(?: instead)?",
        r"(?:and )?what if\b.*", r"(?:and )?what happens (?:if|with|at|for)\b.*\d.*", r"(?:and )?(?:with|using|at) \d+(?:\.\d+)? n(?:ewtons?)?(?: instead| then)?",
        r"(?:would|will|could) (?:it|that|this|\d).*\b(?:work|hold|succeed|slip|fail|drop|break|enough).*\bn(?:ewtons?)?\b.*",
        r"would \d+(?:\.\d+)? n(?:ewtons?)? .*", r"simulate .*\d+(?:\.\d+)? n(?:ewtons?)?.*",
        r"suppose (?:you|it|that|we)\b.*", r"imagine (?:you|it|that|we)\b.*",
    ),
    _pattern(
        "why_failed",
        r"(?:so )?why (?:did|has) (?:it|that|this|you|the .*?|they) (?:just )?(?:fail|drop|slip|miss|lose|fall|crash|break|stop|"
        r"not|abort|give up|let go|failed|dropped|slipped)\b.*",
        r"why (?:did|could|can|were|was|would) (?:it|you|that|the .*?|they) not\b.*", r"what (?:went|has gone|is) wrong(?: there)?",
        r"why (?:did|could|would|can|were|do|does|is|was|will) not (?:you|it|that|they|the [a-z]+)\b.*", r"why not(?: .*)?", r"what was the (?:problem|failure|reason(?: for (?:the|that|this) failure)?|matter|issue)",
        r"what happened(?: there| just now)?", r"how did (?:it|that|you) fail", r"explain (?:the|that|this|your) failure",
        r"why (?:is|was) (?:it|that) (?:a failure|not successful|unsuccessful|not working)", r"what failed",
        r"why the failure", r"why no success", r"why have you (?:failed|dropped|stopped).*",
    ),
    _pattern(
        "why",
        rf"(?:so |and )?why (?:did|have|do|would) you (?:just )?{_GRASPED}\b.*", r"why (?:that|this) (?:way|grasp|grip|object|one|side|force|angle|approach)",
        r"why (?:the |so |with |from |at |by |like |in |on |such )?(?:handle|rim|body|stem|neck|edge|top|side|that|much|little|"
        r"gently|slow|slowly|hard|above|force|angle|approach|tight|firmly|this)\b.*",
        r"explain (?:your|the|that|this|why|how)\b.*", r"why \d+(?:\.\d+)? (?:n|newtons?)\b.*", r"why", r"how come", r"justify\b.*", r"what made you\b.*",
        r"how did you (?:decide|choose|know|plan|pick|select|grasp|grip|find|come)\b.*", r"on what basis\b.*",
        r"(?:what|where) (?:did|does|do) (?:you|the|that|this) .*(?:force|number|value|grasp) come from.*",
        r"what (?:is|was) your (?:reasoning|plan|strategy|thinking)", r"tell me why\b.*", r"where does (?:the|that) .* come from",
    ),
    _pattern(
        "held", r"what (?:are|were) you (?:holding|carrying|gripping)(?: now| right now)?",
        r"what (?:is|do you have) in (?:your|the) (?:hand|gripper|fingers)(?: now)?", r"what do you (?:hold|have)(?: now)?",
        r"(?:are you|is (?:the|your) (?:hand|gripper)) (?:holding (?:something|anything)|empty|free|still holding .*)",
        r"do you (?:still )?(?:have|hold) (?:it|something|anything)",
    ),
    _pattern(
        "see",
        r"what (?:do|can|did) you (?:see|perceive|recogni[sz]e|detect|observe|find|notice)(?: there| here| now|(?: on| in) .*)?",
        r"what (?:is|are|do you have|do we have|have we got|have you got|stands|lies) (?:there|here|around|visible|in front of you"
        r"|(?:the |all )?(?:things|objects|items)(?: there| here)?|on (?:the|your) (?:table|desk)(?: now)?|in (?:the|this) scene|"
        r"in view)(?: on (?:the|your) (?:table|desk))?(?: now)?",
        r"(?:please )?(?:look|look around|have a look|take a look)(?: around| there| please|(?: at| on) (?:the|your) (?:table|desk|scene))?",
        r"(?:describe|list|show|name|enumerate|tell me about|give me a list of|report|inspect|scan|observe)(?: me)?(?: all| what)?"
        r"(?: of)?(?: the| your)? ?(?:scene|table|objects?|things|items|everything|surroundings|workspace|you see|is there|"
        r"is on the table|there is|view)?(?: you (?:can )?see)?(?: on the table| you see| there| here| that you see)?",
        r"(?:which|what) (?:objects|things|items)(?: (?:are|do you see|can you see|is|lie|stand|have you).*)?",
        r"tell me what (?:you (?:can )?see|is (?:there|on the table))(?: on the table)?", r"what have you (?:got|found|seen)",
        r"is (?:there )?(?:anything|something)(?: there| on the table)?", r"show me what you (?:can )?see",
        r"what all is there", r"what objects", r"what is on (?:it|there)",
    ),
)  # fmt: skip

STOP = next(pattern.regex for pattern in PATTERNS if pattern.query == "stop")
WHERE = re.compile(
    r"^(?:(?:can|could|would) you (?:please )?)?(?:tell me |show me )?(?:where (?:is|are|was|did you (?:see|put|leave))|find|locate|"
    r"do you see|can you see|do you have|is there|are there|have you (?:seen|got|found)|where can i find|point (?:at|to)|"
    r"show me|look for|search for|which (?:one )?is|what is the position of|what is the location of|spot)\s+(.+?)"
    r"(?: (?:now|right now|standing|located|lying|placed|at the moment|please|on the table|is|are|anywhere|here|there))*$"
)
NEAR = re.compile(
    rf"^(?:what|which (?:things|objects|object|one|ones)|is (?:there )?(?:anything|something)|who|tell me what|list (?:what|everything)"
    rf"|are there (?:things|objects))"
    rf"(?: else)?(?: (?:is|are|stands|lies|sits|do you see|can you see|objects are|things are))? ?(?:there |standing |lying |located )?"
    rf"(?P<how>{NEAR_WORDS}) (?P<what>.+)$"
)
NEIGHBOURS = re.compile(r"^(?:what are |list |name |tell me )?(?:the )?(?:neighbou?rs?|surroundings) of (?P<what>.+)$")
PROPERTIES = re.compile(
    r"^(?:how (?:big|large|tall|wide|high|long|heavy|fragile|small|thick|light|full|delicate|breakable) (?:is|are)|"
    r"what (?:colou?r|size|shape|material|weight|kind|category|type) (?:is|are|has|of (?:object|thing) is)|"
    r"what is the (?:colou?r|size|shape|material|weight|mass|height|width|fragility|state) of|what does|how much (?:does|do)|"
    r"is|are|describe|tell me about|what do you know about|what can you tell me about|what is|what are)\s+(?P<what>.+?)"
    r"(?: (?:made (?:of|from|out of)|weigh|look like|like|fragile|heavy|light|big|small|empty|full|filled|breakable|red|blue|"
    r"green|yellow|white|black|tall|delicate|made|stacked|there|unknown))*$"
)
WHICH = re.compile(
    r"^(?:which|what) (?P<noun>.+?) (?:is|are|looks|weighs|has|stands|lies) (?:the )?(?P<adjective>[a-z ]+)$"
)
COMPARED: dict[str | None, str] = {
    "big": "biggest", "small": "smallest", "tall": "tallest", "short": "shortest", "heavy": "heaviest", "light": "lightest",
    "fragile": "most_fragile",
}  # fmt: skip
COUNT_UP = re.compile(r"^count (?:all )?(?P<what>.+?)(?: on the table| please| for me)*$")
COUNT = re.compile(r"^how many (?P<what>.+?)(?: (?:are|do|can|is|have)\b.*| on the table.*| there.*| you see.*)?$")
UNDO = re.compile(
    r"^(?:please )?(?:undo(?: (?:that|it|this|the last (?:action|step|move|grasp|one)|please))*|revert(?: (?:that|it|this))?|"
    r"take (?:that|it) back|go back|(?:put|place|set|bring|give|return|take|lay) (?P<what>.+?) back"
    r"(?: (?:where (?:it|you|they|he|she) .*|again|please|down|on(?:to)? the table|in(?:to)? (?:its|the) (?:old )?(?:place|position)|"
    r"to (?:its|where) .*|there|now))*|return (?P<it>it|that|the .+?)(?: to .*)?|put back (?P<that>.+?)(?: where .*)?|"
    r"reverse (?:that|it|the last .*))$"
)
FORCE = re.compile(r"(\d+(?:\.\d+)?)\s*(?:n\b|newtons?\b)")


_ABOUT: tuple[tuple[re.Pattern[str], Query], ...] = (
    (COUNT_UP, "count"), (NEAR, "near"), (NEIGHBOURS, "near"), (COUNT, "count"), (WHERE, "where"), (PROPERTIES, "properties"),
)  # fmt: skip
"""Questions about a thing, tried in this order."""


def read_question(text: str) -> Goal | str | None:
    """The goal that a question or conversational command asks for; a text if it is one but cannot be answered; or None.

    Args:
        text: cleaned and mended tokens joined by spaces, without separators at the ends.
    """
    for pattern in PATTERNS:
        if pattern.regex.match(text):
            return _goal_of(pattern.query, text)
    if says_stop(text):
        return Goal(kind="answer", query="stop")
    found = UNDO.match(text)
    if found:
        return _undo(found)
    found = WHICH.match(text)
    if found:
        reading = read_reference(["the", *found["adjective"].split(), *found["noun"].split()])
        quality = reading.found.pop("quality", None)
        if quality in COMPARED:
            reading.found["extreme"] = COMPARED[quality]
        if is_reference(reading) and not reading.unknown and not reading.contradiction and reading.found.get("extreme"):
            return Goal(kind="look", query="where", reference=Reference(**reading.found))
    for regex, query in _ABOUT:
        found = regex.match(text)
        if found:
            goal = _about(found, query)
            if goal is not None:
                return goal
    return None


def says_stop(text: str) -> bool:
    """Whether every piece of "wait, stop" or "no, stop, please" says stop, or says nothing else."""
    pieces = [piece.strip() for piece in re.split(r"[,.;]", text) if piece.strip()]
    halts = [bool(STOP.match(piece)) for piece in pieces]
    return any(halts) and all(
        h or p in ("no", "please", "hey", "oh", "oh no") for h, p in zip(halts, pieces, strict=True)
    )


def _goal_of(query: Query, text: str) -> Goal | str:
    if query != "what_if":
        return Goal(kind="look" if query == "see" else "answer", query=query)
    force = FORCE.search(text)
    if force is None:
        return "I can only simulate another force so far. Ask, for example: what would have happened with 6 N?"
    if not 1.0 <= float(force[1]) <= 70.0:
        return f"The hand can close with 1 to 70 N, not with {float(force[1]):g} N."
    return Goal(kind="answer", query="what_if", force=float(force[1]))


def _undo(found: re.Match[str]) -> Goal | None:
    named = next((found[group] for group in ("what", "it", "that") if found[group]), "it")
    reading = read_reference(words(named))
    if reading.unknown or not is_reference(reading):
        return None
    return Goal(kind="place", reference=Reference(**reading.found), placement=Placement(kind="back"))


def _about(found: re.Match[str], query: Query) -> Goal | None:
    groups = found.groupdict()
    what = groups.get("what") or found[1]
    if what.startswith(("your ", "you ")):
        return None
    reading = read_reference(what.split())
    if reading.unknown or reading.contradiction or not is_reference(reading):
        return None
    reference = Reference(**reading.found)
    how = groups.get("how")
    if query == "near" and how:
        side = read_reference(["thing", *how.split(), *what.split()]).found.get("relation")
        if isinstance(side, RelationTo):
            thing = Reference(words=what, noun="thing", relation=side, plural=True)
            return Goal(kind="look", query="near", reference=thing)
    if query == "properties" and reference.extreme is not None:
        return Goal(kind="look", query="where", reference=reference)  # "what is the heaviest thing?" asks which one
    if query == "near":
        thing = Reference(
            words=what, noun="thing", relation=RelationTo(relation="near", others=(reference,)), plural=True
        )
        return Goal(kind="look", query="near", reference=thing)
    return Goal(kind="look", query=query, reference=reference)
