"""The conversation in a pipe: commands, errors that do not end it, exit codes, inert output, and what is saved."""

from __future__ import annotations

import io
import json
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from agent.chat.events import Asked, Finished, Noted, Refused, WhatIf
from agent.events import Answer, BaseStep
from agent.state import State
from app.chat.changes import changes_of
from app.chat.slash import COMMANDS, NAMES, command_of
from app.command_line import run_command_line
from kb.errors import BadInputError
from kb.grasp import Grasp, Quality
from kb.run_result import GoalRecord, RunResult
from kb.sensing import Plan

PLAN = Plan(
    grasp=Grasp(position=(0.5, 0, 0.1), approach=(0, 0, -1), yaw=0, aperture=0.05, force=9, type="power"),
    provenance={}, quality=Quality(q=0.9, phi=(1,) * 7), region="body", target="obj_0", candidate="c",
)  # fmt: skip


def result_of(words: str, *, success: bool = True, question: str | None = None) -> RunResult:
    """A result without motions."""
    return RunResult(
        instruction=words, scene="s", seed=0, configuration="full", brain="rules", perception="rgbd", evaluator="mujoco",
        executed=False, success=success, answer="yes", question=question,
        goals=(GoalRecord(kind="look", target=None, object=None, success=success, verdict=None),),
    )  # fmt: skip


class FakeConversation:
    """Repeats what it hears; "fail" fails, "which" asks back, "wait" waits for approval."""

    def __init__(self, options: Any, thread: str | None) -> None:
        if options.scene == "nowhere":
            raise BadInputError("there is no scene 'nowhere'", choices=("single_cup",))
        self.heard: list[str] = []
        world = SimpleNamespace(recorders=[], index=SimpleNamespace(sensors={}))
        self.agent = SimpleNamespace(thread=thread, opened=SimpleNamespace(world=world, motions=0))
        self.agent.context = SimpleNamespace(scene=options.scene or "single_cup")
        self.folder, self.state = None, State()
        self.place, self.asks, self.stopped = f"scene {options.scene}, seed 0", options.approve, False
        self.messages: tuple[tuple[str, str], ...] = ()
        self.pending = self.unfinished = None

    def say(self, words: str) -> Iterator[BaseStep]:
        """One answer."""
        self.heard.append(words)
        if words == "wait":
            yield Asked(text="May I do this?", plan=PLAN)
            return
        if words == "bad":
            yield Refused(text="not that", code=2)
            return
        yield Answer(text=f"You said {words}.")
        question = "Which one?" if words == "which" else None
        yield Finished(
            text="", result=result_of(words, success=words != "fail" and question is None, question=question)
        )

    def _noted(self, what: str) -> Iterator[BaseStep]:
        self.heard.append(what)
        yield Noted(text=what)
        yield Finished(text="", result=result_of(what))

    def why(self, attempt: int | None = None) -> Iterator[BaseStep]:
        """As `Conversation.why`."""
        return self._noted(f"why {attempt}")

    def compare(self, *numbers: int) -> Iterator[BaseStep]:
        """As `Conversation.compare`."""
        return self._noted(f"compare {numbers}")

    def whatif(self, **changes: Any) -> Iterator[BaseStep]:
        """As `Conversation.whatif`."""
        self.heard.append(f"whatif {changes}")
        yield WhatIf(text="it would have held", pictures="side.png")
        yield Finished(text="", result=result_of("what if"))

    def change_scene(self, scene: str, seed: int | None) -> Iterator[BaseStep]:
        """As `Conversation.change_scene`."""
        return self._noted(f"scene {scene} {seed}")

    def undo(self) -> Iterator[BaseStep]:
        """As `Conversation.undo`."""
        return self.say("undo")

    def stop(self) -> None:
        """Latches."""
        self.stopped = True

    def release(self) -> None:
        """Lets go."""
        self.stopped = False

    def close(self) -> None:
        """Nothing is held."""


