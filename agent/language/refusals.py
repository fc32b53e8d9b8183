"""What the robot cannot do, and says so: two arms, pouring, more than 3 kg, and verbs beyond picking and placing."""

from __future__ import annotations

import re

from agent.language import lexicon

MAX_PAYLOAD = 3.0
"""Payload of the Panda [kg] (Franka Emika datasheet)."""

TWO_ARMS = re.compile(
    r"\b(?:both|two|2|three|your other) (?:of your )?(?:hands|arms|grippers|robots|arm|hand)\b|\bbimanual|\bother (?:arm|hand|gripper)\b|"
    r"\b(?:at the same time|simultaneously|at once|in parallel)\b.*\b(?:and|both|two)\b|\b(?:and|both|two)\b.*"
    r"\b(?:at the same time|simultaneously|at once|in parallel)\b|\btwo at a time\b|\btogether (?:at once|in one go|in one hand)\b|\b(?:and|both|two|all)\b.*\b(?:at once|in one go|in one grasp|with one grasp|in one move)\b|\b(?:left|right) (?:hand|arm) and\b|\bsecond arm\b|\bleft (?:hand|arm)\b.*\bright (?:hand|arm)\b|\bright (?:hand|arm)\b.*\bleft (?:hand|arm)\b"
)
WEIGHT = re.compile(r"(\d+(?:\.\d+)?)\s*(kg|kilo(?:gram)?s?|kilograms?|tons?|tonnes?|lbs?|pounds?|g|grams?)\b")
TO_KG = {"k": 1.0, "t": 1000.0, "l": 0.4536, "p": 0.4536, "g": 0.001}
POUR = re.compile(
    r"\b(?:pour|decant|refill|tip out|spill|sprinkle)\b|\bfill (?:up )?(?:the|a|my|it|this|that)\b|\bempty (?:the|a|my|it) .*\b(?:into|in|out)\b"
    r"|\bempty (?:the|this|that|my) (?:cup|mug|bowl|bottle|glass|vase)\b|\b(?:make|serve|brew|get|give|bring|fetch|pour|have) (?:me |us )?(?:a |some )(?:cup of |glass of |cold |hot )?(?:drink|tea|coffee|juice|water|beer|milk|wine(?! glass))\b|\b(?:make|serve|brew) (?:me |a |some )*(?:tea|coffee|juice|water)\b"
)
UNABLE = re.compile(
    r"^(?:(?:please|just|then|now|and) )*(?P<verb>"
    + "|".join(sorted(lexicon.UNABLE, key=len, reverse=True))
    + r")\b (?P<rest>.+)$"
)
HAND_OPEN = re.compile(r"^open (?:your|the) (?:hand|gripper|fingers)$")
NOT_THINGS = re.compile(
    r"\b(?:pick up|pick|take|grab|grasp|lift|hold|get|fetch|give|hand|pass|bring|put|place|move|throw|drop|raise)\b(?: me)? "
    r"(?:up |away )?(?:yourself|myself|me$|your (?:own )?(?:arm|hand|gripper|head|body|base|finger|fingers|camera)|"
    r"the (?:robot|table|desk|floor|ceiling|wall|bin|camera|room|house|world|moonlight))(?: up| away| .*)?$"
)
THROWN = re.compile(
    r"^(?:throw|toss|chuck|fling|hurl) (?:.+ )(?:at|out of the window|through|against|across|over|to (?!the (?:bin|trash|left|right|side|front|back|middle)|me|us))\b(?! the (?:bin|trash))"
)
BOTH_SIDES = re.compile(
    r"\b(?:left (?:side )?and (?:to |on )?(?:the )?right|right (?:side )?and (?:to |on )?(?:the )?left)(?: side)? of\b|\b(?:to|on|at) (?:the )?(left|right|front|back) (?:side )?and (?:also )?(?:(?:to|on|at) )?(?:the )?(?!\1)(?:left|right|front|back)(?: side)?(?: of\b|$)"
)
CODE = re.compile(
    r"[a-zA-Z_]\w*\((?!s\))|\)\s*;|=>|==|:=|[{}]|</?[a-zA-Z]|\$\(|&&|\|\||\bimport \w+\b|\b(?:select|delete|drop|insert) .*\b(?:from|table|into)\b (?!the\b)\w+ ?;|\bsudo\b|\brm -"
)
"""Program text in what was typed: a command to a computer, not to this robot."""
CONDITION = re.compile(
    r"(?:^|[,.;] |\bbut |\bonly )(?:if|unless|in case|as long as|whenever|until|when i|once i|after i|as soon as i) (?!you\b|possible|need|it is (?:possible|not too|ok|okay|fine|all right)|that is (?:ok|okay|fine|possible))"
    r"|\b(?:if|unless|whenever|until) (?:the|it|there|my|they|that|any|nobody|someone|i)\b(?! (?:is (?:possible|ok|okay|fine))\b)|\btomorrow\b|\btonight\b|\bin (?:\d+|a few|five|ten|an?) (?:minutes?|hours?|seconds?)\b"
)
DISTANCE = re.compile(
    r"\b(?:move|shift|slide|put|place|set|bring|carry|nudge|transfer|relocate|lay|stand)\b.* (?:\d+(?:\.\d+)?|an?|one|two|three|four|five|six|seven|eight|nine|ten|twenty|few|half an?) ?"
    r"(?:cm|mm|m|centimet(?:er|re)s?|millimet(?:er|re)s?|met(?:er|re)s?|inch|inches|feet|foot|hand ?widths?)\b"
)
"""Moving a thing by a length, or to a length from something."""
OUT_OF_BIN = re.compile(
    r"^(?:take|get|pick|pick up|grab|fetch|bring|put|move|lift|pull|fish|remove|retrieve|give|hand) .*\b(?:out of|from(?: inside| out of)?|back from) the "
    r"(?:bin|trash(?: can| bin)?|rubbish(?: bin)?|garbage(?: can| bin)?|wastebasket|dustbin|basket)\b"
    r"|^empty the (?:bin|trash(?: can)?|dustbin)\b"
)
FROM_A_HEIGHT = re.compile(
    r"^(?:drop|release|let go of|let|throw|toss|lower) .*\bfrom (?:a |the |your )?(?:great |certain |small |full |top )?(?:height|distance|high|far|up|above|way up|there|\d|an? |one |two |ten |half )"
    r"|^(?:let|make) .+ (?:fall|drop|crash|bounce)\b|^drop .*\b(?:\d+(?:\.\d+)? ?(?:cm|mm|m)\b|from where you are)"
)
HIGHER = re.compile(
    r"^(?:lift|raise|hold|move|take|bring|carry|keep|lower|pick) .*(?:\b(?:higher|lower|further (?:up|down)|higher up|lower down)$"
    r"|\b(?:by |at |to |up |down )*\d+(?:\.\d+)? ?(?:cm|mm|m|centimet(?:er|re)s?|millimet(?:er|re)s?|met(?:er|re)s?|inch|inches)\b(?: (?:above|over|high|higher|up|from|off|into the air|lower|down)\b.*)?$)"
)
"""Lifting or lowering by a length: the arm has one height for what it holds."""
OFF_TABLE = re.compile(
    r"\b(?:on|onto|off|to|over|from|in|into|under) the (?:floor|ground|ceiling|roof|wall|shelf|kitchen|fridge|garden|chair|sofa|cupboard|drawer|cabinet|sink|oven|rack|stove|bed|couch|bookshelf|street|room)\b"
)


