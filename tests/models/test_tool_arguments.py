"""Arguments of tools, written by a tiny random Qwen3-VL that was shown a picture, and read as the typed values they stand for."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from agent.brain import UnusableReplyError
from agent.brains.chat import Message, Prompt, Reply
from agent.brains.model import ModelBrain
from agent.brains.replies import MAX_TOKENS, ThinkReply, parse, schema_of
from agent.build_agent import build_agent
from agent.toolbox import as_langchain, tool_named
from kb.grasp import MAX_APERTURE, MAX_FORCE
from kb.percept import Percept
from kb.vocabulary import UNKNOWN_CATEGORY
from tests.brain_fixtures import GOOD
from tests.models.test_hf_brain import folder as folder
from tests.models.test_hf_brain import one_thread as one_thread
from tests.models.test_hf_brain import picture
from tools.choose_grasp import Choice, ChooseArgs
from tools.context import ToolContext

pytestmark = pytest.mark.models


@pytest.fixture(scope="module", params=["weights=fp32", "weights=nf4"])
def chat(request: pytest.FixtureRequest, folder: Path) -> Any:
    """The model, whole and in NF4."""
    from agent.brains.hf_chat import open_hf_chat

    return open_hf_chat(f"{folder}?{request.param}")


class Acting:
    """Lets the model decide about grasps only, and always act: what it writes then are the arguments of `choose_grasp`."""

    name, sees = "hf:tiny", True

    def __init__(self, chat: Any, **bounds: Any) -> None:
        self._chat, self._bounds = chat, bounds
        self.prompts: list[Prompt] = []

    def reply(self, prompt: Prompt) -> Reply:
        """The model's reply within the bounds, or a scripted one to other questions."""
        if prompt.role != "think":
            return Reply(GOOD[prompt.role])
        self.prompts.append(prompt)
        properties = prompt.schema["properties"]
        narrow = {name: properties[name] | bound for name, bound in self._bounds.items()}
        acting = properties | {"choice": {"enum": ["act"]}} | narrow
        return self._chat.reply(replace(prompt, schema=prompt.schema | {"properties": acting}, seconds=300.0))