@pytest.fixture
def talk(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    """Types lines into `ragvlm chat` and returns the exit code, the output, and the conversation."""
    opened: list[FakeConversation] = []

    def opening(options: Any, thread: str | None) -> FakeConversation:
        opened.append(FakeConversation(options, thread))
        return opened[-1]

    monkeypatch.setattr("app.chat.converse.open_conversation", opening)

    def type_lines(*lines: str, options: tuple[str, ...] = ()) -> tuple[int, str, FakeConversation]:
        monkeypatch.setattr("sys.stdin", io.StringIO("".join(line + "\n" for line in lines)))
        code = run_command_line(["chat", *options])
        return code, capsys.readouterr().out, opened[-1]

    return type_lines


def test_lines_are_told_until_the_input_ends(talk) -> None:
    """Every line that is no command is heard, in order; empty lines are passed over; all is well, so the code is 0."""
    code, said, conversation = talk("what do you see", "", "pick up the cup")
    assert (code, conversation.heard) == (0, ["what do you see", "pick up the cup"])
    assert "You said pick up the cup." in said


def test_the_exit_code_is_that_of_the_worst_line(talk) -> None:
    """1 for a failed goal, 2 for what could not be used; a question counts only if nothing answers it."""
    assert talk("one", "fail", "two")[0] == 1
    assert talk("bad", "fail")[0] == 2
    assert talk("which", "the left one")[0] == 0
    assert talk("one", "which")[0] == 1
    assert talk("wait")[0] == 1


def test_an_error_does_not_end_the_conversation(talk) -> None:
    """Unknown commands and bad arguments are answered in one line each; the next line is heard."""
    code, said, conversation = talk(
        "/dance", "/approve maybe", "/whatif lots", "/save", "/scene a b", "/why x", "/back", "/sessions fly", "hello"
    )
    assert code == 2
    assert said.count("error: ") == 8
    assert conversation.heard == ["hello"]


def test_slash_commands_use_the_conversation(talk) -> None:
    """Attempts are counted from 1 by people and from 0 by the robot; lengths in mm, angles in degrees."""
    _, said, conversation = talk(
        "/why",
        "/why 2",
        "/compare 1 3",
        "/whatif force=4 aperture=60",
        "/whatif 6",
        "/undo",
        "/scene single_cube 7",
        "/scene",
    )
    assert conversation.heard == [
        "why None", "why 1", "compare (0, 2)", "whatif {'force': 4.0, 'aperture': 0.06}", "whatif {'force': 6.0}", "undo",
        "scene single_cube 7", "what do you see",
    ]  # fmt: skip
    assert "side.png" in said


def test_the_stop_latches_until_it_is_released(talk) -> None:
    """`/stop` presses, nothing releases by itself, `/release` does."""
    assert talk("/stop", "hello")[2].stopped
    assert not talk("/stop", "/release")[2].stopped


def test_the_nearest_command_is_suggested(talk) -> None:
    """A typo names the nearest command, a beginning that fits one is enough, one that fits two names both."""
    for typo, meant in (
        ("/wy", "/why"),
        ("/mermory", "/memory"),
        ("/undoo", "/undo"),
        ("/HELPP", "/help"),
        ("/re", "/re"),
    ):
        with pytest.raises(BadInputError, match=f"did you mean {meant}"):
            command_of(typo)
    assert command_of("/und x") == ("/undo", "x")
    assert command_of("/WHY 2") == ("/why", "2")


def test_help_lists_every_command(talk) -> None:
    """All commands and the robot's own help."""
    _, said, conversation = talk("/help")
    assert conversation.heard == ["help"]
    assert all(name in said for name in COMMANDS)
    assert len(NAMES) == len(set(NAMES)) == len(COMMANDS)


def test_approval_can_be_switched(talk) -> None:
    """`/approve on` asks from then on; with the option it asks from the beginning."""
    assert talk("/approve on")[2].asks
    assert talk("hello", options=("--approve",))[2].asks
    assert not talk("/approve on", "/approve off")[2].asks


@pytest.mark.parametrize("word", ["/quit", "quit", "exit", "bye", "Goodbye!"])
def test_quit_leaves_at_once(talk, word: str) -> None:
    """What follows is not heard; one who does not know the command leaves with a plain word."""
    code, _, conversation = talk(word, "never")
    assert (code, conversation.heard) == (0, [])


def test_what_is_typed_cannot_steer_the_terminal(talk) -> None:
    """Escape sequences, control characters and direction marks are gone from the output; HTML is plain text."""
    _, said, _ = talk("\x1b[31mred\x1b]0;title\x07\x00\u202e <b>bold</b> [bold]rich[/bold]")
    assert "\x1b" not in said
    assert "\x00" not in said
    assert "\u202e" not in said
    assert "<b>bold</b> [bold]rich[/bold]" in said


def test_save_writes_all_results(talk, tmp_path: Path) -> None:
    """A JSON list with one result a turn."""
    target = tmp_path / "talk.json"
    talk("one", "two", f"/save {target}")
    assert [row["instruction"] for row in json.loads(target.read_text())] == ["one", "two"]


def test_options_reach_the_conversation(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """What is given on the command line is what the conversation is opened with, for the terminal and the page alike."""
    from app import open_conversation as module
    from app.options import RunOptions

    given: dict[str, Any] = {}

    def opening(*places: Any, **options: Any) -> SimpleNamespace:
        given.update(options, places=places)
        return SimpleNamespace()

    monkeypatch.setattr(module.LearningConversation, "open", opening)
    options = RunOptions(scene="s", seed=4, kb="base.jsonl", embedder="clip:x", brain_pictures=False, approve=True)
    module.open_conversation(options, "t")
    assert given["places"] == ("s", 4)
    assert (given["store"], given["embedder"], given["learn"]) == ("base.jsonl", "clip:x", False)
    assert (given["thread"], given["asks"], given["brain_pictures"]) == ("t", True, False)
    talk = module.open_conversation(RunOptions(learn=True, kb=str(tmp_path / "learning")), None)
    assert given["store"] is talk.learner.store


def test_changes_are_read_with_their_units() -> None:
    """Millimetres, degrees and newtons without a unit; with one, that; free wording as in a sentence."""
    read = changes_of("aperture=6cm yaw=90deg force=4 N type=Pinch", where="x")
    assert read == {"aperture": 0.06, "yaw": pytest.approx(1.5708, abs=1e-4), "force": 4.0, "type": "pinch"}
    assert changes_of("by the rim", where="x") == {"region": "rim"}
    assert changes_of("yaw=1rad attempt=2", where="x") == {"yaw": 1.0, "attempt": 1}
    for bad in ("", "force=nan", "force=x", "colour=red", "dance"):
        with pytest.raises(BadInputError):
            changes_of(bad, where="x")
