"""Takes away what surrounds a command without changing what is asked: cautions, reasons, and talk before it."""

from __future__ import annotations

import re

from agent.language import lexicon

_HARM = (
    "touching|hitting|knocking|spilling|breaking|moving|disturbing|bumping|damaging|toppling|tipping|dropping|harming|scratching|"
    "crushing|squeezing|crashing|hurting|pushing|shaking|tilting|losing|bruising|colliding|any|a sound|anything|haste|delay"
)
_CAUTIONS = (
    rf"without (?:{_HARM})\b.*?",
    r"(?:please )?(?:mind|watch(?: out)?(?: for)?|beware of|look out for|pay attention to|respect|stay (?:away|clear) (?:from|of)|"
    r"keep (?:away|clear) (?:from|of)|be (?:very |really |extra )?(?:careful|gentle|cautious)(?: (?:with|of|not to|about|around|near))?|"
    r"take (?:good |great )?care(?: (?:of|not to|with))?|careful(?: (?:with|not to|of))?|do not (?:spill|knock|break|crush|squeeze|"
    r"hurt|damage|drop|tip|topple|bump|tilt|shake))\b.*?",
    r"(?:it|they|that|this|the [a-z]+) (?:is|are) (?:very |quite |so |really |rather )?(?:fragile|delicate|hot|full|heavy|slippery|"
    r"breakable|expensive|precious|wet|filled|in the way|dirty|important)\b.*?",
    r"(?:it|they|that|this|the [a-z]+) (?:still )?(?:has|have|contains?|holds?) (?:[a-z]+ )*(?:water|coffee|tea|juice|wine|milk|liquid|something)(?: (?:in|inside)(?: it| them)?)?",
    r"(?:so |please |while |by )*(?:hold|holding|keep|keeping|carry|carrying) (?:it|them|that) (?:[a-z]+ )?(?:level|upright|straight|steady|horizontal|vertical|tight|tightly|steadily|flat)(?: all the time| while .*?)?",
)
CAUTION = re.compile(
    r"(?:^| )(?:[,.;] |and |but |while )*(?:" + "|".join(_CAUTIONS) + r")(?= (?:[.,;]|and then|then)(?: |$)|$)"
)
REASON = re.compile(
    r" (?:, )?(?:because|since|so that|so i|so we|in order to|as i|for i|that way|in case|if you (?:can|could|would|like))\b.*$"
)
TALK = re.compile(
    r"^(?:(?:i am|(?:it is )?(?:your|my) (?:turn|move|go)|i feel|i was|we are|my|it is|there is|there are|look|listen|you know|well|good|as|since|because|nice|great|look at)"
    r"\b[^,.;]*[,.;] (?:so |and |then )*)+"
)
LYING_ON = re.compile(
    r"\b(?:what|whatever|anything|everything|something|that which|the (?:thing|object|stuff))(?: that| which)?"
    r"(?: (?:is|lies|stands|sits|rests|are|was))(?: standing| lying| sitting| resting| placed)? (on|in|behind|under|near|next to|inside)\b"
)
IN_HAND = re.compile(
    r"\b(?:everything|what|whatever|anything|the (?:thing|object|one))(?: that| which)? (?:you (?:are |now |currently )*(?:hold|holding|"
    r"carry|carrying|have|gripping|grip)|(?:is )?in (?:your|the) (?:hand|gripper))(?: in (?:your|the) (?:hand|gripper))?(?: now)?\b"
)
LINE_UP = re.compile(r"\bline (?!up\b)(.+?) up\b")


_NO_TOUCH = re.compile(r"^(?P<command>.+?) without (?:touching|grasping|gripping|moving|lifting) (?:it|them)$")


def untouchable(line: str) -> bool:
    """Whether a thing is to be taken without touching it; "the cup next to the vase without touching it" means the vase."""
    found = _NO_TOUCH.match(line)
    if not found:
        return False
    words = found["command"].split()
    return not any(
        words[i : i + n] == p.split()
        for p, _ in lexicon.RELATIONS
        for n in [len(p.split())]
        for i in range(1, len(words))
    )


def without_asides(line: str) -> str:
    """The instruction without cautions, reasons and talk; what remains is the command itself.

    Args:
        line: cleaned and mended tokens joined by spaces.
    """
    line = LINE_UP.sub(r"line up \1", line)
    line = IN_HAND.sub("it", line)
    line = LYING_ON.sub(r"the thing \1", line)
    found = TALK.match(line)
    if found and _commands(line[found.end() :]):
        line = line[found.end() :]
    shorter = CAUTION.sub("", line)
    if shorter.strip(" ,.;"):
        line = shorter
    shorter = REASON.sub("", line)
    return (shorter if shorter.strip(" ,.;") else line).strip()


def _commands(rest: str) -> bool:
    """Whether a verb of ours comes somewhere in what is left."""
    verbs = (
        *lexicon.PICK_VERBS, *lexicon.HAND_VERBS, *lexicon.PLACE_VERBS, *lexicon.DISCARD_VERBS, *lexicon.SORT_VERBS, "clear",
        "clean", "tidy", "can i", "may i", "i want", "i need", "i would",
    )  # fmt: skip
    return any(re.search(rf"\b{re.escape(verb)}\b", rest) for verb in verbs)
