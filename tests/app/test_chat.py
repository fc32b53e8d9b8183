"""The terminal conversation: commands, errors that do not end it, and what is saved."""

from __future__ import annotations

import io
import json
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from agent.events import Answer, Approval, BaseStep
from app.chat import COMMANDS
from app.command_line import run_command_line
from kb.errors import BadInputError
from kb.run_result import GoalRecord, RunResult


class FakeAgent:
    """Answers everything by repeating it."""

    def __init__(self, **options: Any) -> None:
        if options["scene"] == "nowhere":
            raise BadInputError("there is no scene 'nowhere'", choices=("single_cup",))
        self.options = options
        self.heard: list[str] = []
        self.interrupted = None
        self.released = 0
        self.result: RunResult | None = None
        self.opened = SimpleNamespace(scene=options["scene"] or "single_cup", seed=options["seed"] or 0)
        self.state = SimpleNamespace(memory=SimpleNamespace(items=()))

    def stream(self, words: str) -> Iterator[BaseStep]:
        """One question for approval and one answer."""
        self.heard.append(words)
        yield Approval(text="May I do this?")
        yield Answer(text=f"You said {words}.")
        self.result = RunResult(
            instruction=words, scene="s", seed=0, configuration="full", brain="rules", perception="rgbd",
            evaluator="mujoco", executed=False, success=True, answer="yes",
            goals=(GoalRecord(kind="look", target=None, object=None, success=True, verdict=None),),
        )  # fmt: skip

    def stop(self) -> None:
        """Nothing moves anyway."""

    def release(self) -> None:
        """Counts."""
        self.released += 1


@pytest.fixture
def talk(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    """Types lines into `ragvlm chat` and returns the exit code, the output, and the agents that were built."""
    agents: list[FakeAgent] = []

    def build(**options: Any) -> FakeAgent:
        agents.append(FakeAgent(**options))
        return agents[-1]

    monkeypatch.setattr("agent.build_agent", build)

    def type_lines(*lines: str, options: tuple[str, ...] = ()) -> tuple[int, str, list[FakeAgent]]:
        monkeypatch.setattr("sys.stdin", io.StringIO("".join(line + "\n" for line in lines)))
        code = run_command_line(["chat", *options])
        return code, capsys.readouterr().out, agents

    return type_lines


def test_lines_are_told_to_the_agent_until_the_input_ends(talk) -> None:
    """Every line that is not a command reaches the one agent, in order; empty lines are passed over."""
    code, said, agents = talk("what do you see", "", "pick up the cup")
    assert code == 0
    assert len(agents) == 1
    assert agents[0].heard == ["what do you see", "pick up the cup"]
    assert agents[0].released == 2
    assert "You said pick up the cup." in said


def test_an_error_does_not_end_the_conversation(talk) -> None:
    """Unknown commands, bad arguments and bad scenes are answered; the next line is heard by the same agent."""
    code, said, agents = talk(
        "/dance", "/scene nowhere", "/approve maybe", "/whatif lots", "/save", "x" * 10_001, "hello"
    )
    assert code == 0
    assert said.count("error: ") == 6
    assert "/help" in said
    assert agents[-1].heard == ["hello"]


def test_slash_commands_say_what_they_stand_for(talk) -> None:
    """Questions behind commands are ordinary instructions, so the agent answers them from its record."""
    _, _, agents = talk("/why", "/undo", "/stop", "/whatif 6", "/scene")
    assert agents[0].heard == [
        "why did you grasp it that way", "undo", "stop", "what would have happened with 6 N", "what do you see",
    ]  # fmt: skip


def test_the_beginning_of_a_command_is_enough_if_it_fits_one(talk) -> None:
    """`/w` fits /why and /whatif and is refused; `/und` is /undo."""
    _, said, agents = talk("/w", "/und")
    assert said.count("error: ") == 1
    assert agents[0].heard == ["undo"]


def test_help_lists_every_command(talk) -> None:
    """All commands and the agent's own help."""
    _, said, agents = talk("/help")
    assert agents[0].heard == ["help"]
    assert all(name in said for name in COMMANDS)


def test_another_scene_is_another_agent(talk) -> None:
    """`/scene NAME SEED` starts over there; what comes next is heard there."""
    _, said, agents = talk("hello", "/scene single_cube 7", "and now")
    assert [agent.heard for agent in agents] == [["hello"], ["and now"]]
    assert (agents[1].options["scene"], agents[1].options["seed"]) == ("single_cube", 7)
    assert "scene single_cube, seed 7" in said


def test_approval_is_shown_only_while_it_is_on(talk) -> None:
    """Off by default; `/approve on` lets the questions through."""
    _, said, _ = talk("one", "/approve on", "two")
    assert said.count("May I do this?") == 1


def test_quit_leaves_at_once(talk) -> None:
    """What follows is not heard."""
    code, _, agents = talk("/quit", "never")
    assert code == 0
    assert agents[0].heard == []


def test_save_writes_all_results(talk, tmp_path: Path) -> None:
    """A JSON list with one result a turn."""
    target = tmp_path / "talk.json"
    talk("one", "two", f"/save {target}")
    assert [row["instruction"] for row in json.loads(target.read_text())] == ["one", "two"]
