"""Rewrites roundabout wordings into the plain command: "the cup goes in the bin" is "put the cup in the bin".

Every rule keeps the words for the things and places; none adds a thing that was not said.
"""

from __future__ import annotations

import re

from agent.language import lexicon
from agent.language.clauses import VERBS, find_verb, strip_opener, trim
from agent.language.read_reference import is_reference, read_reference

_NP = r"(?:the|that|this|these|those|my|your|our|both|all|every|each|everything|it|they)\b[^,.;]*?"
_LIQUID = r"(?:hot |cold |some )?(?:water|coffee|tea|juice|wine|milk|liquid|beer|soup|stuff|something)"
_DIRECTION = (
    r"(?:beside|behind|next to|in front of|under|underneath|above|on top of|between|in between|near|left of|to the left of|"
    r"to the right of|alongside|adjacent to|by the)"
)

_VERB = "|".join(verb for verb, _ in VERBS)

_RULES: tuple[tuple[re.Pattern[str], str], ...] = tuple(
    (re.compile(pattern), becomes)
    for pattern, becomes in (
        # numbered steps
        (r"^(?:step )?(?:1|one|1st) [.,;] (?=.* (?:step )?(?:2|two|2nd) [.,;] )", ""),
        (r"(?:^| )(?:[.,;] )?step (?:\d|one|two|three|four|five)(?: [.,;])? ", " . "),
        (r" (?:[.,;] )?[2-9] [.,;] (?=[a-z])", " . "),
        (r"(?<![\d.]) n (?=[a-z])", " and "),
        # what is in a thing
        (rf" (?:that is |which is |that are )?(?:full of|filled with|containing|that contains|that has) {_LIQUID}(?: in it| inside)?(?= |$)", " filled"),
        (rf" with {_LIQUID} (?:in it|inside)(?= |$)", " filled"),
        (r" (?:with nothing (?:in it|inside)|without anything (?:in it|inside)|that has nothing in it|that is empty|which is empty)(?= |$)", " empty"),
        (r" (?:that is|which is) (?:full|filled)(?= |$)", " filled"),
        # where a thing stands
        (rf"(?<!the )\b(?:right|just|directly|immediately|exactly|straight|precisely) (?={_DIRECTION}\b)", ""),
        (r"\b(?:the )?(?:furthest|farthest|most) (?:to (?:the |your |my )?|on the )?(left|right)\b", r"\1most"),
        (r"\bon the (?:very|far|extreme|outer) (left|right)\b(?! of)", r"on the \1"),
        (r"\bin the middle of (?=(?:the|a) (?:[a-z]+ ){1,3}and (?:the|a) )", "between "),
        (r"\b(?:on|to) the (left|right) hand side\b", r"on the \1 side"),
        (r"\bto (?:my|your) (left|right)\b", r"to the \1"),
        (r"\bon (?:my|your) (left|right)\b", r"on the \1"),
        (r"\bthe (left|right) hand (?!side|and|with)(?=[a-z])", r"the \1 "),
        (r"\bnext door to\b", "next to"),
        (r"^(?:(?:would |do )?you )?mind (?=[a-z]+ing\b)", ""),
        (r"\bmade (?:out of|from|entirely of|of pure) ", "made of "),
        (r" (?:[,.;] )?(?:and |then )?wait(?: (?:for [a-z]+|a (?:moment|second|minute|bit|while)|until [^,.;]+|(?:\d+|two|three|five|ten) seconds?))?(?= [,.;]| and | then )", ""),
        (r"^take (?P<t>(?:the|that|this|my|these|those|it|them|both|all|a)\b[^,.;]*) away$", r"take away \g<t>"),
        (r"^(?P<a>[^.;]+?) (?:[,.;] )?(?:but |and )?(?:before that|before doing so|before you do(?: that| so| it)?|but before)(?: [,.;])? (?P<b>(?!the\b|it\b)[^,.;]+)$", r"\g<b> then \g<a>"),
        (r"\b(?:farthest|furthest|most distant|far) (?:away )?from (?:me|us|here)\b", "farthest"),
        (r"\b(?:on|to|at|onto) the (?:far|opposite|other) (?:side|end|edge) of the (?:table|desk)\b", "at the back"),
        (r"\b(?:on|to|at|onto) the (?:near|nearer|close) (?:side|end|edge) of the (?:table|desk)\b", "to the front"),
        (r"^use (?:the |a |an )?(?:[a-z]+ ){0,2}(?:grasp|grip|hold) (?:for|on|with) (?=the|a|an|that|this|my)", "pick up "),
        (r" with (?:water|coffee|tea|juice|wine|milk|beer|soup)$", " filled"),
        # what is to stay
        (r"(?:^|(?: [,.;])?(?: and| but| while)? )(?P<stays>(?:the|my|that) (?:[a-z]+ ){0,2}?[a-z]+) (?:stays?|remains?|(?:should|must|can|has to|is to|may|shall|needs to) (?:stay|remain)|"
         r"(?:should|must|may|shall|is|can) not (?:to )?be (?:touched|moved|taken|cleared))(?: (?:put|there|here|where it is|where they are|on the (?:table|desk)|untouched|alone|in place|standing))*(?=$| [,.;]| and )",
         r" . leave \g<stays> alone"),
        (r"(?: [,.;])? without (?:touching|moving|taking|disturbing|including|removing|clearing|shifting) (?P<spared>(?:the|my|that|those) (?!thing\b|table\b|other)[a-z ]+?)(?=$| [,.;]| and then | then )",
         r" . leave \g<spared> alone"),
        (rf"^do not (?:{_VERB}) (?P<t>(?:the|that|my) [a-z ]+?)(?: away| out| up| down| in the bin| into the bin)? [,.;] (?:but |just |instead |rather |please )*(?P<v>give|hand|put|place|pass|bring|move|set)\b(?P<r>[a-z ]*?) (?:it|that)\b",
         r"\g<v>\g<r> \g<t>"),
        (rf"^do not (?P<v>(?:{_VERB}))(?: me)? (?:the|that|my|a) [a-z ]+? but (?:rather |instead |take )*(?P<t>(?:the|that|my|a) [a-z ]+)$", r"\g<v> \g<t>"),
        (rf"^(?:instead of|rather than) [a-z ]+?(?: ,)? (?=(?:{_VERB}) (?:the|a|an|my|that)\b)", ""),
        (r"^not (?:the|that|this|my) [a-z ]+? but (?:rather )?(?P<t>(?:the|that|this|my) )", r"\g<t>"),
        # clearing
        (r"^i (?:want|need|would like)(?: to have)? (?P<t>(?:everything|all|the|that|this|these|those|my)\b[^,.;]*?)(?: to be)? (?:gone|removed|cleared(?: away)?|thrown away|thrown out|out of here|off the table|away|out of my sight)(?P<r> (?:except|but|apart from|other than) .*)?$",
         r"get rid of \g<t>\g<r>"),
        (r"^(?:i (?:want|need|would like)|make|get|leave|have)(?: to see)? (?:the|this|my) (?:table|desk|workspace)(?: to be)? (?:completely |totally |all )?"
         r"(?:empty|clear|cleared|clean|tidy|free)\b", "clear the table"),
        (r"\b(?:all|everything|anything)(?: that| which| of what| of that)? (?:is|lies|stands|you (?:can )?see|there is)(?: lying| standing| left)?(?: on (?:the|this|my) (?:table|desk)| there| here)?(?= |$)",
         "everything"),
        (r"\bthe (?:whole )?lot\b(?! of)", "everything"), (r"\b(?:whole|entire) table\b", "table"),
        (r"\beach and every\b", "every"), (r"\bevery single\b", "every"), (r"\bevery last\b", "every"), (r"\ball (?:of )?the rest\b", "the rest"),
        (r"\b(?:the )?(?:remaining|other) (?:things|objects|items|stuff|ones)\b", "the rest"),
        (r"\bthe remainder\b|\bwhat(?:ever)? (?:is left|remains)\b|\b(?:all )?the others\b|\beverything that is left\b", "the rest"),
        (r"^(?P<v>(?:please )?(?:throw|toss|chuck|put|clear|take|move|get rid of|bin|discard|dump|remove|dispose of)(?: out| away)?) (?:whatever|all that|anything that) is (?P<a>[a-z]+)(?= |$)(?! of)",
         r"\g<v> everything that is \g<a>"),
        # where things belong
        (rf"^(?P<thing>{_NP}) (?:all |both )?(?:goes|go|belongs?|should (?:go|be|stand|land|end up)|must (?:go|be put)|has to go|have to go|needs? to (?:go|be)|ought to go|"
         r"is supposed to (?:go|be)|can go|may go|is to go|shall go|wants to go)(?: straight| all| both)?(?: put| placed| moved| thrown)? "
         r"(?=(?:in|into|to|on|onto|next|beside|behind|left|right|between|under|inside|at|over|away)\b)", r"put \g<thing> "),
        (rf"^i (?:want|need|would like|would love|would prefer|prefer|wish)(?: to (?:have|see))? (?P<thing>{_NP}) (?:put |placed |moved |to be |to go |thrown |standing )?"
         r"(?P<where>(?:in(?:to)? the (?:bin|trash|rubbish|garbage)|on the (?:left|right)|next to|beside|behind|in front of|to the (?:left|right)|on top of|in(?:to)? the (?:bowl|box|cup|mug|middle|centre|center|back|front))\b.*)$",
         r"put \g<thing> \g<where>"),
        (r"^what i (?:want|need|would like)(?: you to (?:get|fetch|give me|hand me))?(?: now)? is (?=the|a|an|my|that)", "give me "),
        (r"^(?:the|your|my) (?:next |first )?(?:job|task|mission|goal|order|assignment)(?: now| today)?(?: is)?(?: to)?(?: [.,;])? ", ""),
        (r"^(?:do )?(?:something|anything) with (?=the|that|this|my)", ""),
        (r"^(?:deal with|handle|take care of|see to|work on|work with|play with|do) (?=(?:the|that|this|my) )", ""),
        (r"\b(?:toss|throw|chuck|slide|send|shoot|slip|roll|lend|show me and give) me (?=the|a|an|that|this|my|some|it|one)", "give me "),
        (r"\btowards? (?:me|us)\b|\b(?:a bit |a little )?(?:closer|nearer) to (?:me|us)$", "to the front"),
        (r"\b(?:towards?|closer to|nearer to) (?:you|yourself|the robot)$", "to the back"),
        (r"\bfor (?:a|one) (?:second|moment|minute|while|bit|sec)\b", ""),
        (r"\b(?:at most|exactly|only|just|precisely|no more than) (?=(?:one|two|three|four|five|six|both|[2-9]) )", ""),
    )
)  # fmt: skip
_YOURS = (
    (re.compile(r"\b(?:nearest|closest) (?:to )?(?:you|yourself|the robot|the arm)\b"), "farthest"),
    (
        re.compile(r"\b(?:farthest|furthest|most distant) (?:away )?from (?:you|yourself|the robot|the arm)\b"),
        "nearest",
    ),
    (re.compile(r"\b(?:move|shift|carry) (?P<what>[^,.;]+?) (?:over |right )?there$"), r"put \g<what>"),
)
_STATED = re.compile(
    r"^(?:(?:there is|there are|i (?:can )?see|see|(?:do |can )?you see|look at|look ,? ?(?:there is|at)?|have a look at|i am done with|i have finished with|i am finished with|"
    r"i (?:do not|no longer) (?:need|want|like|use)|i (?:like|love|hate|want|need|prefer)|you know|remember|about|as for|regarding|concerning|now|so) )?"
    r"(?P<thing>(?:the|a|an|that|this|my|these|those) [^,.;]+?)"
    r"(?: (?:is|are|looks?|seems?|has|was|got|does not|do not|should not|can not)\b(?! (?:in|on|behind|next|near|under|left|right|between|to)\b)[^,.;]*| any ?more| any longer| over there| there| here)*"
    r" (?:[,.;]|[,.;]? (?:so|and)) (?:(?:and|so|then|please|just|now|could you|can you|would you|you can|you should|you may) )*(?P<rest>[a-z].*)$"
)
"""Something said of a thing, and then what to do with it."""
_ITS = re.compile(r"\b(?:it|that|them|this|that one|this one|those|these)\b(?! (?:is|are|way|time|handle|rim)\b)")