@pytest.mark.parametrize(
    "bounds",
    [
        {"candidate": {"maximum": 0}, "force_n": {"minimum": 5, "maximum": 9}},
        {"candidate": {"minimum": 1, "maximum": 1}, "opening_mm": {"minimum": 70}, "speed_percent": {"minimum": 20}},
        {"candidate": {"minimum": 9}},
        {"force_n": {"minimum": 70}},
        {
            "candidate": {"maximum": 0},
            "force_n": {"maximum": 0},
            "opening_mm": {"maximum": 0},
            "speed_percent": {"minimum": 50, "maximum": 80},
        },
    ],
    ids=["weaker", "rival", "absent", "strongest", "slower"],
)
def test_what_the_model_writes_is_what_the_tool_is_given(
    chat: Any, bounds: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Candidate, force, opening and speed in the reply's units are those of the typed arguments in SI units, and only what
    differs from the plan is a change; an absent candidate never reaches the tool; what comes out is within the hand's
    limits, or refused with a reason. The model saw the marked picture."""
    given: list[tuple[ChooseArgs, Choice]] = []
    from agent import ask_brain

    choose = ask_brain.choose_grasp

    def watched(args: ChooseArgs, context: ToolContext) -> Choice:
        choice = choose(args, context)
        given.append((args, choice))
        return choice

    monkeypatch.setattr(ask_brain, "choose_grasp", watched)
    acting = Acting(chat, **bounds)
    agent = build_agent("single_cube", 10_001, brain=ModelBrain(acting), perception="oracle", dry_run=True)
    steps: list[Any] = []
    agent.run("pick up the cube", steps.append)
    assert acting.prompts[0].messages[1].pictures
    exchanges = [step.exchange for step in steps if step.kind == "model_call" and step.exchange.role == "think"]
    replies = [parse(exchange.reply, ThinkReply) for exchange in exchanges]
    assert len(replies) == len(acting.prompts) >= 1
    plan = next(step.plan for step in steps if step.kind == "planned")
    candidates = (None, *(name for _, _, name in plan.alternatives))
    known = [reply for reply in replies if reply.candidate < len(candidates)]
    # In the end the rules may have to decide; theirs is the plan as it is.
    if any(step.kind == "fallback" for step in steps):
        assert given.pop()[0].changes == {}
    assert len(given) == len(known)
    for reply, (args, choice) in zip(known, given, strict=True):
        assert args.candidate == candidates[reply.candidate]
        told = {"force": reply.force_n, "aperture": reply.opening_mm / 1000, "speed": reply.speed_percent / 100}
        assert all(args.changes[field] == told[field] for field in args.changes)
        assert {field for field, value in told.items() if value} >= set(args.changes)
        if choice.plan is None:
            assert choice.refused
        else:
            assert 0.0 < choice.plan.grasp.force <= MAX_FORCE
            assert 0.0 < choice.plan.grasp.aperture <= MAX_APERTURE
            for field, value in args.changes.items():
                assert getattr(choice.plan.grasp, field) == pytest.approx(value)
    if "maximum" in bounds.get("speed_percent", {}):
        assert given[-1][1].plan is not None
        assert set(given[-1][0].changes) == {"speed"}
    if "minimum" in bounds.get("candidate", {}) and len(candidates) <= bounds["candidate"]["minimum"]:
        assert not given
        assert any("there is no candidate" in step.reason for step in steps if step.kind == "reply_refused")
    if "minimum" in bounds.get("force_n", {}):
        assert all("force" in args.changes for args, _ in given)


def test_a_call_of_a_tool_is_made_from_its_own_schema(chat: Any) -> None:
    """A model bound to a tool's JSON schema writes a call that LangChain's form of the tool takes and carries out: it looks,
    and asks the knowledge base for a category and an affordance out of their vocabularies."""
    agent = build_agent("single_cube", 10_001, perception="oracle")
    context = replace(agent.context.tools, rng=np.random.default_rng(3))
    seen = call(chat, "perceive", {"look": {"type": "integer", "minimum": 0, "maximum": 9}})
    message = as_langchain("perceive", context).invoke(seen)
    assert isinstance(message.artifact, Percept)
    assert message.artifact.look == seen["args"]["look"]
    own = tool_named("retrieve_haarag").schema()
    wanted = {name: own["properties"][name] for name in ("category", "affordance")}
    wanted["category"] = {"enum": ["cup", "vase", UNKNOWN_CATEGORY]}
    asked = call(chat, "retrieve_haarag", wanted, own.get("$defs", {}))
    message = as_langchain("retrieve_haarag", context).invoke(asked)
    funnel = message.artifact.funnel
    assert funnel.total >= funnel.level1 >= funnel.level2 >= funnel.level3
    assert json.loads(message.content) == json.loads(message.artifact.model_dump_json())


def call(chat: Any, name: str, arguments: dict[str, Any], defs: dict[str, Any] | None = None) -> dict[str, Any]:
    """A call of a tool as the model writes it."""
    inner = {"type": "object", "properties": arguments, "required": list(arguments), "additionalProperties": False}
    both = {"name": {"const": name}, "arguments": inner}
    schema = {"type": "object", "properties": both, "required": list(both), "additionalProperties": False}
    user = Message("user", f"Call {name}: {tool_named(name).summary}", (picture(1),))
    got = chat.reply(
        Prompt("call", (Message("system", "You call tools."), user), schema | {"$defs": defs or {}}, 200, 300.0)
    )
    row = json.loads(got.text)
    assert row["name"] == name
    return {"name": name, "args": row["arguments"], "id": "call-1", "type": "tool_call"}


def test_arguments_that_end_too_early_are_refused(chat: Any) -> None:
    """Cut off at any length, arguments are no arguments: nothing is guessed of what is missing."""
    user = Message("user", "See?", (picture(2),))
    whole = chat.reply(Prompt("think", (user,), schema_of(ThinkReply), MAX_TOKENS[ThinkReply], 300.0)).text
    assert isinstance(parse(whole, ThinkReply), ThinkReply)
    for end in range(0, len(whole), 7):
        with pytest.raises(UnusableReplyError):
            parse(whole[:end], ThinkReply)
    short = chat.reply(Prompt("think", (user,), schema_of(ThinkReply), 12, 300.0)).text
    with pytest.raises(UnusableReplyError):
        parse(short, ThinkReply)
