"""The conversation on a terminal: the prompt stays usable while the robot works, so that it can be steered and stopped."""

from __future__ import annotations

import os
import queue
import signal
import sys
import threading
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.chat.slash import NAMES, command_of
from app.chat.talk import Talk
from app.exit_codes import ACHIEVED, INTERRUPTED
from app.garbage import Garbage
from kb.errors import BadInputError

if TYPE_CHECKING:
    from prompt_toolkit import PromptSession

PROMPT = "you> "
LONGEST_PASTE = 20_000
"""A longer paste is not taken over into the line [characters]; an instruction has at most 10,000."""
LONGEST_REMEMBERED = 2_000
"""Longer lines do not go into the history file."""
SHOWN_WORDS = 240
"""The end of what a model is saying, above the prompt [characters]."""
SWITCH_S = 0.001
"""How long the thread of the motion keeps a key waiting [s]: of the interpreter's 5 ms a stop would take several."""
WHILE_BUSY = ("/stop", "/release", "/quit")
"""Commands that are heard while the robot works; others come after it."""


class Terminal:
    """Reads lines in the main thread while turns run in another."""

    def __init__(self, talk: Talk) -> None:
        self._talk = talk
        self._worker: threading.Thread | None = None
        self._later: queue.SimpleQueue[str] = queue.SimpleQueue()
        self._leaving = False
        self._halted = False
        """Ctrl-C has stopped the robot, and the person has not been told yet."""
        self._late = False
        """Ctrl-C came and the prompt has not returned with it yet."""
        self._released = False
        """The person has released the robot, which counts when the turn has ended; Ctrl-C before that stops again."""
        self._turning = threading.Lock()
        self._busy = False
        self._code = ACHIEVED
        self._failure: BaseException | None = None
        self._garbage = Garbage()
        self._prompt: PromptSession[str] = _prompt_session(self._refuse_paste, self._halt)
        talk.printer.on_words = self._wake

    def run(self) -> int:
        """Talks until the person leaves; returns the exit code."""
        from prompt_toolkit.patch_stdout import patch_stdout

        former = {
            signal.SIGTERM: signal.signal(signal.SIGTERM, self._on_terminate),
            signal.SIGINT: signal.signal(signal.SIGINT, self._on_interrupt),
        }
        patience = sys.getswitchinterval()
        sys.setswitchinterval(SWITCH_S)
        presses = 0
        try:
            with patch_stdout(raw=True):
                while not self._leaving:
                    try:
                        line = self._prompt.prompt(self._label, pre_run=self._begin, handle_sigint=False)
                        presses = 0
                        self._take(line)  # Ctrl-C right after Enter counts as well
                        if self._late:
                            raise KeyboardInterrupt
                    except EOFError:
                        break
                    except KeyboardInterrupt:
                        if not self._interrupted(presses := presses + 1):
                            self._code = INTERRUPTED
                            break
                self._end()
        finally:
            for number, handler in former.items():
                signal.signal(number, handler)
            sys.setswitchinterval(patience)
        if self._failure is not None:
            raise self._failure
        return self._code

    @property
    def busy(self) -> bool:
        """Whether a turn is running."""
        return self._busy

    def _label(self) -> str:
        """The prompt says what the robot is at."""
        if self._talk.conversation.stopped:
            return "stopped> "
        if self.busy:
            # Above a prompt only whole lines are printed: what a model is saying grows on a line of the prompt.
            words = self._talk.printer.words[-SHOWN_WORDS:]
            return f"{words}\nworking> " if words else "working> "
        return "approve> " if self._talk.asked and self._talk.conversation.pending is not None else PROMPT

    def _take(self, line: str) -> None:
        """One line: a turn of its own, or a word to the robot at work."""
        text = line.strip()
        if not text:
            return
        with self._turning:  # a turn that is just ending either hears the line still, or has ended
            begins, self._busy = not self._busy, True
            if not begins:
                self._while_busy(text, line)
        if begins:
            self._worker = threading.Thread(target=self._hear, args=(line,), name="ragvlm-turn", daemon=True)

    def _begin(self) -> None:
        """Begins the turn once the prompt stands: until then a key would wait for it to be drawn."""
        if self._late:
            self._wake()
        worker = self._worker
        if worker is not None and worker.ident is None:
            loop = self._prompt.app.loop
            assert loop is not None
            loop.call_soon(worker.start)

    def _while_busy(self, text: str, line: str) -> None:
        """A line that comes while the robot works."""
        say = self._talk.printer.say
        if not text.startswith("/"):
            self._talk.conversation.steer(text)
            if not self._talk.conversation.stopped:
                say("(heard; I come to it before the next motion, or after this)", "dim")
            return
        try:
            name, _ = command_of(text)
            if name not in WHILE_BUSY:
                self._later.put(line)
                say(f"({name} comes after this)", "dim")
            elif name == "/quit":
                self._leaving = True
            else:
                self._released = name == "/release"
                (self._talk.conversation.release if self._released else self._talk.conversation.stop)()
                say(
                    "stopped: nothing moves until /release" if name == "/stop" else "released when this has ended",
                    "bold red",
                )
        except BadInputError as error:
            say(f"error: {error}")

    def _hear(self, line: str) -> None:
        """Runs in the thread of the turn."""
        try:
            self._leaving = not self._talk.hear(line)
            while not self._leaving and not self._over():
                self._talk.catch_up()
                if not self._later.empty():
                    self._leaving = not self._talk.hear(self._later.get())
        except BaseException as error:
            self._failure, self._leaving = error, True
        self._busy = self._released = False
        self._wake()
        self._garbage.collect()

    def _over(self) -> bool:
        """Whether nothing is left to be heard; from then on a line begins a turn of its own."""
        with self._turning:
            self._busy = not self._later.empty() or self._talk.conversation.has_unheard
            return not self._busy

    def _wake(self) -> None:
        """Draws the prompt anew, or ends it when the person leaves."""
        app = self._prompt.app
        loop = app.loop
        if loop is None or not app.is_running:
            return
        if self._leaving:
            loop.call_soon_threadsafe(_leave, app)
        elif self._late:
            loop.call_soon_threadsafe(_abort, app)
        else:
            app.invalidate()

    def _halt(self, *, late: bool = False) -> None:
        """Ctrl-C as it comes: the robot stops before the prompt is taken down, or, if it is down already, has returned."""
        self._late = self._late or late
        if self.busy and (self._released or not self._talk.conversation.stopped):
            self._talk.conversation.stop()
            self._halted, self._released = True, False

    def _interrupted(self, presses: int) -> bool:
        """Ctrl-C: stops the robot first, leaves the chat second; False to leave."""
        self._halt()
        self._late = False
        if self._halted:
            self._halted = False
            self._talk.printer.say("stopped: I hold still until /release; Ctrl-C again leaves", "bold red")
            return True
        if presses >= 2 or self.busy:
            return False
        self._talk.printer.say("Ctrl-C again or /quit leaves")
        return True

    def _on_interrupt(self, _number: int, _frame: Any) -> None:
        """Ctrl-C while something is printed above the prompt, or between two prompts: a signal, not a key."""
        self._halt(late=True)
        self._wake()

    def _on_terminate(self, _number: int, _frame: Any) -> None:
        """SIGTERM: the robot stops at once, then the chat ends; what was done is saved."""
        self._talk.conversation.stop()
        self._code, self._leaving = INTERRUPTED, True
        self._wake()

    def _end(self) -> None:
        """Leaves nothing moving."""
        if self.busy:
            self._talk.conversation.stop()
            if self._worker is not None and self._worker.ident is not None:
                self._worker.join(10.0)

    def _refuse_paste(self, characters: int) -> None:
        self._talk.printer.say(f"error: {characters} characters were pasted; an instruction has at most 10,000")