def refuse(line: str) -> str | None:
    """Why the robot will not do it, or None.

    Args:
        line: cleaned and mended tokens joined by spaces.
    """
    if TWO_ARMS.search(line):
        return "I have one arm with one gripper: I can hold one thing at a time, so I cannot do that with two at once."
    for amount, unit in WEIGHT.findall(line):
        mass = float(amount) * TO_KG[unit[0]]
        if mass > MAX_PAYLOAD:
            return f"I can carry at most {MAX_PAYLOAD:g} kg; {mass:g} kg is too heavy for this arm."
    if POUR.search(line):
        return "I cannot pour or fill: I only pick things up and put them down, upright if something is in them."
    found = UNABLE.match(line)
    if found and not HAND_OPEN.match(line):
        return (
            f"I cannot {found['verb']} things. I can pick them up, hand them over, put them somewhere, clear and sort."
        )
    if NOT_THINGS.search(line):
        return "I can only move loose things that stand on the table."
    if CONDITION.search(line):
        return "I cannot wait for a condition or a time: ask me whether it is so, and then tell me what to do."
    if BOTH_SIDES.search(line):
        return "That contradicts itself: a thing cannot be on both sides at once."
    if OUT_OF_BIN.search(line):
        return "I cannot take things out of the bin: I do not see what lies in it, and its walls are in the way."
    if FROM_A_HEIGHT.search(line):
        return (
            'I do not let things fall: I set them down gently. Say "put it back", "put it down", "put it on the left" or, '
            'where there is a bin, "put it in the bin".'
        )
    if HIGHER.search(line):
        return "I lift a thing to one height, about 17 cm, and hold it there. I can put it down, put it back or hand it over."
    if DISTANCE.search(line):
        return "I cannot move a thing by a length. I can put it on the left, on the right, at the front or back, or next to something."
    if THROWN.match(line):
        return "I cannot throw things at or to something: I only let go of them in the bin."
    if OFF_TABLE.search(line):
        return "I only reach the table and the bin beside it, so I cannot put anything there."
    return None
