"""The rules brain: Algorithm 1 without a language model, thoughts phrased from facts in the state.

It is a real brain, not a stand-in for one: it understands people by grammar, follows the ladder, and answers from the
recorded provenance. It draws no random numbers and remembers nothing between calls.
"""

from __future__ import annotations

from agent import phrases
from agent.answer import answer
from agent.brain import Deliberation, Reflected, Situation, Spoken
from agent.goal import Goal, Understanding
from agent.kept_force import warned
from agent.language.read_command import understand
from kb.percept import PerceivedObject
from kb.seen import Seen
from kb.sensing import Correction, Plan
from prompts import render


class RulesBrain:
    """Understands, thinks, reflects and answers by rules; what it sees is what was measured."""

    name = "rules"

    def __init__(self) -> None:
        self.calls = 0
        """How often it was asked, for the record."""

    def understand(self, situation: Situation) -> Understanding:
        """Reads the instruction by grammar; a bare thing is asked back."""
        self.calls += 1
        got = understand(situation.instruction, pending=situation.pending)
        bare = [goal for goal in got.goals if goal.kind == "answer" and goal.query is None]
        if bare and bare[0].reference is not None:
            thing = phrases.spoken(bare[0].reference)
            question = f"What shall I do with {thing}? I can pick it up, hand it to you or put it somewhere."
            return Understanding(question=question, goals=())
        return got

    def perceive(self, situation: Situation) -> Seen:
        """Nothing beyond what depth and the reference statistics say."""
        del situation
        return Seen()

    def think(self, situation: Situation) -> Deliberation:
        """The grasp, and why: experience, constraints, and what failed before."""
        self.calls += 1
        plan, target = situation.plan, _target(situation)
        assert plan is not None
        numbers = _numbers(plan)
        if situation.tries and situation.tries[-1].failure is not None:
            last = situation.tries[-1]
            text = render(
                "thought/retry",
                number=str(len(situation.tries)),
                failure=phrases.plain(last.failure or "UNKNOWN").lower(),
                level=str(situation.level),
                rule=_rule(situation),
                **numbers,
            )
            return Deliberation(text=text + warned(plan))
        constraints = " ".join(phrases.sentence(c.reason) for c in situation.constraints.active)
        text = render(
            "thought/first_attempt",
            target=phrases.object_name(target.category),
            material=target.affordance.material,
            fragility=f"{target.affordance.fragility:.1f}",
            width=f"{plan.local_width * 1000:.0f}",
            source=_source(situation),
            constraints=f"{constraints} " if constraints else "",
            **numbers,
        )
        return Deliberation(text=text + warned(plan))

    def reflect(self, situation: Situation, offered: Correction | None) -> Reflected:
        """Takes the correction that the rules offer, and says what it changes."""
        self.calls += 1
        last, number = situation.tries[-1], str(len(situation.tries) + 1)
        if offered is None:
            return Reflected(text=render("thought/blind", number=number))
        changes = [f"{field} {_value(value)}" for field, value in sorted(offered.changes.items())]
        if offered.region is not None:
            changes.append(f"region {offered.region}")
        text = render(
            "thought/correction",
            failure=phrases.plain(last.failure or "UNKNOWN").lower(),
            reasons="; ".join(last.reasons) or "no reading tells why",
            number=number,
            level=str(offered.level),
            rule=offered.rule,
            changes=f" ({', '.join(changes)})" if changes else "",
        )
        return Reflected(text=text, correction=offered)

    def answer(self, situation: Situation) -> Spoken:
        """What was done, or the answer to the question, from recorded facts."""
        self.calls += 1
        return answer(situation)


def _target(situation: Situation) -> PerceivedObject:
    assert situation.percept is not None
    goal: Goal | None = situation.goal
    assert goal is not None
    assert goal.target is not None
    return situation.percept.object(goal.target)


def _numbers(plan: Plan) -> dict[str, str]:
    grasp = plan.grasp
    return {
        "region": plan.region,
        "approach": phrases.tilt_words(plan),
        "force": f"{grasp.force:.1f}",
        "aperture": f"{grasp.aperture * 1000:.0f}",
        "quality": f"{plan.quality.q:.2f}",
    }


LITERAL, FIXED_DEFAULT = "literal parameters", "fixed default"
"""Candidate's name and id in the provenance of the grasp of ledger G20 (`literal_plan` and `grasp_prior` of the tools)."""


def _source(situation: Situation) -> str:
    """Which memory or experience the strategy comes from, by the plan's own provenance."""
    assert situation.plan is not None
    used = [item for sources in situation.plan.provenance.values() for item in sources]
    if any(item.source == "memory" for item in used):
        return "It worked like this before in this session."
    if situation.plan.candidate == LITERAL and any(item.id == FIXED_DEFAULT for item in used):
        return "Neither an experience nor a vision-language model proposes a grasp, so I take the fixed default."
    ids = {item.id for item in used if item.source == "experience"}
    for item in situation.retrieval.top if situation.retrieval else ():
        e = item.experience
        if e.id in ids:
            return (
                f"Experience {e.id}, {phrases.a(e.category)} taken by the {e.strategy.region}, succeeded in {e.n_success} of "
                f"{e.n_trials} trials."
            )
    if situation.retrieval is not None and situation.retrieval.top:
        return "None of the retrieved strategies can be carried out here, so the measured shape decides."
    return "There is no experience to go by, so the measured shape decides."


def _rule(situation: Situation) -> str:
    return situation.correction.rule if situation.correction is not None else "a fresh grasp"


def _value(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.3g}"
    if isinstance(value, tuple):
        return "(" + ", ".join(f"{float(v):.3g}" for v in value) + ")"
    return str(value)
