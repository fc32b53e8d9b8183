"""Every tool works called as a function and as a LangChain tool, with equal results."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from agent import build_agent
from agent.toolbox import TOOLS, as_langchain, tool_named, toolbox
from kb.errors import BadInputError
from kb.sensing import Evidence
from tools.context import ToolContext
from tools.experience.recipe import category_plans


@pytest.fixture(scope="module")
def facts() -> dict[str, Any]:
    """Arguments for every tool, gathered by one run on a cube, and the agent that made it."""
    agent = build_agent("single_cube", 10_001, perception="oracle")
    agent.run("pick up the cube")
    state = agent.state
    attempt, percept = state.attempts[-1], state.attempts[-1].percept
    assert percept is not None
    target = attempt.target
    evidence = Evidence(sensing=attempt.sensing)
    return {
        "agent": agent,
        "start": attempt.before,
        "held": state.world,
        "perceive": {"look": 0},
        "retrieve_haarag": {"category": target.category, "affordance": target.affordance, "embedding": target.embedding},
        "build_scene_graph": {"percept": percept, "target": target.id},
        "infer_constraints": {"graph": state.graph, "target": target.id},
        "plan_grasp": {"percept": percept, "target": target.id, "constraints": attempt.constraints},
        "execute_grasp": {"plan": attempt.plan, "percept": percept, "target": target.id},
        "classify_failure": {
            "plan": attempt.plan, "evidence": evidence, "constraints": attempt.constraints, "target": target,
            "percept": percept,
        },
        "correct_grasp": {"failure": "SLIP", "level": 1, "plan": attempt.plan, "evidence": evidence},
        "place_object": {"percept": percept, "held": attempt.plan, "object": target, "kind": "side", "side": "left"},
        "choose_grasp": {"plan": attempt.plan, "percept": percept, "changes": {"force": attempt.plan.grasp.force * 0.9}},
        "confirm_grasp": {
            "plan": attempt.plan, "object": target, "percept": percept, "constraints": attempt.constraints,
        },
        "name_objects": {
            "percept": percept,
            "seen": {"objects": [{
                "id": target.id, "category": "block", "affordance": "GRASPABLE_BODY", "material": "wood",
                "fragility": 0.1, "region": "body",
            }]},
        },
        "gather_experience": {
            "category": "cube", "model": "wood_cube", "id": "cube-90", "first_seed": 90,
            "recipe": category_plans()[[plan.category for plan in category_plans()].index("cube")].recipes[0],
        },
    }  # fmt: skip


def context_for(name: str, facts: dict[str, Any]) -> ToolContext:
    """A context with a fresh generator, and the world where the tool needs it."""
    agent = facts["agent"]
    agent.opened.restore(facts["held"] if name in ("place_object", "confirm_grasp") else facts["start"])
    return dataclasses.replace(agent.context.tools, rng=np.random.default_rng(3))


@pytest.mark.parametrize("name", TOOLS)
def test_function_and_langchain_tool_agree(name: str, facts: dict[str, Any]) -> None:
    """The verb called with its model and the LangChain tool called with plain JSON give the same value."""
    tool = tool_named(name)
    args = tool.args.model_validate(facts[name])
    direct = tool.verb(args, context_for(name, facts))
    wrapped = as_langchain(name, context_for(name, facts))
    message = wrapped.invoke({"name": name, "args": args.model_dump(mode="json"), "id": "call-1", "type": "tool_call"})
    assert message.artifact == direct
    assert json.loads(message.content) == json.loads(direct.model_dump_json())


def test_every_tool_file_is_in_the_box() -> None:
    """A tool's file name is its function name, and each one that has an argument model is offered."""
    folder = Path(__file__).parents[2] / "tools"
    offered = {
        path.stem for path in folder.glob("*.py") if f"def {path.stem}(args: " in path.read_text(encoding="utf-8")
    }
    assert set(TOOLS) == offered


def test_schemas_and_descriptions() -> None:
    """A language model is given a sentence and a JSON schema of the arguments."""
    for tool in toolbox(ToolContext()):
        assert tool.description.endswith(".")
        assert tool_named(tool.name).schema()["properties"]


def test_unknown_tools_are_bad_input() -> None:
    """The error lists the tools."""
    with pytest.raises(BadInputError, match="perceive"):
        tool_named("teleport")
