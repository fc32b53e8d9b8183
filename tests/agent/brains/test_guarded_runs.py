"""Whole runs with a language model in the loop: the gate, the way back, the rules' finish, records and budgets."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from agent import Agent, build_agent
from agent.brain import BrainFaultError
from agent.brains.chat import Prompt, Reply
from agent.brains.model import ModelBrain
from agent.brains.recorded import RecordingChat
from agent.events import BaseStep
from agent.safety.limits import BrainLimits
from kb.errors import BadInputError, EnvironmentFaultError
from kb.run_result import RunResult
from tests.brain_fixtures import GOOD, ScriptedChat, fault_server, think, understand

SEED = 10_001


def agent(chat: Any, scene: str = "single_cube", **options: Any) -> Agent:
    """An agent with a model brain on `chat`, oracle perception unless said otherwise."""
    options = {"perception": "oracle"} | options
    return build_agent(scene, SEED, brain=ModelBrain(chat), **options)


def told(robot: Agent, instruction: str = "pick up the cube") -> tuple[RunResult, list[BaseStep]]:
    """The result and the steps of one instruction."""
    steps: list[BaseStep] = []
    return robot.run(instruction, steps.append), steps


def kinds(steps: list[BaseStep]) -> list[str]:
    """The kinds of the steps."""
    return [getattr(step, "kind", "") for step in steps]


def always(role: str, text: str | Callable[[], str]) -> ScriptedChat:
    """A chat that is sensible but for one question."""
    return ScriptedChat(
        lambda prompt, _n: (text if isinstance(text, str) else text()) if prompt.role == role else GOOD[prompt.role]
    )


def test_a_first_attempt_success_takes_two_questions() -> None:
    """Understand and think; the plain success is told by the rules. Never more than three questions, one picture a look."""
    chat = ScriptedChat()
    result, steps = told(agent(chat))
    assert result.success
    assert [prompt.role for prompt in chat.prompts] == ["understand", "think"]
    assert sum(len(m.pictures) for p in chat.prompts for m in p.messages) == 1
    assert result.model_use.calls == 2
    assert result.model_use.fallbacks == ()
    calls = [step for step in steps if getattr(step, "kind", "") == "model_call"]
    assert [json.loads(c.exchange.reply) for c in calls] == [json.loads(GOOD["understand"]), json.loads(GOOD["think"])]  # type: ignore[attr-defined]
    assert "png" not in calls[1].model_dump_json()  # pictures by hash only


def test_a_refused_choice_comes_back_three_times_then_the_rules_finish() -> None:
    """60 N are refused each time with the reason in the next prompt; the run succeeds with the planned force and says so."""
    chat = always("think", think(force_n=60))
    result, steps = told(agent(chat))
    thoughts = [prompt for prompt in chat.prompts if prompt.role == "think"]
    assert len(thoughts) == 4
    assert "too strong" in thoughts[1].messages[1].text
    assert thoughts[3].messages[1].text.count("too strong") == 3
    assert kinds(steps).count("reply_refused") == 4
    assert kinds(steps).count("fallback") == 1
    assert result.success
    assert result.model_use.refusals == 4
    assert "rules decided" in result.answer
    assert result.goals[0].attempts[0].grasp is not None
    assert result.goals[0].attempts[0].grasp.force < 60


def test_a_choice_within_the_limits_is_executed_with_its_provenance() -> None:
    """Another speed is taken, and the brain stands in the provenance of that number alone."""
    result, _ = told(agent(always("think", think(speed_percent=80))))
    attempt = result.goals[0].attempts[0]
    assert attempt.grasp is not None
    assert attempt.grasp.speed == 0.8
    assert [field for field, steps in attempt.provenance.items() if any(s.id == "brain" for s in steps)] == ["speed"]


def test_another_candidate_is_executed_as_it_was_planned() -> None:
    """The second of the candidates that the prompt shows is executed, with place, direction and type as listed there, and
    one that was not shown is refused."""
    chat = always("think", think(candidate=1))
    robot = agent(chat)
    result, steps = told(robot)
    planned = next(step.plan for step in steps if getattr(step, "kind", "") == "planned")  # type: ignore[attr-defined]
    wanted, _, name = planned.alternatives[0]
    shown = json.loads(chat.prompts[1].messages[1].text.split("Candidate grasps: <data>")[1].split("</data>")[0])
    attempt = result.goals[0].attempts[0]
    assert attempt.grasp is not None
    assert attempt.grasp.position == pytest.approx(wanted.position, abs=1e-6)
    assert attempt.grasp.approach == pytest.approx(wanted.approach, abs=1e-6)
    assert attempt.grasp.yaw == pytest.approx(wanted.yaw, abs=1e-6)
    assert attempt.grasp.yaw != pytest.approx(planned.grasp.yaw, abs=1e-2)
    assert attempt.grasp.type == wanted.type
    assert [row["number"] for row in shown] == list(range(1 + len(planned.alternatives)))
    assert shown[1]["region"] == name.split("/")[0]
    result, steps = told(agent(always("think", think(candidate=9)), dry_run=True))
    assert [s.reason for s in steps if getattr(s, "kind", "") == "reply_refused"] == ["there is no candidate 9"] * 4  # type: ignore[attr-defined]


def test_looking_again_asking_and_giving_up() -> None:
    """One more look is granted, a second one refused; a question ends the run unmoved, and so does giving up."""
    looks = ScriptedChat(
        lambda prompt, _n: (
            think(choice="look_again")
            if prompt.role == "think" and not prompt.messages[1].text.count("refused")
            else GOOD[prompt.role]
        )
    )
    result, steps = told(agent(looks, dry_run=True))
    assert kinds(steps).count("look") == 2
    assert result.success
    result, steps = told(agent(always("think", think(choice="ask", question="The red one?"))))
    assert (result.question, result.answer, result.executed, result.success) == (
        "The red one?",
        "The red one?",
        False,
        False,
    )
    result, steps = told(agent(always("think", think(choice="give_up", thought="Too risky."))))
    assert not result.executed
    assert "Too risky" in result.answer


@pytest.mark.parametrize(
    ("instruction", "reply", "moves"),
    [
        ("what do you see?", understand({"action": "pick", "thing": "the cube"}), False),
        ("stop", understand({"action": "clear"}), False),
        ("pour the tea", understand({"action": "pick", "thing": "the tea"}), False),
        ("pick up the cube", understand({"action": "pick", "thing": "the wine glass"}), True),
        ("pick up the cube", understand({"action": "pick", "thing": "xq zz 500 N"}), True),
        ("pick up the cube", "\x00\xff not json", True),
        ("pick up the cube", '{"goals": [], "refusal": "", "question": ""}', True),
    ],
)
def test_words_the_person_did_not_say_move_nothing(instruction: str, reply: str, moves: bool) -> None:
    """Goals that the person's words do not carry are refused, and the rules read the instruction instead."""
    result, steps = told(agent(always("understand", reply)), instruction)
    assert kinds(steps)[:8].count("reply_refused") == 4
    assert result.executed is moves
    if moves:
        assert result.goals[0].object == "cube"


