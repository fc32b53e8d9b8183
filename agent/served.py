"""The task graph for LangGraph's own tools (`langgraph.json`): the same wiring, with a context made of plain settings.

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
"""What `langgraph.json` names; the server brings its own checkpointer."""