def as_seen_by_person(line: str) -> str:
    """The instruction with "closest to you" as the person sees it, who stands opposite, and without a place pointed at.

    Args:
        line: cleaned and mended tokens joined by spaces.
    """
    for pattern, becomes in _YOURS:
        line = pattern.sub(becomes, line)
    return line


def rephrased(line: str) -> str:
    """The instruction in plainer words.

    Args:
        line: cleaned and mended tokens joined by spaces.
    """
    for pattern, becomes in _RULES:
        line = pattern.sub(becomes, line)
    return " ".join(trim(_named(" ".join(line.split())).split()))


def _named(line: str) -> str:
    """For "the apple is rotten, bin it": "bin the apple"."""
    found = _STATED.match(line)
    if found is None or find_verb(strip_opener(line.split())) is not None:
        return line
    thing, rest = found["thing"].split(), found["rest"]
    reading = read_reference(thing)
    if reading.unknown or reading.contradiction or not is_reference(reading) or not reading.found.get("known", True):
        return line
    if not (reading.found.get("categories") or reading.found.get("noun") in lexicon.GENERIC):
        return line
    verb = find_verb(strip_opener(rest.split()))
    pronoun = _ITS.search(rest)
    if verb is None or pronoun is None:
        return line
    named = " ".join(["the" if thing[0] in ("a", "an") else thing[0], *thing[1:]])
    return f"{rest[: pronoun.start()]}{named}{rest[pronoun.end() :]}"
