"""Where the graph goes next. Each function reads the state and names a node; nothing is computed or moved here."""

from __future__ import annotations

from typing import Literal

from langgraph.runtime import Runtime

from agent.context import AgentContext
from agent.ladder import PLAN_LOOKS
from agent.state import State

Run = Runtime[AgentContext]

ANSWERED_FROM_RECORD = ("why", "why_failed", "help", "stop", "held")
"""Questions that need no look at the table."""


def after_understand(state: State) -> Literal["look", "simulate", "conclude", "answer"]:
    """Questions about the past are answered from the record, everything else begins with a look."""
    if state.refused or not state.agenda:
        return "answer"
    if state.goal.query == "what_if":
        return "simulate"
    return "conclude" if state.goal.query in ANSWERED_FROM_RECORD else "look"


def after_ground(
    state: State, runtime: Run
) -> Literal[
    "answer", "look", "ground", "place", "approve_place", "conclude", "build_graph", "choose", "retrieve", "plan"
]:
    """Which stage the grounded goal needs next."""
    switches = runtime.context.switches
    if state.refused or not state.agenda:
        return "answer"
    if state.stale:
        return "look"
    goal = state.goal
    if goal.kind in ("look", "answer"):
        in_hand = state.held is not None and goal.target == state.held.object.id
        return "build_graph" if goal.target and not in_hand and goal.query in ("where", "near") else "conclude"
    if goal.kind in ("clear", "sort"):
        if goal.reference is None or not goal.reference.ids:
            return "ground"
        return "build_graph" if switches.scene_graph else "choose"
    if state.held is not None and goal.target == state.held.object.id:
        return "conclude" if goal.placement is None else _placing(runtime)
    if goal.target is None:
        return "ground"
    if not state.tries() and switches.retrieval != "none":
        return "retrieve"
    return "build_graph" if switches.scene_graph else "plan"


def after_retrieve(state: State, runtime: Run) -> Literal["build_graph", "plan"]:
    """The scene graph, where it takes part."""
    del state
    return "build_graph" if runtime.context.switches.scene_graph else "plan"


def after_graph(state: State, runtime: Run) -> Literal["conclude", "choose", "constrain", "plan"]:
    """A question is answered from the graph; clearing chooses by it; grasping infers constraints from it."""
    kind = state.goal.kind
    if kind in ("look", "answer"):
        return "conclude"
    if kind in ("clear", "sort"):
        return "choose"
    return "constrain" if runtime.context.switches.constraints else "plan"


def after_constrain(state: State) -> Literal["remove_first", "plan"]:
    """C_support inserts a removal before the target is touched."""
    return "remove_first" if state.constraints.adjustment.remove_first else "plan"


def after_plan(state: State) -> Literal["think", "look_once_more", "give_up"]:
    """Without a grasp another look may help: in bad light the next width may be one that the hand can span."""
    if state.plan is not None:
        return "think"
    return "look_once_more" if state.relooks < PLAN_LOOKS else "give_up"


def after_think(state: State, runtime: Run) -> Literal["act", "approve", "rehearse", "look", "ground", "answer"]:
    """Act, unless a person is to be asked first or nothing is to move."""
    if state.plan is None:  # the brain gave up or asked
        return go_on(state)
    if runtime.context.dry_run:
        return "rehearse"
    return "approve" if runtime.context.approve else "act"


def after_approve(state: State) -> Literal["act", "ground", "plan", "answer"]:
    """Nothing moves without the person's word; whoever wants it otherwise gets another plan."""
    if not state.agenda:
        return "answer"
    return "act" if state.plan is not None else "ground" if state.goal.target is None else "plan"


def after_observe(state: State) -> Literal["remember", "set_back", "reflect"]:
    """A claimed success is remembered; after a failure the hand is emptied, then looked at once, then reflected on."""
    if state.diagnosis is not None and state.diagnosis.claimed:
        return "remember"
    return "set_back" if state.camera is None else "reflect"


def after_reflect(state: State) -> Literal["look", "ground", "answer"]:
    """The next attempt starts from what is there now."""
    return go_on(state)


def after_remember(state: State, runtime: Run) -> Literal["place", "approve_place", "look", "ground", "answer"]:
    """What was taken is put where it is to go."""
    if state.agenda and state.held is not None and state.goal.target == state.held.object.id and state.goal.placement:
        return _placing(runtime)
    return go_on(state)


def _placing(runtime: Run) -> Literal["place", "approve_place"]:
    """To the placing, by way of the person who is to be asked first."""
    return "approve_place" if runtime.context.approve else "place"


def after_approve_place(state: State) -> Literal["place", "ground", "answer"]:
    """Nothing is put down without the person's word; a wish for another place is grounded and asked about again."""
    if not state.agenda:
        return "answer"
    return "place" if state.consent else "ground"


def after_place(state: State) -> Literal["look_at_placed", "look", "ground", "answer"]:
    """What was put down is looked at before it is claimed."""
    return "look_at_placed" if state.agenda and state.put_down is not None else go_on(state)


def go_on(state: State) -> Literal["look", "ground", "answer"]:
    """The next open goal, with a fresh look if something has moved."""
    if state.refused or not state.agenda:
        return "answer"
    return "look" if state.stale or state.percept is None else "ground"


def at_the_end(state: State) -> Literal["__end__"]:
    """The run is over."""
    del state
    return "__end__"
