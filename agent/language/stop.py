"""Recognises that the robot is to stop, in whatever words, also repeated, shouted, or among other words."""

from __future__ import annotations

import re

from agent.language.clauses import find_verb

STRONG = ("stop", "halt", "freeze", "abort", "cease", "whoa", "pause", "emergency", "wait")
"""One of these makes a stop of words that say nothing else."""
_ALONGSIDE = frozenset(
    "no nope not now please hey oh god you robot wait it that this there right here immediately at once instantly all everything "
    "moving motion movement motions movements the arm your gripper hand hold on enough just i said say tell told want need you to "
    "can could would will must should have a moment second minute sec okay ok quick quickly for sake heavens ugh argh damn do "
    "what are doing is danger dangerous careful dude man mate fast action actions task mission job work operation program "
    "whatever and ahh ah shit hell completely entirely altogether still any further anymore more "
    "activity and be very so really mean meant".split()
)
_PHRASES = re.compile(
    r"^(?:(?:please|no|hey|robot|oh no|now|oh) )*(?:wait(?: for (?:me|us|it|a .*))?(?: a (?:moment|second|minute|sec|bit))?|cancel(?: that| it| this| everything| all| the (?:task|motion|order|command|action|job))?|"
    r"do not move(?: anything| a muscle| at all| an inch)?(?: now| any ?more)?|hold (?:on|it|still|up|everything|your horses|fire)(?: please| now| there| a (?:second|moment|minute|sec))*|"
    r"stand (?:still|down)|stay(?: there| still| put| where you are| right there| here)?|quit(?: it| that| now)?|quit (?:moving|doing that|what you are doing)|"
    r"no stop|(?:that is )?enough(?: now| already)?|never ?mind(?: that| it| about (?:it|that))?|forget (?:it|that|about it)|do nothing|leave everything(?: as it is)?|whoa|"
    r"no do not(?: do (?:it|that|this))?|do not do (?:it|that|this|anything)(?: please)?|do not(?: please)?|do not (?:go on|continue|proceed)(?: any further| please)?|"
    r"call it off|knock it off|cut it out|give it a rest|drop everything and stop|cut (?:the )?(?:power|motors)|power (?:off|down)|shut (?:down|off)|"
    r"turn (?:yourself |the robot )?off|that will do|kill (?:it|the (?:power|motors|motion))|hit the brakes?|brake|keep still|be still|remain still|not another (?:move|inch|step)|"
    r"no further|no more(?: moving| movement| motion)?|stay where you are|suspend(?: (?:the )?(?:task|motion|operation))?|interrupt(?: (?:the )?(?:task|motion))?|terminate(?: (?:the )?(?:task|motion))?)"
    r"(?: (?:please|now|right now|immediately|at once|robot|there|thanks))*$"
)
_STOP_DOING = re.compile(
    r"^(?:(?:please|now|no|hey|robot|can you|could you|would you|will you|you must|i want you to|i need you to|you should|you have to|just|oh|wait) )*"
    r"(?:stop|quit|cease|halt|abort|do not continue|do not go on)(?: with)?(?: (?:the|your|this|that))? (?:[a-z]+ing\b.*|what (?:you are|you were) .*|(?:trying|going) to .*|attempt.*|task.*|grasp.*|motion.*|pick(?: up)?)$"
)

_LEADING = re.compile(
    r"^(?:(?:please|no|hey|robot|oh|god|wait|now|ok|quick|careful|[.,;]) )*(?:stop|halt|freeze|abort|cease)\b(?! (?:sign|watch|by))"
)
_RETRACTED = re.compile(
    r" [,.;]? ?(?:(?:oh|no|actually|wait|hm+|well|sorry|on second thoughts?|but|or|ah|hold on)(?: [,.;])? )*(?:never ?mind(?: (?:that|it|about it|about that))?|forget (?:it|that|about it|about that)|"
    r"scratch that|cancel (?:that|it)|(?:i )?(?:have )?changed my mind|do not bother|no do not)(?: [,.;]| please| thanks| thank you)*$"
)
"""A command that is taken back in the same breath: "take the cup... actually never mind"."""
_JOINT = re.compile(r"(?: [.,;])*(?: and| then| but| instead| rather)+ (?:please )?| [.,;] (?:please )?")
"""Where a command may begin after the stop ("stop, put it down"); a stop followed by none is a stop whatever else is said."""


def says_stop(text: str) -> bool:
    """Whether every piece of "wait, stop", "STOP STOP" or "no, stop picking it up, please" says stop, or nothing else.

    Args:
        text: cleaned and mended tokens joined by spaces.
    """
    if _LEADING.match(text) and not any(find_verb(rest.split()) for rest in _JOINT.split(text)[1:]):
        return True
    if _RETRACTED.search(text):
        return True
    pieces = [piece.strip() for piece in re.split(r"[,.;]", text) if piece.strip()]
    halts = [_halts(piece) for piece in pieces]
    return any(halts) and all(
        h or p.startswith(("do not ", "never ")) or set(p.split()) <= _ALONGSIDE
        for h, p in zip(halts, pieces, strict=True)
    )


def _halts(piece: str) -> bool:
    tokens = piece.split()
    strong = [i for i, token in enumerate(tokens) if token in STRONG]
    if strong:
        negated = any(tokens[i - 1] in ("not", "never") for i in strong if i)
        if not negated and set(tokens) <= _ALONGSIDE | set(STRONG):
            return True
    return bool(_PHRASES.match(piece) or _STOP_DOING.match(piece))
