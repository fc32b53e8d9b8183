"""Ctrl-C and SIGTERM: the first stops the robot and lets the run end properly, a second Ctrl-C leaves at once."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable
from types import FrameType

SIGNALS = (signal.SIGINT, signal.SIGTERM)


class StopOnInterrupt:
    """While it is active, the signals stop the robot instead of the program."""

    def __init__(self, stop: Callable[[], None], say: Callable[[str], None] = lambda _text: None) -> None:
        """Args: what stops the robot, and who tells the person."""
        self._stop = stop
        self._say = say
        self._former: dict[signal.Signals, object] = {}
        self.pressed = False
        """Whether a signal came."""
        self.terminated = False
        """Whether it was SIGTERM."""

    def __enter__(self) -> StopOnInterrupt:
        if threading.current_thread() is threading.main_thread():
            self._former = {number: signal.signal(number, self._on_signal) for number in SIGNALS}
        return self

    def __exit__(self, *_: object) -> None:
        for number, former in self._former.items():
            signal.signal(number, former)  # type: ignore[arg-type]

    def _on_signal(self, number: int, _frame: FrameType | None) -> None:
        if self.pressed and number == signal.SIGINT:
            raise KeyboardInterrupt
        self.terminated = self.terminated or number == signal.SIGTERM
        if self.pressed:
            return
        self.pressed = True
        self._stop()
        self._say("stopping the robot; press Ctrl-C again to leave at once")
