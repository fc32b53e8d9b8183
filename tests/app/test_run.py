"""`ragvlm run`: exit codes, what goes to which stream, and that results are written for 0, 1 and 130."""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from agent.events import Action, Answer, BaseStep, Observation, Thought, Understood
from app.command_line import run_command_line
from kb.run_result import GoalRecord, RunResult

STEPS: tuple[BaseStep, ...] = (
    Understood(text="Pick up the cup."),
    Thought(text="The cup is fragile, so gently."),
    Action(text="execute_grasp on obj_0.", tool="execute_grasp"),
    Observation(text="I hold it: carried 0.300 kg.", claimed=True),
    Answer(text="I hold the cup."),
)


class FakeAgent:
    """Says its steps and returns a prepared result; can be told to do something on the way."""

    def __init__(self, success: bool, on_the_way: Callable[[FakeAgent], None] | None = None) -> None:
        self.success = success
        self.on_the_way = on_the_way
        self.stopped = False
        self.interrupted = None
        self.result: RunResult | None = None
        self.views: tuple[Any, ...] = ()
        self.opened = SimpleNamespace(scene="single_cup", seed=0, world=None)

    def stream(self, words: str) -> Iterator[BaseStep]:
        """All steps, then the result."""
        for number, step in enumerate(STEPS):
            yield step
            if number == 2 and self.on_the_way is not None:
                self.on_the_way(self)
        goal = GoalRecord(kind="pick", target="obj_0", object="cup", success=self.success, claimed=True, verdict=None)
        self.result = RunResult(
            instruction=words, scene="single_cup", seed=0, configuration="full", brain="rules", perception="rgbd",
            evaluator="mujoco", executed=True, success=self.success, answer="I hold the cup.", goals=(goal,),
        )  # fmt: skip

    def stop(self) -> None:
        """Remembers that it was stopped."""
        self.stopped = True


@pytest.fixture
def agent(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> FakeAgent:
    """The agent that `build_agent` returns in the test; change it before running."""
    fake = FakeAgent(success=True)
    monkeypatch.setattr("agent.build_agent", lambda **_options: fake)
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    return fake


@pytest.mark.parametrize(("success", "code"), [(True, 0), (False, 1)])
def test_the_exit_code_is_the_observers_word(
    agent: FakeAgent, success: bool, code: int, capsys: pytest.CaptureFixture[str]
) -> None:
    """The agent claims success both times; only the observer's success gives 0."""
    agent.success = success
    assert run_command_line(["run", "pick up the cup"]) == code
    assert ("observed success" if success else "observed no success") in capsys.readouterr().out


def test_steps_come_in_order_with_their_labels(agent: FakeAgent, capsys: pytest.CaptureFixture[str]) -> None:
    """Thought, Action and Observation stand in front of their sentences, uncoloured in a pipe."""
    run_command_line(["run", "pick up the cup"])
    said = capsys.readouterr()
    lines = said.out.splitlines()
    labels = [line.split()[0] for line in lines[: len(STEPS)]]
    assert labels == ["Goal", "Thought", "Action", "Observation", "Answer"]
    assert "\x1b" not in said.out
    assert said.err == ""


def test_json_on_standard_output_stands_alone(agent: FakeAgent, capsys: pytest.CaptureFixture[str]) -> None:
    """With `--json -` standard output is one JSON document and the steps are on standard error."""
    run_command_line(["run", "pick up the cup", "--json", "-"])
    said = capsys.readouterr()
    assert RunResult.model_validate_json(said.out).instruction == "pick up the cup"
    assert "Thought" in said.err


@pytest.mark.parametrize("success", [True, False])
def test_a_result_is_written_for_success_and_failure(agent: FakeAgent, success: bool, tmp_path: Path) -> None:
    """The file holds the very result, and nothing else is left beside it."""
    agent.success = success
    target = tmp_path / "out" / "result.json"
    target.parent.mkdir()
    run_command_line(["run", "pick up the cup", "--json", str(target)])
    assert json.loads(target.read_text())["success"] is success
    assert [path.name for path in target.parent.iterdir()] == ["result.json"]


def test_ctrl_c_stops_the_robot_saves_the_result_and_gives_130(agent: FakeAgent, tmp_path: Path) -> None:
    """An interrupt during a motion presses the robot's stop; the run ends by itself and is saved."""
    agent.success = False
    stopped: list[bool] = []

    def press(robot: FakeAgent) -> None:
        os.kill(os.getpid(), signal.SIGINT)
        stopped.append(robot.stopped)

    agent.on_the_way = press
    target = tmp_path / "result.json"
    assert run_command_line(["run", "pick up the cup", "--json", str(target)]) == 130
    assert stopped == [True]
    assert json.loads(target.read_text())["success"] is False


def test_a_second_ctrl_c_leaves_at_once(agent: FakeAgent, tmp_path: Path) -> None:
    """It gives 130 too."""

    def press_twice(_robot: FakeAgent) -> None:
        os.kill(os.getpid(), signal.SIGINT)
        os.kill(os.getpid(), signal.SIGINT)

    agent.on_the_way = press_twice
    assert run_command_line(["run", "pick up the cup"]) == 130
    assert agent.stopped


def test_an_error_of_the_program_is_one_line_and_a_log(
    agent: FakeAgent, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Exit 70, one line that names the log, the traceback in it, and no half-written result."""

    def break_down(_robot: FakeAgent) -> None:
        raise ZeroDivisionError("a defect\nof two lines")

    agent.on_the_way = break_down
    target = tmp_path / "result.json"
    assert run_command_line(["run", "pick up the cup", "--json", str(target)]) == 70
    said = capsys.readouterr().err
    assert len(said.splitlines()) == 1
    assert "ZeroDivisionError: a defect of two lines" in said
    assert "break_down" in (tmp_path / "state" / "ragvlm" / "errors.log").read_text()
    assert not target.exists()


def test_options_reach_the_agent_under_their_names(agent: FakeAgent, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is given on the command line is what the agent is built with; scene and seed are left to it if not given."""
    given: dict[str, Any] = {}

    def build(**options: Any) -> FakeAgent:
        given.update(options)
        return agent

    monkeypatch.setattr("agent.build_agent", build)
    run_command_line(["run", "x", "--perception", "oracle", "--dry-run", "--thread", "t", "--evaluator", "analytic"])
    assert (given["perception"], given["dry_run"], given["thread"], given["evaluator"]) == (
        "oracle", True, "t", "analytic",
    )  # fmt: skip
    assert (given["scene"], given["seed"], given["approve"]) == (None, None, None)
