"""The node before a placing: a person sees what goes where, and agrees, says no, or names another place."""

from __future__ import annotations

import math
from typing import Any

from langgraph.runtime import Runtime
from langgraph.types import interrupt

from agent import events, phrases
from agent.agenda import changed, finish
from agent.approval import Decision, Proposal
from agent.chat.steer import steered
from agent.context import AgentContext
from agent.goal import Placement
from agent.placed import placing_thought, putting
from agent.placing import place_args
from agent.state import State, Update, merged
from kb.base import Vec2
from tools.place_object import PlaceArgs, choose_place

Run = Runtime[AgentContext]

FIXED = ("bin", "on", "hand_over")
"""Placements whose place is not a matter of choice."""
NEAR = 0.02
"""So near to the person's place there must be a free one, else the robot asks again [m]."""


def approve_place(state: State, runtime: Run) -> Update:
    """A person decides about the placing; the graph waits here, even over a restart.

    Where there is no free place nothing would move, so nothing is asked.
    """
    context = runtime.context
    context.world.at(state.world)
    args = place_args(state)
    point = _place(args, context)
    if point is None and args.kind != "hand_over":
        return Update(consent=True)
    decision = Decision.model_validate(interrupt(_proposal(state, args, point)))
    held = state.held
    assert held is not None
    text = phrases.decided(decision, motion="place")
    context.emit(events.Approval(text=text, goal=state.current, plan=held.plan, decision=decision.verdict))
    if decision.verdict == "reject":
        note = "you did not approve it"
        return Update(agenda=(), consent=False, goals=finish(state, claimed=False, note=note).get("goals", ()))
    if decision.verdict == "steer":
        return merged(steered(state, decision.words, context=context), Update(consent=False))
    if decision.verdict == "edit" and decision.point is not None:
        return _elsewhere(state, decision.point, context)
    return Update(consent=True)


def _place(args: PlaceArgs, context: AgentContext) -> Vec2 | None:
    """The middle of the place that placing would choose [m]."""
    if args.kind == "hand_over":
        return None
    found = choose_place(args, context.tools)
    return None if found is None else found.centre


def _proposal(state: State, args: PlaceArgs, point: Vec2 | None) -> dict[str, Any]:
    """The interrupt's payload: plain data, so that any face can show it."""
    held = state.held
    assert held is not None
    return Proposal(
        instruction=state.instruction,
        goal=state.agenda[-1],
        thought=placing_thought(state.goal, held, point),
        plan=held.plan,
        motion="place",
        words=putting(state.goal, held),
        point=None if args.kind in FIXED else point,
    ).model_dump(mode="json")


def _elsewhere(state: State, point: Vec2, context: AgentContext) -> Update:
    """The person's place, if something can be put there; else the question comes again."""
    goal, placement = state.goal, state.goal.placement
    if placement is None or placement.kind in FIXED:
        return Update(consent=True)
    # What was asked for first does not count any more: the person has put the place in numbers.
    wanted = goal.model_copy(update={"placement": Placement(kind="aside", point=point)})
    goals = changed(state, wanted)
    found = _place(place_args(_with(state, goals)), context)
    if found is None or math.dist(found, point) > NEAR:
        text = "That place is not free or out of my reach; I ask again."
        context.emit(events.Thought(text=text, goal=state.current))
        return Update(consent=False)
    return Update(goals=goals, consent=True)


def _with(state: State, goals: tuple[Any, ...]) -> State:
    from dataclasses import replace

    return replace(state, goals=goals)
