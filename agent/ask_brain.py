"""The questions that nodes put to the brain, each through the gate: what is asked, of which facts, and what must hold.

The only callers are nodes; the only way to the brain is `agent.safety.consult`.
"""

from __future__ import annotations

from dataclasses import replace

from agent import events, phrases
from agent.brain import Brain, Deliberation, Reflected, Situation, Spoken
from agent.context import AgentContext
from agent.goal import Understanding
from agent.safety.consult import Consultation, Consulted
from agent.safety.gate import (
    judged_answer,
    judged_names,
    judged_reflection,
    judged_thought,
    judged_understanding,
)
from agent.state import State
from kb.percept import Percept
from kb.run_result import ModelUse
from kb.sensing import Correction, Plan
from tools.choose_grasp import Choice, ChooseArgs, choose_grasp
from tools.name_objects import NameArgs, name_objects


def situation(state: State, context: AgentContext) -> Situation:
    """The facts that a brain may use."""
    return Situation(
        instruction=state.instruction,
        goals=state.goals,
        goal=state.goal if state.agenda else None,
        percept=state.percept,
        graph=state.graph,
        retrieval=state.experiences,
        constraints=state.constraints,
        plan=state.plan,
        level=state.level,
        correction=state.correction,
        pending=state.pending,
        attempts=state.attempts,
        tries=state.tries(),
        turn=state.turn,
        held=state.held,
        in_bin=state.in_bin,
        last_target=state.last_target,
        plan_reason=state.plan_reason,
        dry_run=context.dry_run,
        stopped=context.stopped,
        views=context.views,
    )


def ask_understanding(state: State, context: AgentContext) -> tuple[Understanding, ModelUse]:
    """The brain's reading of the instruction, if it counts, and the model's part in it."""

    def ask(brain: Brain, facts: Situation) -> Understanding:
        got = brain.understand(facts)
        return got if brain is context.rules else judged_understanding(got, facts)

    decided = Consultation("understand", state, context, situation(state, context), ask).decide()
    return decided.value, decided.use


def ask_names(
    percept: Percept, state: State, context: AgentContext, times: dict[str, float]
) -> tuple[Percept, ModelUse]:
    """The percept with the names that the brain gives and measuring allows, and the model's part in it."""
    facts = replace(situation(state, context), percept=percept)
    with context.timed("perception", times):
        decided = Consultation(
            "perceive", state, context, facts, lambda brain, facts: judged_names(brain.perceive(facts), facts)
        ).decide()
        joined = name_objects(NameArgs(percept=percept, seen=decided.value), context.tools)
    text = phrases.named(len(decided.value.objects), joined.dropped)
    context.emit(events.Named(text=text, goal=state.current, seen=decided.value, dropped=joined.dropped))
    return joined.percept, decided.use.plus(ModelUse(contradictions=len(joined.dropped)))


def ask_thought(state: State, context: AgentContext) -> Consulted[tuple[Deliberation, Plan | None]]:
    """The brain's decision about the planned grasp, and the plan to execute; None where it does not act."""

    def choose(args: ChooseArgs) -> Choice:
        return choose_grasp(args, context.tool("choose", len(state.attempts)))

    def ask(brain: Brain, facts: Situation) -> tuple[Deliberation, Plan | None]:
        return judged_thought(brain.think(facts), facts, choose, state.relooks)

    return Consultation("think", state, context, situation(state, context), ask).decide()


def ask_reflection(
    state: State, context: AgentContext, offered: Correction | None, allowed: tuple[Correction, ...]
) -> Consulted[Reflected]:
    """What the brain makes of the last failure: one of the allowed corrections, or giving up."""

    def ask(brain: Brain, facts: Situation) -> Reflected:
        return judged_reflection(brain.reflect(facts, offered), facts)

    facts = replace(situation(state, context), allowed=allowed)
    return Consultation("reflect", state, context, facts, ask).decide()


WORDED = ("see", "where", "near", "why", "why_failed", "properties", "count", "held", "what_if")
"""Questions that a model may answer in its own words, from the facts that the rules would state."""


def wants_words(state: State) -> bool:
    """Whether there is something to explain: a question, or a failure. A plain success is told as it is recorded."""
    if not state.goals:
        return False
    if state.goals[0].query is not None:
        return state.goals[0].query in WORDED
    return any(goal.status == "failed" for goal in state.goals if goal.parent is None)


def ask_words(spoken: Spoken, state: State, context: AgentContext, facts: Situation) -> tuple[Spoken, ModelUse]:
    """The recorded facts in the model's words; after a failure the recorded sentence stands in front of them."""
    facts = replace(facts, facts=spoken.text)

    def ask(brain: Brain, facts: Situation) -> Spoken:
        return spoken if brain is context.rules else judged_answer(brain.answer(facts), facts)

    decided = Consultation("answer", state, context, facts, ask).decide()
    if decided.by_rules or state.goals[0].query is not None:
        return decided.value, decided.use
    return spoken.model_copy(update={"text": f"{spoken.text} {decided.value.text}"}), decided.use
