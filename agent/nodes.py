"""The nodes of the task graph (Algorithm 1; the seven stages of ledger G1).

A node is a few lines: it calls at most one tool, tells what happened as a typed step, and returns an update. Where it
goes next is `agent.routing`'s business. No node sees the observer.
"""

from __future__ import annotations

from langchain_core.messages import AIMessage, HumanMessage
from langgraph.runtime import Runtime

from agent import agenda, events, phrases
from agent.agenda import finish, push
from agent.ask_brain import ask_names, ask_thought, ask_understanding, ask_words, situation, wants_words
from agent.context import AgentContext
from agent.episode import recalled
from agent.goal import Understanding
from agent.ground import ground_goals
from agent.known_things import called, found_again, without_held
from agent.state import State, Update, merged
from agent.traced_tools import (
    build_scene_graph,
    infer_constraints,
    perceive,
    plan_grasp,
    retrieve_haarag,
)
from kb.constraint import Constraints
from kb.run_result import ModelUse
from kb.taxonomy import taxonomy
from memory import EpisodicMemory
from tools.build_scene_graph import SceneGraphArgs
from tools.infer_constraints import ConstraintArgs
from tools.perceive import PerceiveArgs
from tools.plan_grasp import PlanArgs
from tools.planning.remembered import RememberedGrasp
from tools.retrieve_haarag import RetrieveArgs

Run = Runtime[AgentContext]

KEPT_MOTIONS = 4
"""Motions of earlier turns that the observer still knows: its record is part of every checkpoint."""


def understand(state: State, runtime: Run) -> Update:
    """Instruction -> typed goals."""
    context, times = runtime.context, dict[str, float]()
    turn = state.turn + 1
    context.world.opened.forget(KEPT_MOTIONS)
    given, use = state.call.goals if state.call is not None else (), ModelUse()
    with context.timed("brain", times):
        got, use = (Understanding(goals=given), use) if given else ask_understanding(state, context)
    context.emit(events.Understood(text=phrases.understood(got), goals=got.goals))
    return merged(
        Update(
            scene=context.scene,
            seed=context.seed,
            turn=turn,
            # In a conversation the person's words are in it already.
            messages=[] if state.said else [HumanMessage(state.instruction, id=f"turn-{turn}-person")],
            goals=got.goals,
            agenda=agenda.ordered(got.goals),
            answer=got.refusal or got.question or "",
            question=got.question,
            refused=got.refusal is not None or got.question is not None,
            executed=False,
            extra_actions=0,
            motions={},
            pending=got.pending,
            graph=None,
            shown=None,
            constraints=Constraints(),
            memory=context.start_memory or EpisodicMemory(),
            times=times,
            use=use,
        ),
        agenda.fresh(),
    )


def look(state: State, runtime: Run) -> Update:
    """Stage 1: the cameras' pictures -> objects on the table."""
    context, times = runtime.context, dict[str, float]()
    context.world.at(state.world)
    args = PerceiveArgs(look=state.looks, previous=state.percept, nouns=phrases.nouns(state.goals))
    with context.timed("perception", times):
        percept = perceive(args, context.tool("look", state.looks))
    pictures, use = context.pictures(), ModelUse()
    percept = found_again(without_held(percept, state.held), state.percept, state.moved)
    if context.names_objects and percept.objects:
        percept, use = ask_names(percept, state, context, times)
    context.emit(events.Look(text=phrases.seen(percept), goal=state.current, percept=percept, pictures=pictures))
    return Update(percept=percept, stale=False, looks=state.looks + 1, pictures=pictures, times=times, use=use)


def ground(state: State, runtime: Run) -> Update:
    """Stage 2: which objects are meant; nothing moves unless all that was asked for is there."""
    result = ground_goals(state)
    for step in result.steps:
        runtime.context.emit(step)
    return result.update


def retrieve(state: State, runtime: Run) -> Update:
    """Stage 3: the experiences that help with this object."""
    context, times = runtime.context, dict[str, float]()
    target = phrases.target_of(state)
    name, tries = called(target, state.goal.reference, taxonomy(context.switches.taxonomy)), len(state.attempts)
    args = RetrieveArgs(category=name, affordance=target.affordance, embedding=target.embedding)
    with context.timed("retrieval", times):
        got = retrieve_haarag(args, context.tool("retrieve", tries))
        if got.best() is None and name != target.category:  # what goes by that name is handled otherwise
            seen = args.model_copy(update={"category": target.category})
            got = retrieve_haarag(seen, context.tool("retrieve", tries))
    context.emit(events.Retrieved(text=phrases.retrieved(got), goal=state.current, retrieval=got))
    return Update(experiences=got, shown=state.shown or got, times=times)


def build_graph(state: State, runtime: Run) -> Update:
    """Stage 4: relations between what is seen."""
    context, times = runtime.context, dict[str, float]()
    assert state.percept is not None
    with context.timed("planning", times):
        graph = build_scene_graph(SceneGraphArgs(percept=state.percept, target=state.goal.target), context.tools)
    context.emit(events.Graphed(text=phrases.graphed(graph, state), goal=state.current, graph=graph))
    return Update(graph=graph, times=times)


