"""The task graph: wiring only. Nodes are in `agent.nodes`, decisions in `agent.routing`."""

from __future__ import annotations

import copy
from collections.abc import Callable, Hashable
from functools import lru_cache
from typing import Any, get_args, get_type_hints

from langgraph.graph import StateGraph

from agent import motions, nodes, put_down, routing
from agent.approve_place import approve_place
from agent.context import AgentContext
from agent.simulate import simulate
from agent.state import State


def wire(
    schema: type[Any] = AgentContext,
    wrap: Callable[[Callable[..., Any]], Callable[..., Any]] = lambda function: function,
    *,
    entry: str | None = "understand",
    before_motion: str | None = None,
    after_answer: str | None = None,
) -> StateGraph[State, Any, State, State]:
    """The graph before compilation.

    Args:
        schema: type of the injected context.
        wrap: applied to each node and routing function that reads the context.
        entry: the first node; None leaves that to whoever wires more around this graph.
        before_motion: a node that each way to a motion leads through first; it knows where to go on.
        after_answer: where a turn goes when it has been answered, instead of to the end.
    """
    graph = StateGraph(State, context_schema=schema)
    for node in (
        nodes.understand, nodes.look, nodes.ground, nodes.retrieve, nodes.build_graph, nodes.constrain, nodes.remove_first,
        nodes.choose, nodes.plan, nodes.look_once_more, nodes.think, nodes.rehearse, motions.approve, motions.act,
        motions.look_after, motions.observe, motions.set_back, motions.reflect, motions.remember, approve_place, put_down.place,
        put_down.look_at_placed,
        nodes.give_up, nodes.conclude, nodes.answer, simulate,
    ):  # fmt: skip
        graph.add_node(node.__name__, wrap(node))
    if entry is not None:
        graph.set_entry_point(entry)
    graph.add_conditional_edges("understand", routing.after_understand)
    graph.add_edge("look", "ground")
    graph.add_conditional_edges("ground", wrap(routing.after_ground), _through(routing.after_ground, before_motion))
    graph.add_conditional_edges("retrieve", wrap(routing.after_retrieve))
    graph.add_conditional_edges("build_graph", wrap(routing.after_graph))
    graph.add_conditional_edges("constrain", routing.after_constrain)
    graph.add_edge("remove_first", "ground")
    graph.add_conditional_edges("choose", routing.go_on)
    graph.add_conditional_edges("plan", routing.after_plan)
    graph.add_edge("look_once_more", "look")
    graph.add_conditional_edges("think", wrap(routing.after_think), _through(routing.after_think, before_motion))
    graph.add_conditional_edges("rehearse", routing.go_on)
    graph.add_conditional_edges("approve", routing.after_approve)
    graph.add_edge("act", "observe")
    graph.add_conditional_edges("observe", routing.after_observe)
    graph.add_edge("set_back", "look_after")
    graph.add_edge("look_after", "observe")
    graph.add_conditional_edges("reflect", routing.after_reflect)
    graph.add_conditional_edges(
        "remember", wrap(routing.after_remember), _through(routing.after_remember, before_motion)
    )
    graph.add_conditional_edges("approve_place", routing.after_approve_place)
    graph.add_conditional_edges("place", routing.after_place)
    graph.add_conditional_edges("look_at_placed", routing.after_place)
    graph.add_conditional_edges("give_up", routing.go_on)
    graph.add_conditional_edges("conclude", routing.go_on)
    graph.add_conditional_edges("simulate", routing.go_on)
    if after_answer is None:
        graph.add_conditional_edges("answer", routing.at_the_end)
    else:
        graph.add_edge("answer", after_answer)
    return graph


MOTIONS = ("act", "approve", "place", "approve_place")
"""The nodes with which a motion begins."""


def _through(route: Callable[..., Any], gate: str | None) -> dict[Hashable, str] | None:
    """Where each word of a route leads: motions by way of the gate, everything else to its own node."""
    if gate is None:
        return None
    return {word: gate if word in MOTIONS else word for word in get_args(get_type_hints(route)["return"])}


def compile_graph(checkpointer: Any = None) -> Any:
    """The compiled graph.

    Args:
        checkpointer: a LangGraph checkpointer, or None where the server brings its own.
    """
    graph = copy.copy(_compiled())
    graph.checkpointer = checkpointer
    return graph


@lru_cache(maxsize=1)
def _compiled() -> Any:
    """The graph without a checkpointer, compiled once a process: it holds nothing of a run, and takes 0.1 s to make."""
    return wire().compile(name="ragvlm")
