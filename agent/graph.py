"""The task graph: wiring only. Nodes are in `agent.nodes`, decisions in `agent.routing`."""

from __future__ import annotations

import copy
from collections.abc import Callable
from functools import lru_cache
from typing import Any

from langgraph.graph import StateGraph

from agent import motions, nodes, routing
from agent.context import AgentContext
from agent.simulate import simulate
from agent.state import State


def wire(
    schema: type[Any] = AgentContext,
    wrap: Callable[[Callable[..., Any]], Callable[..., Any]] = lambda function: function,
) -> StateGraph[State, Any, State, State]:
    """The graph before compilation.

    Args:
        schema: type of the injected context.
        wrap: applied to each node and routing function that reads the context.
    """
    graph = StateGraph(State, context_schema=schema)
    for node in (
        nodes.understand, nodes.look, nodes.ground, nodes.retrieve, nodes.build_graph, nodes.constrain, nodes.remove_first,
        nodes.choose, nodes.plan, nodes.look_once_more, nodes.think, nodes.rehearse, motions.approve, motions.act,
        motions.look_after, motions.observe, motions.set_back, motions.reflect, motions.remember, motions.place, nodes.give_up,
        nodes.conclude, nodes.answer, simulate,
    ):  # fmt: skip
        graph.add_node(node.__name__, wrap(node))
    graph.set_entry_point("understand")
    graph.add_conditional_edges("understand", routing.after_understand)
    graph.add_edge("look", "ground")
    graph.add_conditional_edges("ground", wrap(routing.after_ground))
    graph.add_conditional_edges("retrieve", wrap(routing.after_retrieve))
    graph.add_conditional_edges("build_graph", wrap(routing.after_graph))
    graph.add_conditional_edges("constrain", routing.after_constrain)
    graph.add_edge("remove_first", "ground")
    graph.add_conditional_edges("choose", routing.go_on)
    graph.add_conditional_edges("plan", routing.after_plan)
    graph.add_edge("look_once_more", "look")
    graph.add_conditional_edges("think", wrap(routing.after_think))
    graph.add_conditional_edges("rehearse", routing.go_on)
    graph.add_conditional_edges("approve", routing.after_approve)
    graph.add_edge("act", "observe")
    graph.add_conditional_edges("observe", routing.after_observe)
    graph.add_edge("set_back", "look_after")
    graph.add_edge("look_after", "observe")
    graph.add_conditional_edges("reflect", routing.after_reflect)
    graph.add_conditional_edges("remember", routing.after_remember)
    graph.add_conditional_edges("place", routing.go_on)
    graph.add_conditional_edges("give_up", routing.go_on)
    graph.add_conditional_edges("conclude", routing.go_on)
    graph.add_conditional_edges("simulate", routing.go_on)
    graph.add_conditional_edges("answer", routing.at_the_end)
    return graph


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
