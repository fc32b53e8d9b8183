"""What `langgraph.json` names works with a server's checkpointer, store and plain settings."""

from __future__ import annotations

import importlib
import json
from pathlib import Path
from typing import Any

import pytest
from langgraph.checkpoint.memory import InMemorySaver
from langgraph.store.memory import InMemoryStore
from langgraph.types import Command

from agent.checkpoint import serializer
from agent.served import Settings

ROOT = Path(__file__).parents[2]


def served(name: str) -> Any:
    """The graph of that name, as a server would load it."""
    path, _, variable = json.loads((ROOT / "langgraph.json").read_text())["graphs"][name].partition(":")
    graph = getattr(importlib.import_module(path.removeprefix("./").removesuffix(".py").replace("/", ".")), variable)
    graph.checkpointer, graph.store = InMemorySaver(serde=serializer()), InMemoryStore()
    return graph


def settings(**options: Any) -> Settings:
    """Quick ones."""
    return Settings(scene="cup_near_vase", seed=10_003, perception="oracle", evaluator="analytic", **options)


@pytest.mark.parametrize("name", ["ragvlm", "ragvlm-chat"])
def test_each_graph_answers(name: str) -> None:
    """An instruction as input comes back as an answer in the messages."""
    graph, config = served(name), {"configurable": {"thread_id": f"answers-{name}"}}
    state = graph.invoke({"instruction": "what do you see?"}, config, context=settings())
    assert "cup" in state["messages"][-1].content


def test_the_conversation_remembers_and_asks() -> None:
    """References reach back over runs of one thread; with `approve` each motion interrupts, a placing too."""
    graph, config = served("ragvlm-chat"), {"configurable": {"thread_id": "talks"}}
    chosen = settings(approve=True)
    state = graph.invoke({"instruction": "pick up the vase"}, config, context=chosen)
    assert state["__interrupt__"][0].value["motion"] == "grasp"
    state = graph.invoke(Command(resume={"verdict": "approve"}), config, context=chosen)
    assert state["held"].category == "vase"
    state = graph.invoke({"instruction": "put it back"}, config, context=chosen)
    assert state["__interrupt__"][0].value["words"] == "put the vase back where it was"
    state = graph.invoke(Command(resume={"verdict": "approve"}), config, context=chosen)
    assert state["held"] is None
    state = graph.invoke({"instruction": "remember that"}, config, context=chosen)
    assert "I will remember" in state["messages"][-1].content
