"""`--perception vlm` in whole runs, and what a step costs besides the model."""

from __future__ import annotations

import json
import time
from typing import Any

from agent import build_agent
from agent.brains.model import ModelBrain
from tests.brain_fixtures import GOOD, ScriptedChat, understand

CUBE = {
    "mark": 0, "category": "cube", "affordance": "GRASPABLE_BODY", "material": "wood", "fragility": 1, "region": "body",
    "state": "empty",
}  # fmt: skip


def seeing(**changes: Any) -> ScriptedChat:
    """A chat that names the only mark."""
    reply = json.dumps({"objects": [CUBE | changes], "relations": []})
    return ScriptedChat(lambda prompt, _n: reply if prompt.role == "perceive" else GOOD[prompt.role])


def test_names_come_from_the_model_and_places_from_depth() -> None:
    """Both marked pictures go out once a look; the percept is labelled, three questions suffice, and the grasp succeeds."""
    chat, steps = seeing(), []
    robot = build_agent("single_cube", 10_001, brain=ModelBrain(chat), perception="vlm")
    result = robot.run("pick up the cube", steps.append)
    assert result.success
    assert result.perception == "vlm"
    assert [prompt.role for prompt in chat.prompts] == ["understand", "perceive", "think"]
    assert [len(m.pictures) for p in chat.prompts for m in p.messages] == [0, 0, 0, 2, 0, 0]
    look = next(step for step in steps if getattr(step, "kind", "") == "look")
    assert look.percept.perception == "vlm"  # type: ignore[attr-defined]
    assert result.model_use.contradictions == 0


def test_a_lie_about_what_is_sure_is_dropped_and_counted() -> None:
    """A cube called a wine glass stays a cube, the contradiction is counted, and the run goes on."""
    robot = build_agent(
        "single_cube", 10_001, brain=ModelBrain(seeing(category="wine_glass")), perception="vlm", dry_run=True
    )
    result = robot.run("pick up the cube")
    assert result.model_use.contradictions == 1
    assert result.goals[0].object == "cube"


def test_marks_that_are_not_there_are_refused() -> None:
    """Mark 7 does not exist: refused four times, then the measured names stand."""
    robot = build_agent("single_cube", 10_001, brain=ModelBrain(seeing(mark=7)), perception="vlm", dry_run=True)
    result = robot.run("pick up the cube")
    assert result.model_use.refusals == 4
    assert "there is no mark 7" in result.model_use.fallbacks[0]
    assert result.success


def test_graph_gate_and_prompts_cost_at_most_50_ms_a_step() -> None:
    """Processor time of the brain's stages without the model's own, per question (pictures drawn and packed included)."""
    cup = understand({"action": "pick", "thing": "the cup"})
    chat = ScriptedChat(lambda prompt, _n: cup if prompt.role == "understand" else GOOD[prompt.role])
    robot = build_agent("cup_near_vase", 10_001, brain=ModelBrain(chat), perception="oracle", dry_run=True)
    robot.context.clock = time.process_time
    robot.run("pick up the cup")  # everything is imported and compiled now
    asked = len(chat.prompts)
    result = robot.run("pick up the cup")
    assert result.timings_s.brain / (len(chat.prompts) - asked) <= 0.05