def _leave(app: Any) -> None:
    if app.is_running:
        app.exit(exception=EOFError())


def _abort(app: Any) -> None:
    if app.is_running and app.future is not None and not app.is_done:
        app.exit(exception=KeyboardInterrupt(), style="class:aborting")


def _prompt_session(refuse_paste: Any, halt: Any) -> PromptSession[str]:
    from prompt_toolkit import PromptSession
    from prompt_toolkit.auto_suggest import AutoSuggestFromHistory
    from prompt_toolkit.completion import NestedCompleter
    from prompt_toolkit.key_binding import KeyBindings
    from prompt_toolkit.keys import Keys

    from app.completion import scenes

    keys = KeyBindings()

    @keys.add(Keys.BracketedPaste, eager=True)
    def _(event: Any) -> None:
        if len(event.data) > LONGEST_PASTE:
            refuse_paste(len(event.data))
            return
        from agent.chat.heard import heard

        event.current_buffer.insert_text(heard(event.data))

    @keys.add("c-c", eager=True)
    def _(event: Any) -> None:
        halt(late=True)
        _abort(event.app)

    choices: dict[str, Any] = dict.fromkeys(NAMES)
    choices["/scene"] = dict.fromkeys(scenes(""))
    choices["/approve"] = dict.fromkeys(("on", "off"))
    choices["/whatif"] = dict.fromkeys(
        ("force=", "type=", "yaw=", "approach=", "aperture=", "region=", "candidate=other")
    )
    choices["/sessions"] = dict.fromkeys(("delete", "export", "import"))
    return PromptSession(
        history=_history(),
        auto_suggest=AutoSuggestFromHistory(),
        completer=NestedCompleter.from_nested_dict(choices),
        complete_while_typing=False,
        key_bindings=keys,
    )


def _history() -> Any:
    """The history file in the state folder; in memory where that cannot be written."""
    from prompt_toolkit.history import FileHistory, InMemoryHistory

    class Lines(FileHistory):
        """Short lines only: a pasted novel is no command."""

        def store_string(self, string: str) -> None:
            if len(string) <= LONGEST_REMEMBERED:
                try:
                    super().store_string(string)
                except OSError:  # a full disk must not end the conversation
                    return

    folder = Path(os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state") / "ragvlm"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "chat_history").touch()
    except OSError:
        return InMemoryHistory()
    return Lines(str(folder / "chat_history"))
