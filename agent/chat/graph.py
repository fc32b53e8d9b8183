"""The conversational graph: hear -> choose a tool -> use it -> choose again, around the task graph, in the same state."""

from __future__ import annotations

import copy
from collections.abc import Callable
from functools import lru_cache
from typing import Any

from agent.chat import nodes
from agent.context import AgentContext
from agent.graph import wire


def wire_chat(
    schema: type[Any] = AgentContext,
    wrap: Callable[[Callable[..., Any]], Callable[..., Any]] = lambda function: function,
) -> Any:
    """The graph before compilation: the task graph with the conversation around it, and a gate before each motion.

    Args:
        schema: type of the injected context.
        wrap: applied to each node and routing function that reads the context.
    """
    graph = wire(schema, wrap, entry="hear", before_motion="heed", after_answer="next_call")
    for node in (nodes.hear, nodes.next_call, nodes.heed, *nodes.TOOLS.values()):
        graph.add_node(node.__name__, wrap(node))
    graph.add_edge("hear", "next_call")
    graph.add_conditional_edges("next_call", nodes.after_next_call)
    graph.add_conditional_edges("heed", wrap(nodes.after_heed))
    for node in nodes.TOOLS.values():
        graph.add_edge(node.__name__, "next_call")
    return graph


def compile_chat(checkpointer: Any = None, store: Any = None) -> Any:
    """The compiled graph.

    Args:
        checkpointer: a LangGraph checkpointer, or None where a server brings its own.
        store: a LangGraph store for what is kept across conversations.
    """
    graph = copy.copy(_compiled())
    graph.checkpointer, graph.store = checkpointer, store
    return graph


@lru_cache(maxsize=1)
def _compiled() -> Any:
    return wire_chat().compile(name="ragvlm-chat")
