"""Recognises questions and conversational commands: see, where, near, why, what if, help, stop, undo."""

from __future__ import annotations

import re

from agent.goal import Goal, Placement, Query, Reference, RelationTo
from agent.language.question_forms import NEAR_WORDS, PATTERNS
from agent.language.read_reference import is_reference, read_reference
from agent.language.stop import says_stop
from agent.language.words import words

WHERE = re.compile(
    r"^(?:(?:can|could|would|do|will) you (?:please )?)?(?:and |so |but |hey )*(?:tell me |show me |know |i wonder |any idea |do you know |i want to know |i need to know |find out )*(?:where(?: exactly| precisely| the hell| on earth| on the table| now)? (?:is|are|was|has|did (?:i|we|you) (?:leave|put|place|lose|drop|set|lay|see|find)|did(?= (?:the|my|that|it|this|your|a)\b)|do you have|do you see|can i see|have you seen|did you (?:see|put|leave))|find|locate|"
    r"(?:in|on|at) which (?:place|corner|spot|part|area|position|side|end)(?: of the table)? (?:is|are|do you see)|do you (?:happen to )?see|can you see|do you have|do we have|is there|are there|can you (?:find|spot|locate|detect|recogni[sz]e)|(?:do you (?:happen to )?know|any idea|do you have any idea|i wonder|tell me|show me|find out) where|i (?:can not|could not) (?:find|see)|i (?:have )?lost|"
    r"what is the (?:exact |current )?(?:position|location|place|whereabouts) of|on (?:which|what) side is|at (?:which|what) (?:place|position) is|where on the table is|where about is|where about are|have you (?:seen|got|found)|where can i find|point (?:at|to)|"
    r"show me|look for|search for|which (?:one )?is|what is the position of|what is the location of|spot)\s+(.+?)"
    r"(?: (?:now|right now|standing|located|lying|placed|at the moment|please|on the table|is|are|anywhere|somewhere|here|there|gone|be|exactly|got to|to be found|hiding|hidden|went|go|sitting|around))*$"
)
NEAR = re.compile(
    rf"^(?:and |so )*(?:tell me |say |show me )*(?:what|anything|something|what (?:else|all|other things?)|what (?:can|do) (?:you|i|we) (?:see|find|have)|which (?:things|objects|object|one|ones)|is (?:there )?(?:anything|something)|who|tell me what|list (?:what|everything)"
    rf"|are there (?:things|objects))"
    rf"(?: else)?(?: (?:is|are|stands|lies|sits|do you see|can you see|can be seen|can be found|do you have|have you got|objects are|things are))? ?(?:there |standing |lying |located )?"
    rf"(?P<how>{NEAR_WORDS}) (?P<what>.+)$"
)
NEIGHBOURS = re.compile(r"^(?:what are |list |name |tell me )?(?:the )?(?:neighbou?rs?|surroundings) of (?P<what>.+)$")
PROPERTIES = re.compile(
    r"^(?:how (?:big|large|tall|wide|high|long|heavy|fragile|small|thick|light|full|delicate|breakable) (?:is|are)|"
    r"what (?:colou?r|size|shape|material|weight|kind|category|type) (?:is|are|has|of (?:object|thing) is)|"
    r"what is the (?:colou?r|size|shape|material|weight|mass|height|width|fragility|state) of|what does|what (?:colou?r|size|shape|material|weight|height) do(?:es)?|how much (?:does|do|is)|(?:can|could|would|do) you (?:please )?(?:tell me|know|describe|say) (?:what|how) [a-z]+ (?:is|are)|(?:tell|give) me (?:the|its) (?:colou?r|size|shape|material|weight|mass|height|width|fragility|state) of|what can you say about|give me (?:details|information|some details|some information|more information) (?:on|about|of)|"
    r"(?:can|could|would) you (?:please )?(?:describe|tell me about|tell me more about)|tell me (?:something|more|everything|all) about|what else do you know about|which (?:colou?r|material|size|shape|kind|type) (?:is|has|does)|what sort of (?:thing|object) is|what kind of (?:thing|object) is|of what (?:material )?is|"
    r"is|are|describe|tell me about|what do you know about|what can you tell me about|what is|what are)\s+(?P<what>.+?)"
    r"(?: (?:or|either|already|still|made (?:of|from|out of)|weigh|have|look like|like|fragile|heavy|light|big|small|empty|full|filled|breakable|red|blue|"
    r"green|yellow|white|black|tall|delicate|made|stacked|there|unknown))*$"
)
WHICH_NEAR = re.compile(
    r"^which (?:of the )?(?P<noun>[a-z]+(?: [a-z]+)?) (?:is|are|stands?|lies?|sits?) (?:the )?(?P<how>(?:standing |lying )?(?:closest to|nearest to|nearest|next to|beside|near|behind|in front of|left of|right of|to the left of|to the right of|on|in|under|between) .+)$"
)
WHICH = re.compile(
    r"^(?:which|what) (?P<noun>.+?) (?:is|are|looks|weighs|has|stands|lies) (?:the )?(?P<adjective>[a-z ]+)$"
)
COMPARED: dict[str | None, str] = {
    "big": "biggest", "small": "smallest", "tall": "tallest", "short": "shortest", "heavy": "heaviest", "light": "lightest",
    "fragile": "most_fragile",
}  # fmt: skip
COUNT_UP = re.compile(r"^count (?:all )?(?P<what>.+?)(?: on the table| please| for me)*$")
COUNT = re.compile(
    r"^(?:(?:and |so |can you |could you |please )*(?:tell me |count |say )*how many|(?:tell me |what is |give me )*(?:the )?(?:total )?(?:number|amount|count|quantity) of|(?:can|could|would) you (?:please )?count) (?:different |all |all the |the )*(?P<what>.+?)(?: (?:are|do|can|is|have)\b.*| on the table.*| there.*| you see.*)?$"
)
UNDO = re.compile(
    r"^(?:please )?(?:undo(?: (?:that|it|this|the last (?:action|step|move|grasp|one)|please))*|revert(?: (?:that|it|this))?|"
    r"take (?:that|it) back|go back|(?:put|place|set|bring|give|return|take|lay) (?P<what>.+?) back"
    r"(?: (?:where (?:it|you|they|he|she) .*|again|please|down|on(?:to)? the table|in(?:to)? (?:its|the) (?:old )?(?:place|position)|"
    r"to (?:its|where) .*|there|now))*|return (?P<it>it|that|the .+?)(?: to .*)?|put back (?P<that>.+?)(?: where .*)?|"
    r"reverse (?:that|it|this|the last .*|your last .*|what you .*)|(?:please )?undo(?: (?:that|it|this|please|the|your|my|last|previous|latest|one|what you .*|move|step|grasp|action|change|command|placement|everything|all|again|now))+|roll (?:that|it|this) back|(?:put|set|bring) (?:it|that|this|them) (?:back )?(?:to )?(?:where|as) (?:it|they) (?:was|were|came from|stood|belongs?|had been)(?: before)?|restore .*)$"
)
FORCE = re.compile(r"(\d+(?:\.\d+)?)\s*(?:n\b|newtons?\b)")


