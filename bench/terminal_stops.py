"""Stops by Ctrl-C at random moments of motions, through a terminal of its own; part of `bench.chat_report`.

Without a clock to follow a motion lasts a sixth of a second, at a time after Enter that differs from machine to machine.
Where it lies is learnt from motions that nothing stopped; the key then comes at a moment drawn evenly from that window.
"""

from __future__ import annotations

import re
import time

import numpy as np

from bench.chat_faces import PROMPT, PtyChat

TURNS = (("pick up the cube",), ("pick up the cube", "put it back"))
"""What is said until the motion that is stopped: every other one is a placing."""
FIRST_SEED = 10001
REMEMBERED = 8
"""Undisturbed motions from which the window is known."""


class TerminalStops:
    """Presses Ctrl-C again and again, each time in a fresh world."""

    def __init__(self, chat: PtyChat, rng: np.random.Generator) -> None:
        """Args: a chat of the program `bench.timed_chat` in the scene single_cube, and what draws the moments."""
        self._chat, self._rng, self._count = chat, rng, 0
        self._windows: list[list[tuple[float, float]]] = [[], []]
        chat.expect(PROMPT)

    def once(self) -> float | None:
        """From the key to the halt of physics [ms]; None where nothing was moving at that moment."""
        kind, seed = self._count % 2, FIRST_SEED + self._count
        self._count += 1
        chat = self._chat
        chat.type(f"/scene single_cube {seed}")
        chat.expect(rf"I am in scene single_cube[\s\S]*?{PROMPT}")
        *before, words = TURNS[kind]
        for earlier in before:
            chat.type(earlier)
            chat.expect(rf"Answer +[\s\S]*?{PROMPT}")
        entered = time.time_ns()
        chat.type(words)
        if not self._windows[kind]:  # the first of its kind is watched only
            chat.expect(rf"Answer +[\s\S]*?{PROMPT}")
            self._learn(kind, entered)
            return None
        begin, end = np.median(self._windows[kind][-REMEMBERED:], axis=0)
        chat.idle(float(self._rng.uniform(begin, end)))
        pressed = time.time_ns()
        chat.press("\x03")
        answer = chat.expect(r"stopped: I hold still|Ctrl-C again or /quit leaves")
        if answer.startswith("Ctrl"):  # the turn was over
            self._learn(kind, entered)
            chat.type("/help")
            chat.expect(r"/quit")
            return None
        chat.type("/release")
        chat.expect(r"released|I was not stopped")
        return self._halted(pressed)

    def _halted(self, pressed: int) -> float | None:
        """What came last after the key is the halt: from then until the release nothing steps the physics."""
        log = self._log()
        moving = [word for word, at in log if at < pressed][-1:] == ["moves"]
        after = [at for _, at in log if at > pressed]
        return (after[-1] - pressed) / 1e6 if moving and after else None

    def _learn(self, kind: int, entered: int) -> None:
        """The window of a motion that nothing stopped [s after Enter]."""
        times = [(at - entered) / 1e9 for _, at in self._log() if at > entered]
        if times:
            self._windows[kind].append((times[0], times[-1]))

    def _log(self) -> list[tuple[str, int]]:
        path = self._chat.home / "halts"
        text = path.read_text(encoding="utf-8") if path.exists() else ""
        return [(word, int(at)) for word, at in re.findall(r"(\w+) (\d+)\n", text)]
