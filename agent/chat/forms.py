"""How people refer to what was done and said before in a conversation, as patterns over the cleaned words."""

from __future__ import annotations

import re

_REMEMBER = (
    r"(?:please )?(?:remember|memori[sz]e|keep in mind|do not forget|learn|note)(?: how (?:you (?:did|took|grasped|held) )?)?"
    r" ?(?:that|this|it|how|that one|this one|what worked|the grasp|this grasp|that grasp)?(?: (?:that|this|it|that way|works?|worked))*"
    r"(?: (?:for|until) (?:next time|later|tomorrow|the future|good|the next time|ever))?"
)
REMEMBER = re.compile(rf"^{_REMEMBER}$")
AND_REMEMBER = re.compile(rf"^(?P<first>.+? .+?)(?: ,| \.| ;| and)(?: and)?(?: then)? {_REMEMBER}$")
FORGET = re.compile(
    r"^(?:please )?forget (?:everything|all(?: of it)?|what)(?: that)?(?: you(?: have)?)?(?: ever)?(?: (?:remember(?:ed)?|learn(?:ed|t)?|know))?"
    r"(?: (?:about|of) (?:the |a |an )?(?P<what>[a-z ]+))?$"
    r"|^(?:please )?forget (?:about )?(?:how to (?:hold|grasp|take) )?(?:the |a |an )(?P<thing>[a-z ]+)$"
)
RECALL = re.compile(
    r"^(?:what|which things) (?:do|can|have) you (?:still )?(?:remember(?:ed)?|learn(?:ed|t)?|memori[sz]ed?)"
    r"(?: (?:so far|now|about (?:the |a |an )?(?P<what>[a-z ]+)))?$|^what is in your memory$|^(?:show |your )?memory$"
)
HOW = re.compile(
    r"\b(force|hard|harder|firmer|gentler|softer|handle|rim|neck|body|side|above|pinch|power|fast|faster|slower)\b"
)
"""In "why did you not ..." these ask about the grasp that was chosen, not about a failure."""
COMPARE = re.compile(
    r"^(?:please )?(?:compare|what (?:is|was|are|were) (?:the )?(?:difference|differences|different)|how (?:do|did|does) (?:they|it|that|the two) "
    r"(?:differ|compare)|what (?:did you do|was|is|have you done) different(?:ly)?|difference|diff)\b(?P<rest>.*)$"
)
REPORT = re.compile(
    r"^(?:please )?(?:what (?:have|did) you (?:done|do|tried|try|achieved?|managed?)(?: so far| until now| today| yet| here)?|report(?: to me)?|"
    r"summary|summari[sz]e(?: (?:it|everything|that|what you did))?|give me (?:a )?(?:report|summary)|what happened so far|how did it go|"
    r"how many (?:attempts|tries)(?: (?:did|have|has|were) .*)?|status)$"
)
WHAT_IF = re.compile(
    r"^(?:and |but |so )?(?:what (?:if|would|will|could|might|happens)|what about|how about|suppose|imagine|simulate|try in simulation|"
    r"would (?:it|that|you|this)|could (?:it|that|you) have|with \d|using \d|at \d)\b(?P<rest>.*)$"
)
AGAIN = re.compile(
    r"^(?:no |please |ok |okay |now |and |then |, )*(?:(?:do|try|repeat|make|perform) (?:that|it|this|the same(?: thing)?)(?: one)?(?: again| once more| one more time| another time)?"
    r"|(?:do|try|repeat)(?: it| that)? (?:again|once more)|again|once more|one more time|another time|retry|repeat|same again|try|(?:the )?same)"
    r"(?: please| now| then| but| and| only| just| this time| ,| a)*$"
)
GO_ON = re.compile(
    r"^(?:ok |okay |now |please |and )*(?:go on|continue|carry on|keep going|proceed|finish it|go ahead)(?: with (?:it|that))?(?: please| now| then)*$"
)
SAME_WITH = re.compile(
    r"^(?:and |now |then |please |ok )*(?:do |try |repeat )?(?:the )?same(?: thing)? (?:with|for|to|on) (?P<what>.+)$"
)
AND_THE = re.compile(
    r"^(?:no ,? ?)?(?:and|what about|how about|now|also|then|and now|and also|and then|but|or|instead|rather|and what about|next) (?P<what>(?:the |that |this |another |a |an )?[a-z -]+?)"
    r"(?: too| as well| also| instead| now| please| then| next)*$|^(?P<too>(?:the |that |this |another )[a-z -]+?) (?:too|as well|also|instead|next|please)$"
)
OTHER = re.compile(
    r"^(?:no |not (?:that|this)(?: one)?|not it|, |please |i (?:mean|meant) |but |rather |wait )*(?P<what>(?:the |that )?other(?: one| [a-z]+)?)(?: one)?(?: please| instead| too| as well| now)*$"
)
INSTEAD = re.compile(
    r"^(?:no|not (?:that|this)(?: one)?|not it|wait|i mean|i meant)(?: ,)? (?P<what>(?:the |that )[a-z -]+)$"
)
MANNERS = ("gently", "softly", "carefully", "slowly")
"""Wishes that are courtesies elsewhere; "quickly" is none, for the arm goes as fast as it may anyway."""
TALK: tuple[tuple[re.Pattern[str], str], ...] = (
    (re.compile(r"^(?:many )?(?:thanks?|thank you|thx|cheers)\b.*$"), "You are welcome."),
    (re.compile(r"^(?:hello|hi|hey|good (?:morning|day|evening|afternoon)|hallo)(?: there| robot)?$"),
     "Hello. Tell me what to pick up or where to put it, or ask what I see."),
    (re.compile(r"^(?:(?:very |well )?(?:good|god|nice|great|perfect|excellent|wonderful|cool|bravo|well|super)(?: job| work| done| one)?|well done)$"),
     "Thank you. If I should do it like this another time, say: remember that."),
    (re.compile(r"^(?:yes|ok|okay|sure|fine|y|no|n|nope|alright|all right)(?: please)?$"), "All right. I am not waiting for an answer; nothing moves."),
    (re.compile(r"^(?:good ?bye|bye|see you(?: later)?|ciao)$"), "Goodbye. Say /quit to leave; I keep what was said and done."),
)  # fmt: skip
"""Small talk, and what is said to it."""
