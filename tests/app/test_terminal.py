"""`ragvlm chat` on a real terminal: references, questions, Ctrl-C, why, what-if, undo, a kill, and bad input.

The whole session is driven through tmux where that is installed (Debian's package tmux), else on a pty of our own. Kills at
random points are in tests/graph/test_kill_chat.py.
"""

from __future__ import annotations

import os
import re
import select
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from bench.chat_faces import ESCAPES, PROMPT, PtyChat

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
PATIENCE_S = 60.0
"""How long a loaded machine may take to say something [s]."""
WHOLE = ("--scene", "repeated_categories", "--seed", "10001", "--perception", "oracle", "--thread", "t")


class Pane:
    """A tmux session of its own; what it shows comes through a pipe, so that waiting needs no polling."""

    def __init__(self, folder: Path) -> None:
        self._socket, self._fifo = f"ragvlm-{os.getpid()}", folder / "shown"
        os.mkfifo(self._fifo)
        self._tmux("new-session", "-d", "-x", "150", "-y", "50", "env", "PS1=$ ", "sh")
        self._tmux("pipe-pane", "-o", f"cat > {self._fifo}")
        self._read = os.open(self._fifo, os.O_RDONLY)
        self.text, self._seen = "", 0

    def _tmux(self, *words: str) -> None:
        subprocess.run(["tmux", "-L", self._socket, *words], check=True, capture_output=True)

    def type(self, line: str) -> None:
        """Types a line and presses Enter."""
        self._tmux("send-keys", "-l", line)
        self._tmux("send-keys", "Enter")

    def press(self, key: str) -> None:
        """Presses one key."""
        self._tmux("send-keys", key)

    def expect(self, pattern: str) -> str:
        """Waits until the pattern is shown after what was expected last; returns what it matched."""
        end = time.monotonic() + PATIENCE_S
        while (found := re.compile(pattern).search(self.text, self._seen)) is None:
            ready, _, _ = select.select([self._read], [], [], max(0.0, end - time.monotonic()))
            assert ready, f"{pattern!r} did not come; shown was:\n{self._tail()}"
            self.text += ESCAPES.sub("", os.read(self._read, 65536).decode("utf-8", "replace"))
        self._seen = found.end()
        return found[0]

    def _tail(self) -> str:
        return "\n".join([line for line in self.text.splitlines() if line.strip()][-40:])

    def close(self) -> None:
        """Ends the session with everything in it."""
        subprocess.run(["tmux", "-L", self._socket, "kill-server"], check=False, capture_output=True)
        os.close(self._read)


class TmuxChat(Pane):
    """`ragvlm chat` in tmux."""

    def __init__(self, home: Path, *options: str) -> None:
        super().__init__(home)
        self.type(
            f"cd {ROOT} && RAGVLM_HOME={home} XDG_STATE_HOME={home} OMP_NUM_THREADS=1 {sys.executable} -m app chat "
            + " ".join(options)
        )

    def press(self, keys: str) -> None:
        """Presses Ctrl-C."""
        assert keys == chr(3)
        self._tmux("send-keys", "C-c")


@pytest.fixture
def chat(tmp_path: Path) -> Iterator[Callable[..., PtyChat]]:
    """Opens chats on terminals of their own; all are closed in the end."""
    opened: list[PtyChat] = []

    def on_a_terminal(*options: str, **more: str) -> PtyChat:
        opened.append(PtyChat(tmp_path, *options, **more))
        return opened[-1]

    yield on_a_terminal
    for one in opened:
        one.close()


def test_a_whole_session_in_a_terminal(tmp_path: Path) -> None:
    """What product and issue promise of the terminal, once, in the order a person would do it."""
    pane = (TmuxChat if shutil.which("tmux") else PtyChat)(tmp_path, *WHOLE)
    try:
        _whole_session(pane)
    finally:
        pane.close()


def _whole_session(pane: Pane | PtyChat) -> None:
    pane.expect(r"scene repeated_categories, seed 10001")
    pane.type("pick up the block")
    pane.expect(r"Question +Which one do you mean")
    pane.type("the left one")
    pane.expect(r"Answer +I hold the")
    pane.type("put it back")
    pane.expect(r"Answer +I put the \S+ back")
    pane.type("now the other one")
    pane.expect(r"Action +(?:place_object|execute_grasp)")
    pane.press(chr(3))
    pane.expect(r"stopped: I hold still until /release")
    pane.expect(r"Stopped +I am stopped")
    pane.type("/release")
    pane.expect(r"released: I can move again")
    pane.type("go on")
    pane.expect(r"Answer +.*I hold the|Answer +I put|Answer +I could not")
    pane.type("/why")
    pane.expect(r"Why +")
    pane.expect(r"earlier success|trials succeeded")
    pane.type("/whatif force=4")
    pane.expect(r"What if +Simulated with force 4 N")
    pane.expect(r"side by side: \S*whatif-1\.png")
    pane.type("/undo")
    pane.expect(r"Answer +I put the \S+ back|Answer +")
    pane.type("/approve on")
    pane.expect(r"approval on")
    pane.type("pick up the left block")
    pane.expect(r"Approve\? +May I do this\?")
    pane.type("y")
    pane.expect(r"Answer +I hold the")
    pane.type("put it on the left")
    pane.expect(r"Approve\? +May I put the block on the left\?")
    pane.type("/edit x=2000")
    pane.expect(r"Error +x: 2000 mm is off the table \(valid: 300 to 750 mm\)")
    pane.type("no")
    pane.expect(r"Answer +I could not")