ASKS_OF = re.compile(r"\b(?:made|weigh|colou?r|look like|how|material|size|shape|kind)\b")
HOW_IT_IS = re.compile(
    r"^(?:(?:tell|show) me|say|do you know|i want to know|i wonder) (?:what|how|which) (?:[a-z]+ ){1,2}?(?P<what>(?:the|it|that|this|my)\b.*?) (?:is|are|has|weighs?)(?: made of)?$"
)
_ABOUT: tuple[tuple[re.Pattern[str], Query], ...] = (
    (COUNT_UP, "count"), (HOW_IT_IS, "properties"), (NEAR, "near"), (NEIGHBOURS, "near"), (COUNT, "count"), (WHERE, "where"), (PROPERTIES, "properties"),
)  # fmt: skip
"""Questions about a thing, tried in this order."""


def read_question(text: str) -> Goal | str | None:
    """The goal that a question or conversational command asks for; a text if it is one but cannot be answered; or None.

    Args:
        text: cleaned and mended tokens joined by spaces, without separators at the ends.
    """
    if says_stop(text):
        return Goal(kind="answer", query="stop")
    found = NEAR.match(text)
    goal = _about(found, "near") if found else None
    if goal is not None:
        return goal
    for pattern in PATTERNS:
        if pattern.regex.match(text):
            return _goal_of(pattern.query, text)
    found = UNDO.match(text)
    if found:
        return _undo(found)
    found = WHICH_NEAR.match(text)
    if found:
        reading = read_reference(["the", *found["noun"].split(), *found["how"].split()])
        if (
            is_reference(reading)
            and reading.found.get("relation")
            and not reading.unknown
            and not reading.contradiction
        ):
            return Goal(kind="look", query="where", reference=Reference(**reading.found))
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


def _goal_of(query: Query, text: str) -> Goal | str:
    if query != "what_if":
        return Goal(kind="look" if query == "see" else "answer", query=query)
    force = FORCE.search(text)
    if force is None:
        return (
            "I can simulate the last grasp with another number or in another way. Ask, for example: what would have "
            "happened with 6 N, with a pinch grasp, from the side, by the rim?"
        )
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
    how = groups.get("how")
    if query == "near" and how == "between":
        reading = read_reference(["thing", "between", *what.split()])
        between = reading.found.get("relation")
        return (
            None
            if between is None or reading.unknown
            else Goal(
                kind="look", query="near", reference=Reference(words=what, noun="thing", relation=between, plural=True)
            )
        )
    what = re.sub(r" made (?:of|from) .*$", "", what) if query == "properties" else what
    reading = read_reference(what.split())
    if reading.unknown or reading.contradiction or not is_reference(reading):
        return None
    reference = Reference(**reading.found)
    if query == "near" and how:
        side = read_reference(["thing", *how.split(), *what.split()]).found.get("relation")
        if isinstance(side, RelationTo):
            thing = Reference(words=what, noun="thing", relation=side, plural=True)
            return Goal(kind="look", query="near", reference=thing)
    if query == "properties" and reference.extreme is not None and not ASKS_OF.search(found[0]):
        return Goal(kind="look", query="where", reference=reference)  # "what is the heaviest thing?" asks which one
    if query == "near":
        thing = Reference(
            words=what, noun="thing", relation=RelationTo(relation="near", others=(reference,)), plural=True
        )
        return Goal(kind="look", query="near", reference=thing)
    return Goal(kind="look", query=query, reference=reference)
