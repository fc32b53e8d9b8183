"""The graphs for LangGraph's own tools (`langgraph.json`): the same wiring, with a context made of plain settings.

A served thread gets its world when its first node runs; from then on the state carries the world's snapshot, so that any
checkpoint can be taken up or forked.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, cast, get_type_hints

from langchain_core.runnables import RunnableConfig
from langgraph.runtime import Runtime

from agent.build_agent import DEFAULT_SCENE, build_agent
from agent.chat.graph import wire_chat
from agent.context import AgentContext
from agent.graph import wire
from agent.state import State
from kb.vocabulary import EvaluatorName, PerceptionName


@dataclass
class Settings:
    """What a client of the server may choose."""

    scene: str = DEFAULT_SCENE
    seed: int = 0
    configuration: str = "full"
    perception: PerceptionName = "rgbd"
    evaluator: EvaluatorName = "mujoco"
    dry_run: bool = False
    approve: bool = False
    """Interrupt before every motion; resume with an `agent.approval.Decision` as plain data."""


_CONTEXTS: dict[str, AgentContext] = {}
"""Thread -> its running world; a process that starts anew opens it again and restores the state's snapshot."""


def context_of(settings: Settings | None, config: RunnableConfig) -> AgentContext:
    """The context of a thread, opened at first use."""
    chosen = settings or Settings()
    thread = str(config.get("configurable", {}).get("thread_id", ""))
    key = f"{thread}:{chosen}"
    if key not in _CONTEXTS:
        _CONTEXTS[key] = build_agent(
            chosen.scene, chosen.seed, configuration=chosen.configuration, perception=chosen.perception,
            evaluator=chosen.evaluator, dry_run=chosen.dry_run,
        ).context  # fmt: skip
        _CONTEXTS[key].approve = chosen.approve
        _CONTEXTS[key].thread = thread or "here"
    return _CONTEXTS[key]


def served(function: Callable[..., Any]) -> Callable[..., Any]:
    """A node or routing function that finds its agent's context by the thread."""

    @functools.wraps(function)
    def called(state: State, runtime: Runtime[Settings], config: RunnableConfig) -> Any:
        return function(state, cast(Any, runtime).override(context=context_of(runtime.context, config)))

    called.__annotations__ = {"state": State, "runtime": Runtime[Settings], "config": RunnableConfig}
    called.__annotations__["return"] = get_type_hints(function)["return"]
    del called.__wrapped__  # pyright: ignore[reportFunctionMemberAccess]
    return called


graph = wire(Settings, served).compile(name="ragvlm")
"""The task graph: one instruction a run. The server brings its own checkpointer."""
chat_graph = wire_chat(Settings, served).compile(name="ragvlm-chat")
"""The conversation around it: references, why, what if, memory (in the server's store)."""
