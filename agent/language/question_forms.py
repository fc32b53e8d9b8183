"""Wordings of questions and conversational commands that are known by their form: see, why, why it failed, what if, help."""

from __future__ import annotations

import re
from dataclasses import dataclass

from agent.goal import Query

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
        r"what are (?:you able to do|you capable of|your (?:abilities|skills|commands|options))", r"how does (?:this|it|that|all this|everything)(?: all| robot| thing)? work",
        r"how (?:do|can) i (?:use|talk to|command|control) (?:you|this|it|the robot)", r"(?:show |list )?(?:the )?commands",
        r"(?:which|what) (?:commands|instructions|sentences|words) (?:do you (?:know|understand|have)|can i (?:use|say|give)|are there)",
        r"(?:please )?(?:can|could|would|will) you (?:please )?help(?: me)?(?: out| please)?", r"(?:i|we) (?:need|want|could use|require) (?:some |your |a bit of |any )?help", r"help me out",
        r"(?:give|show|tell) me (?:some |an? |the |your |all |a few )*(?:help|examples?|commands?|instructions|options|possibilities|manual|list of (?:the )?(?:commands|options))(?: please)?",
        r"what (?:am i|are we) (?:allowed|able) to (?:say|ask|do)(?: here| now)?", r"what (?:should|may|must|could|shall|might|do|can) i (?:say|ask|type|tell you|do)(?: here| now| to you)?", r"what (?:else )?(?:can|could|do) you (?:do|understand|know how to do|help (?:me )?with|offer)(?: for me| here)?",
        r"what (?:do you|can you) (?:understand|know)(?: how to do)?", r"how do i (?:start|begin|do this|work with you|give (?:you )?(?:a )?commands?)", r"how do you work",
        r"what (?:things|tasks|jobs|actions) (?:can|do) you (?:do|perform|know|understand|handle)", r"i (?:am lost|do not know what to (?:say|do))", r"what is this", r"what are my options",
        r"who are you", r"what are you", r"what (?:can|could|may|should) i (?:tell|ask|order|command|make|have) you(?: to)?(?: do| for)?", r"(?:tell me )?(?:about|introduce) yourself", r"what kind of robot are you", r"instructions", r"usage", r"manual", r"what do you understand",
    ),
    _pattern(
        "what_if",
        r"(?:and )?what (?:would|will|could|might) (?:have )?(?:happen(?:ed)?|be(?:en)?) (?:if|with|at|for|using)\b.*",
        r"(?:and )?(?:what|how) about (?:with |using )?\d+(?:\.\d+)? n(?:ewtons?)?(?: instead)?",
        r"(?:and )?what if\b.*", r"(?:and )?what happens (?:if|with|at|for)\b.*\d.*", r"(?:and )?(?:with|using|at) \d+(?:\.\d+)? n(?:ewtons?)?(?: instead| then)?",
        r"(?:would|will|could) (?:it|that|this|\d).*\b(?:work|hold|succeed|slip|fail|drop|break|enough).*\bn(?:ewtons?)?\b.*",
        r"would \d+(?:\.\d+)? n(?:ewtons?)? .*", r"simulate .*\d+(?:\.\d+)? n(?:ewtons?)?.*",
        r"(?:let us )?(?:suppose|imagine|assume|assuming|say)\b.*\bn(?:ewtons?)?\b.*", r"suppose (?:you|it|that|we)\b.*", r"imagine (?:you|it|that|we)\b.*",
        r"(?:and |but |so |then )*(?:if|had|would|could|might|what|how|do you think|does|is|will|should|can|whether)\b(?!.*\bkg\b).*\b\d+(?:\.\d+)? n(?:ewtons?)?\b.*",
        r"(?:and |but |so )*(?:try|test|simulate|check|run|compute|calculate|predict) (?:it |that |the (?:same )?(?:grasp|force) |what happens |this |again )*(?:with|at|using|for|if)\b.*\d+(?:\.\d+)? n(?:ewtons?)?\b.*",
        r"(?:and |but |or )*(?:only |just |maybe |with |using |at |say )*\d+(?:\.\d+)? n(?:ewtons?)?(?: instead| then| maybe)?",
    ),
    _pattern("why", rf"why (?:did|have|do|would) you (?:just )?{_GRASPED} .+ (?:and|but) not (?:the|a|an|that|this|from|by|with|at)\b.*"),
    _pattern(
        "why_failed",
        r"(?:so )?why (?:did|has) (?:it|that|this|you|the .*?|they) (?:just )?(?:fail|drop|slip|miss|lose|fall|crash|break|stop|"
        r"not|abort|give up|let go|failed|dropped|slipped)\b.*",
        r"why (?:did|could|can|were|was|would) (?:it|you|that|the .*?|they) not\b.*", r"what (?:went|has gone|is) wrong(?: there)?",
        r"why (?:did|could|would|can|were|do|does|is|was|will) not (?:you|it|that|they|the [a-z]+)\b.*", r"why not(?: .*)?", r"what was the (?:problem|failure|reason(?: for (?:the|that|this) failure)?|matter|issue)",
        r"what happened(?: there| just now)?", r"how did (?:it|that|you) fail", r"explain (?:the|that|this|your) failure",
        r"why (?:is|was) (?:it|that) (?:a failure|not successful|unsuccessful|not working)", r"what failed",
        r"(?:what is|what was|what were|tell me|explain|give me|do you know|what)(?: (?:me|to me))? (?:the |was the |caused the )?(?:cause|reason|reasons|root cause|explanation)s? (?:of|for|behind|why) (?:the |that |this |your |it |you )?(?:last |latest )?(?:failure|failing|failed|drop|dropping|slip|mistake|accident|problem|error|did not).*",
        r"(?:so )?why (?:is|are) (?:it|the .*?|my .*?|they) (?:now |still |suddenly )?(?:(?:lying )?on (?:the|its) (?:floor|ground|side)|lying|down|gone|broken|in pieces|not .*|still .*)", r"what (?:caused|made|led to) (?:it|that|the .*?|you|this)(?: to)? (?:fail|slip|drop|fall|break|failure|miss|slipping|drop it|lose it|let go)\b.*", r"how come (?:it|that|you|the .*?) (?:failed|dropped|slipped|fell|missed|broke|did not|could not|lost|let go|were not)\b.*",
        r"what (?:has )?(?:happened|went wrong|has gone wrong|did you do wrong|did not work)(?: (?:there|here|just now|to|with|when|during|now)\b.*)?", r"what was (?:it|that) that (?:went wrong|failed)",
        r"(?:so )?why (?:is|was|has|did|does|do|are|were|have|would|could) .*\b(?:fail|failed|failing|slip|slipped|drop|dropped|fall|fell|fallen|break|broke|broken|not|unsuccessful|lose|lost|miss|missed|stop|stopped|give up|gave up|given up|stuck|wrong|crash|crashed|topple|toppled|let go)\b.*",
        r"(?:please |can you |could you )*(?:explain|tell me|describe)(?: to me)? (?:why (?:it|that|this|you|the .*?) (?:failed|dropped|slipped|fell|broke|missed|did not|could not)|what (?:went wrong|happened|failed|the problem (?:is|was))|how (?:it|that|you) failed)\b.*",
        r"(?:so )?(?:did|has) (?:it|that|this) (?:work|worked|succeed|succeeded|go well)(?: out)?", r"(?:was|is) (?:it|that) a (?:success|failure)", r"(?:did|has) (?:it|that|something|anything) (?:fail|failed|go wrong|gone wrong|slip|slipped)", r"why the (?:failure|drop|slip|mistake)\b.*", r"why no success", r"why have you (?:failed|dropped|stopped).*",
    ),
    _pattern(
        "why",
        rf"(?:so |and )?why (?:did|have|do|would) you (?:just )?{_GRASPED}\b.*", r"why (?:that|this) (?:way|grasp|grip|object|one|side|force|angle|approach)",
        r"why (?:the |so |with |from |at |by |like |in |on |such |a |an )*(?:handle|rim|body|stem|neck|edge|top|side|that|much|little|"
        r"gently|slow|slowly|hard|above|force|angle|approach|tight|firmly|this)\b.*",
        r"explain (?:your|the|that|this|why|how)\b.*",
        r"(?:what is|what was|what were|tell me|give me|explain) (?:me )?(?:the |your )?(?:reason|logic|idea|rationale|thinking|thought|motivation|ground|justification|basis|explanation|point)s?(?: (?:of|for|behind|why|to|here|you|that|it)\b.*)?",
        r"how come\b.*", r"(?:so |and |but )*why (?:so|such|only|exactly|all)\b.*", r"what (?:led|brought|caused|prompted|motivated) you\b.*",
        r"(?:please |can you |could you |would you )*(?:explain|tell me|justify|describe|elaborate on|elaborate|show me)(?: to me)? (?:why|how (?:you|it|that)|your (?:choice|decision|reasoning|grasp|plan|thinking|strategy|thoughts)|the (?:grasp|grip|choice|decision|force|plan))\b.*",
        r"(?:so |and |but )*why (?:did|do|were|are|was|is|have|has|would|should|must) (?:you|it|that|this|the (?:grasp|grip|force|hand|gripper|approach|angle|arm|fingers))\b.*",
        r"how (?:was|were) (?:the|that|this) (?:grasp|grip|force|choice|decision|object|angle|approach) .*", r"what (?:were|are) you thinking\b.*", r"based on what\b.*", r"(?:and )?(?:for )?what (?:for|reason)",
        r"why (?:the|this|that|these|those) (?:grasp|grip|force|approach|angle|region|place|spot|way|choice|order|one|object|height|speed)\b.*", r"why \d+(?:\.\d+)? (?:n|newtons?)\b.*", r"why", r"how come", r"justify\b.*", r"what made you\b.*",
        r"how did you (?:decide|choose|know|plan|pick|select|grasp|grip|find|come)\b.*", r"on what basis\b.*",
        r"(?:what|where) (?:did|does|do) (?:you|the|that|this) .*(?:force|number|value|grasp) come from.*",
        r"what (?:is|was) your (?:reasoning|plan|strategy|thinking)", r"tell me why\b.*", r"where does (?:the|that) .* come from",
    ),
    _pattern(
        "held", r"what (?:are|were) you (?:holding|carrying|gripping)(?: now| right now)?",
        r"what (?:did|have|do) you (?:just |last |now )?(?:pick|picked|take|taken|took|grab|grabbed|lift|lifted|grasp|grasped|get|got|hold|held)(?: up)?(?: just now| last| now)?", r"(?:tell me |show me )?what (?:you are|you) (?:holding|carrying|gripping|have in (?:your|the) (?:hand|gripper))", r"(?:is|do you have|have you got|are you holding|are you carrying|is there) (?:still )?(?:something|anything|.*) in (?:your|the) (?:hand|gripper|fingers|grip)(?: now| right now| still)?",
        r"are you (?:still |currently )*(?:holding|carrying|gripping) .*", r"is (?:your|the) (?:hand|gripper|grip) (?:empty|free|full|occupied|closed)(?: now| right now)?", r"what (?:have you|did you) (?:got|pick up|picked up|taken|take)(?: in your hand)?(?: last)?",
        r"what (?:is|do you have|have you got|do we have)(?: there)? in (?:your|the) (?:hand|gripper|fingers|grip)(?: right)?(?: now)?",
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
        r"(?:describe|show|explain|list|name) (?:the |your |this )?(?:scene|table|objects|things|items|surroundings|workspace) (?:to|for) (?:me|us)", r"(?:which|what) (?:objects|things|items|stuff) (?:do|can|could|did) (?:you|we|i) .*", r"(?:which|what) (?:objects|things|items)(?: (?:are|do you see|can you see|is|lie|stand|have you).*)?",
        r"(?:tell|show) me (?:what is|what all is|what is all)", r"tell me what (?:you (?:can )?see|is (?:there|on the table))(?: on the table)?", r"what have you (?:got|found|seen)",
        r"is (?:there )?(?:anything|something)(?: there| on the table)?", r"show me what you (?:can )?see",
        r"(?:please |can you |could you |would you )*(?:tell me|describe|list|show me|name|give me|report|say)(?: me| to me)?(?: (?:about|of|a|an|the|short|quick|brief|full|complete|all|list|overview|description|summary|inventory|report|picture|what|everything|things|objects|items|each|every|object|thing|item|that|which|whatever))* (?:overview|description|summary|inventory|report|(?:you|i|we) (?:can |could )?(?:see|have|recogni[sz]e|detect|perceive|notice)|is there|there is|is (?:lying |standing )?on (?:the|your|this) (?:table|desk)|(?:on|of) (?:the|your|this) (?:table|desk|scene|workspace))"
        r"(?: (?:of|on|about) (?:the|your|this) (?:table|desk|scene|workspace|objects|things))?(?: right now| now| there| here| please| at the moment)*",
        r"(?:take a |have a |give (?:it|the table) a |quick )?(?:look|glance|scan|inspect|examine|survey|check)(?: at| over| around| on)* (?:the|your|this) (?:table|desk|scene|workspace|surface)(?: and (?:tell|describe|report|list|say|show|name)\b.*)?",
        r"look(?: around)? and (?:tell|describe|report|list|say|show|name)\b.*", r"what (?:is|do you) (?:going on|see|find|notice)(?: (?:there|here|on the table|right now|at the moment|now|today|before you|in front of you))*",
        r"what (?:things|objects|items|stuff|sort of (?:things|objects)|kinds? of (?:things|objects|items)) (?:are|is|do|can|did|have|lie|stand|lies) (?:you |there |we |i |on |lying |standing |visible|present).*",
        r"(?:can|could|do) you (?:see|perceive|detect|recogni[sz]e) (?:something|anything)(?: there| here| on the table)*", r"what is (?:all )?(?:lying|standing|sitting|placed|there|here|present|visible)(?: (?:around|here|there|on (?:the|this|your) (?:table|desk)|in front of you))*",
        r"what (?:have we|do we have|has been put)(?: got)?(?: here| there| on the table)*", r"what all is there", r"what objects", r"what is on (?:it|there)",
    ),
)  # fmt: skip
