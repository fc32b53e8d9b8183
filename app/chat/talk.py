"""One line of the person at a time: an utterance goes to the robot, a slash command does what it says."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.chat.changes import changes_of
from app.chat.looking_back import LookingBack
from app.chat.printing import ChatPrinter
from app.chat.session_commands import sessions_command
from app.chat.slash import COMMANDS, command_of
from app.exit_codes import ACHIEVED, NOT_ACHIEVED
from app.files import refuse_unwritable_file, write_atomically
from kb.errors import BadInputError, RagVlmError

if TYPE_CHECKING:
    from rich.console import Console

    from agent.chat import Conversation
    from kb.run_result import RunResult


LEAVING = ("quit", "exit", "bye", "goodbye")
"""What a person types to leave who has not read that it is /quit."""


class Talk:
    """The terminal's side of a conversation."""

    def __init__(self, conversation: Conversation, console: Console, threads: Path | None = None) -> None:
        """Args: what is talked with, where it is printed, and the file that keeps threads."""
        self.conversation = conversation
        self.printer = ChatPrinter(console)
        self.code = ACHIEVED
        """Exit code of the last line."""
        self.asked = False
        """Whether the robot asked something back and waits for the next line."""
        self._threads = threads
        self._looking_back = LookingBack(conversation)
        self._results: list[RunResult] = []
        c = conversation
        self._commands: dict[str, Callable[[str], Any]] = {
            "/help": self._help,
            "/scene": self._scene,
            "/approve": self._approve,
            "/reject": lambda _: self._run(c.reject()),
            "/edit": lambda rest: self._run(c.edit(**changes_of(rest, where="/edit"))),
            "/why": lambda rest: self._run(c.why(_number(rest, "/why") if rest else None)),
            "/whatif": lambda rest: self._run(c.whatif(**changes_of(rest, where="/whatif"))),
            "/compare": self._compare,
            "/memory": self._memory,
            "/remember": lambda _: self._run(c.remember()),
            "/report": lambda _: self._run(c.report()),
            "/undo": lambda _: self._run(c.undo()),
            "/stop": lambda _: self._stop(),
            "/release": lambda _: self._release(),
            "/resume": lambda _: self._run(c.resume() if c.unfinished else iter(())) or self._nothing_to_resume(),
            "/history": self._history,
            "/back": self._back,
            "/sessions": lambda rest: sessions_command(rest, self.printer.say, self._threads, c.agent.thread),
            "/save": self._save,
        }

    def hear(self, line: str) -> bool:
        """Handles one line; False if the person leaves. Errors of one line do not end the conversation."""
        self.code, self.asked = ACHIEVED, False
        text = line.strip()
        if not text:
            return True
        try:
            if text.lower().rstrip(".!") in LEAVING and self.conversation.pending is None:
                return False
            if not text.startswith("/"):
                self._run(self.conversation.say(line))
                return True
            name, rest = command_of(text)
            if name == "/quit":
                return False
            self._commands[name](rest)
        except RagVlmError as error:
            self.code = error.exit_code
            self.printer.say(f"error: {error}")
        return True

    def catch_up(self) -> None:
        """Deals with what was said while a command was at work and came too late for it."""
        self._run(self.conversation.unheard())

    def _run(self, events: Iterator[Any]) -> int:
        """Shows the events of a turn; returns how many there were."""
        count = 0
        self._looking_back.begin()
        for event in events:
            count += 1
            self._looking_back.on_step(event)
            self.printer.show(event)
            for line in self._looking_back.lines_of(event):
                self.printer.say(line)
            if event.kind == "finished":
                self._results.append(event.result)
                self.code = ACHIEVED if event.result.success else NOT_ACHIEVED
                self.asked = event.result.question is not None
            elif event.kind == "asked":
                self.code, self.asked = NOT_ACHIEVED, True
            elif event.kind == "refused":
                self.code = event.code
        return count

    def _help(self, _rest: str) -> None:
        self._run(self.conversation.say("help"))
        for name, what in COMMANDS.items():
            self.printer.say(f"{name:<28} {what}")

    def _scene(self, rest: str) -> None:
        if not rest:
            self._run(self.conversation.say("what do you see"))
            return
        name, _, seed = rest.partition(" ")
        if seed and not seed.strip().isdecimal():
            raise BadInputError(f'"{seed.strip()}" is no seed', where="/scene", choices=("0, 1, 2, ...",))
        self._run(self.conversation.change_scene(name, int(seed) if seed else None))

    def _approve(self, rest: str) -> None:
        if not rest and self.conversation.pending is not None:
            self._run(self.conversation.approve())
            return
        if rest not in ("on", "off"):
            what = f'"{rest}" is not a choice' if rest else "nothing waits for approval"
            raise BadInputError(what, where="/approve", choices=("on", "off"))
        self.conversation.asks = rest == "on"
        self.printer.say(f"approval {rest}: I {'ask before every motion' if rest == 'on' else 'move without asking'}")

    def _compare(self, rest: str) -> None:
        numbers = [_number(part, "/compare") for part in rest.replace(",", " ").split() if part not in ("and", "with")]
        if len(numbers) > 2:
            raise BadInputError("it compares two attempts", where="/compare", choices=("/compare 1 2",))
        self._run(self.conversation.compare(*numbers))

    def _memory(self, rest: str) -> None:
        word, _, category = rest.partition(" ")
        if word == "forget":
            self._run(self.conversation.forget(category.strip() or None))
        elif word:
            raise BadInputError(f'"{word}" is not a choice', where="/memory", choices=("/memory", "/memory forget"))
        else:
            self._run(self.conversation.recall())

    def _stop(self) -> None:
        self.conversation.stop()
        self.printer.say("stopped: nothing moves until /release", "bold red")

    def _release(self) -> None:
        was = self.conversation.stopped
        self.conversation.release()
        self.printer.say("released: I can move again; nothing moves by itself" if was else "I was not stopped")

    def _nothing_to_resume(self) -> None:
        self.printer.say("there is nothing to go on with")

    def _history(self, rest: str) -> None:
        many = _number(rest, "/history") + 1 if rest else 30
        for point in self.conversation.history(many):
            here = "*" if point.current else " "
            what = f"before {point.next}" if point.next else "turn ended"
            self.printer.say(f"{here} {point.id}  turn {point.turn + 1:>3}  {what:<22} {point.said[:60]}")
        self.printer.say("go back with /back STEP; a beginning of the step that fits one only is enough")

    def _back(self, rest: str) -> None:
        if not rest:
            raise BadInputError("it needs a step; /history lists them", where="/back")
        self.conversation.fork(rest)
        self._looking_back.again()
        self.printer.say(f"gone back; I am in {self.conversation.place}")
        left = self.conversation.unfinished
        if left is not None:
            self.printer.say(f'unfinished here: "{left}"; /resume goes on with it')

    def _save(self, rest: str) -> None:
        if not rest:
            raise BadInputError("it needs a file", where="/save")
        path = Path(rest).expanduser()
        refuse_unwritable_file(path, where="/save")
        rows = [json.loads(result.model_dump_json()) for result in self._results]
        write_atomically(path, json.dumps(rows, indent=2) + "\n")
        self.printer.say(f"{len(rows)} results in {path}")


def _number(text: str, where: str) -> int:
    """The number of an attempt: people count from 1."""
    if not text.isdecimal() or int(text) < 1:
        raise BadInputError(f'"{text[:40]}" is no number', where=where, choices=("1, 2, 3, ...",))
    return int(text) - 1