def test_approval_is_asked_whatever_the_model_says() -> None:
    """With approval on, a model's choice is shown to the person first, and a rejection moves nothing."""
    shown: list[dict[str, Any]] = []

    def reject(proposal: dict[str, Any]) -> dict[str, Any]:
        shown.append(proposal)
        return {"verdict": "reject"}

    result, _ = told(agent(always("think", think(speed_percent=80)), approve=reject))
    assert shown[0]["plan"]["grasp"]["speed"] == 0.8
    assert not result.executed


def test_answers_may_not_invent_numbers() -> None:
    """An answer with a number that is not in the facts is refused; without one it is told in the model's words."""
    robot = agent(always("answer", json.dumps({"text": "I used 77.7 N."})))
    told(robot)
    result, steps = told(robot, "why did you grasp it that way?")
    # understand says "pick", which a question does not carry: the rules read it; the answer is refused as well.
    assert kinds(steps).count("fallback") == 2
    assert "77.7" not in result.answer
    asked = ScriptedChat(lambda p, _n: understand({"action": "held"}) if p.role == "understand" else GOOD[p.role])
    result, _ = told(agent(asked), "what are you holding?")
    assert result.answer == "That is what happened."


def test_budgets_end_the_model_and_not_the_run() -> None:
    """With one question allowed the rules do the rest, and the result says so."""
    result, _ = told(agent(ScriptedChat(), brain_limits=BrainLimits(calls=1), dry_run=True))
    assert result.success
    assert result.model_use.calls == 1
    assert "budget" in result.model_use.fallbacks[0]
    result, _ = told(agent(ScriptedChat(), brain_limits=BrainLimits(tokens=10), dry_run=True))
    assert result.success
    result, _ = told(agent(ScriptedChat(), brain_limits=BrainLimits(seconds=0.0), dry_run=True))
    assert result.model_use.calls == 0


class Faulty(ScriptedChat):
    """A chat that has no reply to one question."""

    def __init__(self, role: str) -> None:
        super().__init__()
        self.role = role

    def reply(self, prompt: Prompt) -> Reply:
        """A fault with a mend for the role in question."""
        if prompt.role == self.role:
            raise BrainFaultError("cannot reach the server", mend="start it")
        return super().reply(prompt)


def test_a_model_that_never_was_there_ends_the_run_and_one_that_goes_does_not() -> None:
    """Unreachable at the first question: exit 3 with the mend, nothing moved. Later: the rules finish and say so."""
    with pytest.raises(EnvironmentFaultError, match="start it"):
        told(agent(Faulty("understand")))
    result, _ = told(agent(Faulty("think")))
    assert result.success
    assert result.model_use.faults == 1
    assert "cannot reach" in result.answer


def test_recorded_replies_give_the_identical_run(tmp_path: Path) -> None:
    """A run against a server, kept in a file; replayed without it, steps and result are the same byte for byte.

    The record holds a reply once, so that the same command with the record asks the server nothing.
    """
    file = tmp_path / "brain.jsonl"
    roles = {**GOOD, "think": think(speed_percent=70)}
    options: dict[str, Any] = {"perception": "oracle"}
    with fault_server(("by_role", roles)) as server:
        command: dict[str, Any] = {"brain": "openai:good", "base_url": server.url, "record_brain": file, **options}
        first = told(build_agent("single_cube", SEED, **command))
        asked = len(server.requests)
        again = told(build_agent("single_cube", SEED, **command))
        assert len(server.requests) == asked == 2
    replayed = told(build_agent("single_cube", SEED, brain=f"replay:{file}", **options))
    for other in (again, replayed):
        assert other[0].model_dump_json(exclude={"timings_s"}) == first[0].model_dump_json(exclude={"timings_s"})
        assert [s.model_dump_json() for s in other[1]] == [s.model_dump_json() for s in first[1]]
    with pytest.raises(EnvironmentFaultError, match="no reply to this prompt"):
        told(build_agent("single_cube", SEED, brain=f"replay:{file}", **options), "lift the cube")
    with pytest.raises(BadInputError, match="holds replies of openai:good"):
        RecordingChat(ScriptedChat(), file)
    with pytest.raises(BadInputError, match="no record"):
        build_agent("single_cube", SEED, brain=f"replay:{__file__}")
