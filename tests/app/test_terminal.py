"""`ragvlm chat` on a real terminal (tmux): references, questions, Ctrl-C, why, what-if, undo, and a motion that waits.

Kills are in tests/graph/test_kill_chat.py.
"""

from __future__ import annotations

import os
import re
import select
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(shutil.which("tmux") is None, reason="tmux is not installed"),
]

ROOT = Path(__file__).parents[2]
ESCAPES = re.compile(r"\x1b\[[0-?]*[ -/]*[@-~]|\x1b\][^\x07]*\x07|\x1b[@-Z\\-_=>]|[\r\x07]")
PATIENCE_S = 60.0
"""How long a loaded machine may take to say something [s]."""


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


@pytest.fixture
def pane(tmp_path: Path) -> Iterator[Pane]:
    """A terminal."""
    shown = Pane(tmp_path)
    yield shown
    shown.close()


def test_a_whole_session_in_a_terminal(pane: Pane, tmp_path: Path) -> None:
    """What product and issue promise of the terminal, once, in the order a person would do it."""
    home = tmp_path / "home"
    start = (
        f"cd {ROOT} && RAGVLM_HOME={home} XDG_STATE_HOME={home} OMP_NUM_THREADS=1 {sys.executable} -m app chat "
        "--scene repeated_categories --seed 10001 --perception oracle --thread t"
    )
    pane.type(start)
    pane.expect(r"scene repeated_categories, seed 10001")
    pane.type("pick up the block")
    pane.expect(r"Question +Which one do you mean")
    pane.type("the left one")
    pane.expect(r"Answer +I hold the")
    pane.type("put it back")
    pane.expect(r"Answer +I put the \S+ back")
    pane.type("now the other one")
    pane.expect(r"Action +(?:place_object|execute_grasp)")
    pane.press("C-c")
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