def test_a_killed_chat_goes_on_where_it_waited(chat: Callable[..., PtyChat]) -> None:
    """After kill -9 while a motion waits: words, memory, world and the waiting motion are there, and can be approved."""
    options = ("--scene", "single_cube", "--seed", "10003", "--perception", "oracle", "--thread", "k")
    first = chat(*options)
    first.expect(PROMPT)
    first.type("pick up the cube")
    first.expect(r"Answer +I hold the cube")
    first.type("/approve on")
    first.expect("approval on")
    first.type("put it on the left")
    first.expect(r"May I put the cube on the left\?")
    first.kill()
    second = chat("--thread", "k", "--perception", "oracle")
    second.expect("scene single_cube, seed 10003")
    second.expect("you: pick up the cube")
    second.expect('a motion waits for your word: "put it on the left", put the cube on the left')
    second.type("/memory")
    second.expect("waits for your word first")
    second.type("yes")
    second.expect(r"Answer +I put the cube on the left")
    second.type("/memory")
    second.expect(r"cube")
    second.type("/why")
    second.expect(r"The observer saw success")


@pytest.mark.long
def test_a_chat_killed_at_twenty_moments_can_be_taken_up(chat: Callable[..., PtyChat], tmp_path: Path) -> None:
    """After each kill -9 at a random moment of a turn `/resume` ends it; in the end every word and every deed is there."""
    from agent.chat import Conversation

    rng, said = np.random.default_rng(3), list[str]()
    options = ("--scene", "single_cube", "--seed", "10003", "--perception", "oracle", "--thread", "r")
    for number in range(20):
        one = chat(*options)
        one.expect(PROMPT)
        if "was cut off" in one.text:
            one.type("/resume")
            one.expect(r"Answer +")
            one.expect(PROMPT)
        said.append("pick up the cube" if number % 2 == 0 else "put it back")
        one.type(said[-1])
        one.expect(r"Goal +")
        one.idle(float(rng.uniform(0.0, 1.5)))
        one.kill()
    with Conversation.open(thread="r", threads=tmp_path / "threads.sqlite", perception="oracle") as talk:
        if talk.unfinished is not None:
            list(talk.resume())
        assert [text for who, text in talk.messages if who == "person"] == said
        assert len(talk.state.attempts) == 10
        assert all(attempt.claimed for attempt in talk.state.attempts)
        assert talk.state.held is None


def test_bad_input_costs_a_line_and_nothing_else(chat: Callable[..., PtyChat]) -> None:
    """A typo names the nearest command; a huge paste, HTML and escape sequences do nothing; a second process is refused."""
    one = chat("--scene", "single_cube", "--seed", "10003", "--perception", "oracle", "--thread", "b")
    one.expect(PROMPT)
    one.type("/wy")
    one.expect('there is no command "/wy"; did you mean /why')
    one.expect(PROMPT)
    one.press("hm")  # what is typed stands in the line: the terminal takes keys one by one again
    one.expect("hm")
    one.press(f"\x1b[200~{'x' * 1_000_000}\x1b[201~")
    one.expect("error: 1000000 characters were pasted; an instruction has at most 10,000")
    one.press("\x7f\x7f\x1b[200~<b>what</b> do you see\x1b]0;title\x07\x1b[2J\x00\x1b[201~\r")
    one.expect("<b>what</b> do you see")
    one.expect(r"Answer +I did not understand")
    assert "\x1b]0;title" not in one.raw
    assert "\x1b[2J" not in one.raw.partition("<b>what</b>")[2]
    other = chat("--thread", "b")
    other.expect(rf"session 'b' is open in another process \(pid {one.process.pid}\)")
    assert other.process.wait(20) == 3
    one.type("what do you see")
    one.expect(r"Answer +I see an orange cube")


def test_a_dumb_terminal_is_talked_with_line_by_line(chat: Callable[..., PtyChat]) -> None:
    """With TERM=dumb no escape sequence is written; questions, slash commands and leaving work."""
    one = chat("--scene", "single_cube", "--seed", "10003", "--perception", "oracle", term="dumb")
    one.expect("you> ")
    one.press("what do you see\n")
    one.expect(r"Answer +I see an orange cube")
    one.press("/quit\n")
    assert one.process.wait(20) == 0
    assert "\x1b" not in one.raw


def test_ctrl_c_right_after_enter_stops_and_does_not_leave(chat: Callable[..., PtyChat]) -> None:
    """At any moment from Enter on, also while a release waits for the end of the turn, Ctrl-C stops the robot only."""
    one = chat("--scene", "single_cube", "--seed", "10003", "--perception", "oracle")
    one.expect(PROMPT)
    for words, wait in (("pick up the cube", 0.0), ("put it back", 0.02), ("pick up the cube", 0.1)):
        one.type(words)
        one.idle(wait)
        one.press("\x03")
        one.expect(r"stopped: I hold still")
        one.type("/release")
        one.expect(r"released")
    assert one.process.poll() is None