def constrain(state: State, runtime: Run) -> Update:
    """Stage 5: what the neighbourhood demands of the grasp."""
    context, times = runtime.context, dict[str, float]()
    assert state.graph is not None
    assert state.goal.target is not None
    margin = state.correction.margin if state.correction else 1.0
    with context.timed("planning", times):
        args = ConstraintArgs(graph=state.graph, target=state.goal.target, margin=margin)
        constraints = infer_constraints(args, context.tools)
    context.emit(events.Constrained(text=phrases.constrained(constraints), goal=state.current, constraints=constraints))
    return Update(constraints=constraints, times=times)


def remove_first(state: State, runtime: Run) -> Update:
    """C_support: something stands on the target, so that goes first."""
    first = state.constraints.adjustment.remove_first[0]
    sub = agenda.removal(state, first)
    if sub is None:
        return finish(state, claimed=False, note="too many things stand on it")
    runtime.context.emit(events.SubGoal(text=phrases.removal(sub, state), goal=state.current, pushed=sub))
    return merged(Update(extra_actions=state.extra_actions + 1), push(state, sub))


def choose(state: State, runtime: Run) -> Update:
    """The next object of a clear or sort goal."""
    assert state.percept is not None
    sub = agenda.next_to_handle(state, state.percept, state.graph)
    if sub is None:
        claimed, note = phrases.children(state)
        return finish(state, claimed=claimed, note=note)
    runtime.context.emit(events.SubGoal(text=phrases.next_object(sub), goal=state.current, pushed=sub))
    return push(state, sub)


def plan(state: State, runtime: Run) -> Update:
    """Experience as prior, geometry as candidates, constraints as limits -> a grasp (InitGrasp, ApplyCorrection)."""
    context, times = runtime.context, dict[str, float]()
    assert state.percept is not None
    assert state.goal.target is not None
    context.world.at(state.world)
    tries, target = state.tries(), phrases.target_of(state)
    known = recalled(state, context, target)
    args = PlanArgs(
        percept=state.percept,
        target=state.goal.target,
        retrieval=state.experiences,
        constraints=state.constraints,
        memory=RememberedGrasp.of(known),
        correction=state.correction,
        tried=tuple(a.plan for a in tries),
        attempt=len(tries),
        demands=state.demands,
    )
    with context.timed("planning", times):
        outcome = plan_grasp(args, context.tool("plan", len(state.attempts)))
    context.emit(
        events.Planned(text=phrases.planned(outcome.plan, outcome.reason), goal=state.current, plan=outcome.plan)
    )
    return Update(plan=outcome.plan, plan_reason=outcome.reason, times=times)


def look_once_more(state: State, runtime: Run) -> Update:
    """No grasp was found: the next picture may show more, and a correction that leaves nothing is dropped."""
    runtime.context.emit(
        events.Thought(
            text=f"{phrases.sentence(state.plan_reason)} I look again.", goal=state.current, level=state.level
        )
    )
    return Update(relooks=state.relooks + 1, stale=True, correction=None)


def think(state: State, runtime: Run) -> Update:
    """Thought over the grasp, the constraints and the history (Algorithm 1)."""
    context, times = runtime.context, dict[str, float]()
    number = len(state.tries())

    with context.timed("brain", times):
        decided = ask_thought(state, context)
    thought, plan = decided.value
    context.emit(events.Thought(text=thought.text, goal=state.current, level=state.level, attempt=number))
    if plan is not None:
        if plan is not state.plan:
            context.emit(events.Planned(text=phrases.planned(plan, ""), goal=state.current, plan=plan))
        return Update(thought=thought.text, plan=plan, times=times, use=decided.use)
    said = Update(thought=thought.text, times=times, use=decided.use)
    if thought.choice == "look_again":
        return merged(said, Update(relooks=state.relooks + 1, stale=True, plan=None))
    over = finish(state, claimed=False, note=thought.text)
    if thought.choice == "ask":
        return merged(
            over, said, Update(refused=True, answer=thought.question or "", question=thought.question, agenda=())
        )
    return merged(over, said)


def rehearse(state: State, runtime: Run) -> Update:
    """Dry run: a grasp was found, and nothing moves."""
    update = finish(state, claimed=True, note="planned, not executed")
    goals = tuple(
        goal.model_copy(update={"status": "done", "claimed": True, "note": "planned, not executed"})
        if goal.status == "open"
        else goal
        for goal in update.get("goals", ())
    )
    return merged(update, Update(goals=goals, agenda=(), plan=state.plan))


def give_up(state: State, runtime: Run) -> Update:
    """No grasp can be planned."""
    why = phrases.no_plan(state.plan_reason)
    runtime.context.emit(events.Reflection(text=phrases.sentence(why), goal=state.current, level=state.level))
    return finish(state, claimed=False, note=why)


def conclude(state: State, runtime: Run) -> Update:
    """A goal that only looks or answers is over."""
    return finish(state, claimed=True)


def answer(state: State, runtime: Run) -> Update:
    """Says what was done, or answers the question from recorded facts."""
    context, times = runtime.context, dict[str, float]()
    text, question, use = state.answer, state.question, ModelUse()
    if not state.refused and not text:
        facts = situation(state, context)
        with context.timed("brain", times):
            spoken, use = context.rules.answer(facts), ModelUse()
            if context.guarded and wants_words(state):
                spoken, use = ask_words(spoken, state, context, facts)
        text, question = spoken.text, spoken.question or question
    text += phrases.fallbacks(state.use.plus(use))
    context.emit(events.Question(text=text) if question else events.Answer(text=text))
    return Update(
        answer=text, question=question, messages=[AIMessage(text, id=f"turn-{state.turn}-agent")], times=times, use=use
    )
