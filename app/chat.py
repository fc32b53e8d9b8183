"""A conversation with the robot in the terminal: history, completion, slash commands, Ctrl-C stops the robot first."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from app.console import make_console
from app.exit_codes import ACHIEVED, INTERRUPTED
from app.files import refuse_unwritable_file, write_atomically
from app.interrupts import StopOnInterrupt
from app.running import check_instruction
from app.session import Session
from app.steps import StepPrinter
from app.verdict_block import print_verdict
from kb.errors import BadInputError, RagVlmError

if TYPE_CHECKING:
    from app.options import RunOptions
    from kb.run_result import RunResult

PROMPT = "you> "
COMMANDS: dict[str, str] = {
    "/help": "what can be said, and these commands",
    "/scene [NAME|FILE] [SEED]": "another scene (the conversation starts again), or what is seen now",
    "/approve on|off": "ask before every motion, or do not",
    "/why": "why the last grasp was chosen",
    "/whatif FORCE": "what would have happened with another force [N], by simulating it",
    "/memory": "what the robot remembers of this conversation",
    "/undo": "put it back",
    "/stop": "let go of nothing, move nothing more",
    "/save FILE": "write the results of this conversation as JSON",
    "/quit": "leave (so does Ctrl-D)",
}
"""Slash command with its arguments -> what it does."""


def chat(options: RunOptions) -> int:
    """Talks until the person leaves; returns the exit code."""
    talk = Conversation(options)
    try:
        return talk.run(read_lines())
    finally:
        talk.close()


def read_lines() -> Iterator[str]:
    """What the person types: with history and completion on a terminal, plain lines otherwise.

    Yields an empty line for Ctrl-C at the prompt.
    """
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        for line in sys.stdin:
            # Nobody sees what was typed in a pipe; the transcript must be readable all the same.
            print(PROMPT + line.rstrip("\n"), flush=True)
            yield line.rstrip("\n")
        return
    from prompt_toolkit import PromptSession
    from prompt_toolkit.auto_suggest import AutoSuggestFromHistory
    from prompt_toolkit.completion import WordCompleter

    prompt: PromptSession[str] = PromptSession(
        history=_history(),
        auto_suggest=AutoSuggestFromHistory(),
        completer=WordCompleter([name.split()[0] for name in COMMANDS], sentence=True),
    )
    pressed = 0
    while True:
        try:
            line = prompt.prompt(PROMPT)
            pressed = 0
            yield line
        except EOFError:
            return
        except KeyboardInterrupt:
            pressed += 1
            if pressed == 2:
                raise
            print("Ctrl-C again or /quit leaves", file=sys.stderr)


def _history():
    """The history file in the state folder; in memory where that cannot be written."""
    from prompt_toolkit.history import FileHistory, InMemoryHistory

    folder = Path(os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state") / "ragvlm"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "chat_history").touch()
    except OSError:
        return InMemoryHistory()
    return FileHistory(str(folder / "chat_history"))


class Conversation:
    """One person, one robot, one scene at a time."""

    def __init__(self, options: RunOptions) -> None:
        self._options = options
        self._console = make_console()
        self._session = Session(options, may_ask=True)
        self._results: list[RunResult] = []
        self._commands: dict[str, Callable[[str], bool]] = {
            "/help": self._help,
            "/scene": self._scene,
            "/approve": self._approve,
            "/why": lambda _rest: self._say("why did you grasp it that way"),
            "/whatif": self._what_if,
            "/memory": self._memory,
            "/undo": lambda _rest: self._say("undo"),
            "/stop": lambda _rest: self._say("stop"),
            "/save": self._save,
            "/quit": lambda _rest: False,
        }

    def close(self) -> None:
        """Ends the session."""
        self._session.close()

    def run(self, lines: Iterator[str]) -> int:
        """Answers line after line. Errors of one line do not end the conversation."""
        self._print(f"{self._session.place}. Say what the robot is to do; /help helps.")
        try:
            for line in lines:
                if line.strip() and not self._answer(line.strip()):
                    break
        except KeyboardInterrupt:
            return INTERRUPTED
        return ACHIEVED

    def _answer(self, line: str) -> bool:
        """Handles one line; False if the person leaves."""
        try:
            if not line.startswith("/"):
                return self._say(check_instruction(line))
            name, _, rest = line.partition(" ")
            # A beginning that fits one command only is enough.
            fits = [command for command in self._commands if command.startswith(name)] if len(name) > 1 else []
            if name not in self._commands and len(fits) == 1:
                name = fits[0]
            if name not in self._commands:
                raise BadInputError(f'there is no command "{name}"', choices=self._commands)
            return self._commands[name](rest.strip())
        except RagVlmError as error:
            self._print(f"error: {error}")
            return True

    def _say(self, words: str) -> bool:
        """One instruction to the agent."""
        printer = StepPrinter(self._console)
        with StopOnInterrupt(self._session.stop, self._print):
            for step in self._session.stream(words):
                printer.show(step)
        self._session.release()
        result = self._session.result
        self._results.append(result)
        if any(goal.attempts for goal in result.goals):
            print_verdict(self._console, result)
        return True

    def _help(self, _rest: str) -> bool:
        self._say("help")
        for name, what in COMMANDS.items():
            self._print(f"{name:<28}{what}")
        return True

    def _scene(self, rest: str) -> bool:
        if not rest:
            return self._say("what do you see")
        name, _, seed = rest.partition(" ")
        if seed and not seed.strip().isdecimal():
            raise BadInputError(f'"{seed.strip()}" is no seed', where="/scene", choices=("0, 1, 2, ...",))
        changed = replace(self._options, scene=name, seed=int(seed) if seed else self._options.seed)
        # The new scene is opened first: a wrong name leaves the conversation as it is.
        session = Session(changed, may_ask=True)
        self._session.close()
        self._session, self._options = session, changed
        self._print(self._session.place)
        return True

    def _approve(self, rest: str) -> bool:
        if rest not in ("on", "off"):
            raise BadInputError(f'"{rest}" is not a choice', where="/approve", choices=("on", "off"))
        self._session.asks = rest == "on"
        self._print(f"approval {rest}")
        return True

    def _what_if(self, rest: str) -> bool:
        number = rest.removesuffix("N").strip()
        try:
            force = float(number)
        except ValueError:
            raise BadInputError(f'"{rest}" is no force', where="/whatif", choices=("1 to 70 N",)) from None
        return self._say(f"what would have happened with {force:g} N")

    def _memory(self, _rest: str) -> bool:
        items = self._session.memory()
        if not items:
            self._print("nothing yet: I remember what has worked")
        for item in items:
            self._print(
                f"{item.category}: {item.type} at the {item.region}, {item.force:.1f} N, opening "
                f"{item.aperture * 1000:.0f} mm, worked at attempt {item.attempts}"
            )
        return True

    def _save(self, rest: str) -> bool:
        if not rest:
            raise BadInputError("it needs a file", where="/save")
        path = Path(rest).expanduser()
        refuse_unwritable_file(path, where="/save")
        rows = [json.loads(result.model_dump_json()) for result in self._results]
        write_atomically(path, json.dumps(rows, indent=2) + "\n")
        self._print(f"{len(rows)} results in {path}")
        return True

    def _print(self, text: str) -> None:
        self._console.print(text, markup=False)
