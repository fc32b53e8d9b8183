"""A model's words on the terminal and on the page while they come."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import pytest

from agent.events import Saying, Thought
from app.chat.printing import ChatPrinter
from app.command_line import run_command_line
from app.console import PIPE_WIDTH
from app.steps import StepPrinter
from app.words import LABEL
from tests.brain_fixtures import GOOD, fault_server, think


def printed(*events: Any, printer: type[Any] = StepPrinter) -> str:
    """What a pipe gets."""
    from rich.console import Console

    file = io.StringIO()
    shown = printer(Console(file=file, soft_wrap=True, width=PIPE_WIDTH))
    for event in events:
        shown.show(event)
    return file.getvalue()


def saying(text: str) -> Saying:
    """Words of a thought."""
    return Saying(text=text, role="think")


@pytest.mark.parametrize("printer", [StepPrinter, ChatPrinter])
def test_words_grow_on_a_line_that_the_next_step_ends(printer: type[Any]) -> None:
    """What was shown is not shown again; words that do not go on begin a line; square brackets are no markup."""
    words = [saying(text) for text in ("", "It", "It stands", "It [red]stands[/red] f", "It [red]stands[/red] free.")]
    lines = printed(*words, Thought(text="It stands free."), printer=printer).splitlines()
    assert [line.split(None, 1)[1] for line in lines] == [
        "It stands", "It [red]stands[/red] free.", "It stands free.",
    ]  # fmt: skip
    assert [line.split()[0] for line in lines] == [LABEL, LABEL, "Thought"]


def test_a_line_of_words_that_is_whole_ends_as_any_other() -> None:
    """However the words were cut, the pipe gets the same bytes."""
    text = "It stands free."
    growing = [saying(text[:end]) for end in range(1, len(text) + 1)]
    assert printed(*growing, Thought(text="x")) == printed(saying(text), Thought(text="x"))


def test_a_thought_cannot_steer_the_terminal() -> None:
    """Escape sequences of a judged thought, too, are taken out before it is printed."""
    assert printed(Thought(text="a\x1b[2Jb\x1b]0;title\x07c\u202ed")).split(None, 1)[1].strip() == "abcd"


def test_run_shows_words_and_records_steps(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """`ragvlm run` prints the server's words before the thought that counts; the trace holds the reply, and no words."""
    monkeypatch.setenv("OPENAI_API_KEY", "sk-none")
    replies = GOOD | {"think": think(thought="It stands free, I take it.")}
    with fault_server(("by_role", replies)) as server:
        arguments = [
            "run", "pick up the cube", "--scene", "single_cube", "--seed", "10001", "--evaluator", "analytic",
            "--brain", "openai:good", "--base-url", server.url, "--no-brain-pictures", "--dry-run",
            "--record", str(tmp_path / "trace"),
        ]  # fmt: skip
        run_command_line(arguments)
    lines = [line for line in capsys.readouterr().out.splitlines() if line.startswith((LABEL, "Thought"))]
    assert [line.split(None, 1)[1] for line in lines[-2:]] == ["It stands free, I take it."] * 2
    assert [line.split()[0] for line in lines[-2:]] == [LABEL, "Thought"]
    assert '"saying"' not in next((tmp_path / "trace").glob("*.jsonl")).read_text()


def test_chat_keeps_words_for_its_prompt_until_the_next_step() -> None:
    """The line above the prompt has the words of the moment; the next step clears it."""
    from rich.console import Console

    printer, told = ChatPrinter(Console(file=io.StringIO())), list[str]()
    printer.on_words = lambda: told.append(printer.words)
    for text in ("It", "It stands"):
        printer.show(saying(text))
    assert told == ["It", "It stands"]
    printer.show(Thought(text="It stands."))
    assert printer.words == ""


def test_chat_goes_on_after_refused_replies(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A reply that the gate refuses is a step of the conversation and not a command gone wrong: the rules finish, the exit
    code is that of the outcome."""
    monkeypatch.setenv("OPENAI_API_KEY", "sk-none")
    monkeypatch.setattr("sys.stdin", io.StringIO("kindly hoist that cube skyward, dear machine\npick up the cube\n"))
    with fault_server(("by_role", GOOD | {"think": think(thought="Hard.", force_n=70), "understand": "{}"})) as server:
        arguments = [
            "chat", "--scene", "single_cube", "--seed", "10001", "--evaluator", "analytic", "--brain", "openai:good",
            "--base-url", server.url,
        ]  # fmt: skip
        code = run_command_line(arguments)
    out = capsys.readouterr().out
    assert code == 1  # the first line is beyond the rules
    assert out.count("Refused      Refused (understand)") == 8
    assert out.count("Refused      Refused (think)") == 4
    assert "Answer       I hold the cube" in out
