"""Ctrl-C: the first press stops the robot and lets the run end properly, the second leaves at once."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable
from types import FrameType


class StopOnInterrupt:
    """While it is active, Ctrl-C stops the robot instead of the program."""

    def __init__(self, stop: Callable[[], None], say: Callable[[str], None] = lambda _text: None) -> None:
        """Args: what stops the robot, and who tells the person."""
        self._stop = stop
        self._say = say
        self._former: object = None
        self.pressed = False
        """Whether Ctrl-C was pressed."""

    def __enter__(self) -> StopOnInterrupt:
        if threading.current_thread() is threading.main_thread():
            self._former = signal.signal(signal.SIGINT, self._on_signal)
        return self

    def __exit__(self, *_: object) -> None:
        if self._former is not None:
            signal.signal(signal.SIGINT, self._former)  # type: ignore[arg-type]

    def _on_signal(self, _number: int, _frame: FrameType | None) -> None:
        if self.pressed:
            raise KeyboardInterrupt
        self.pressed = True
        self._stop()
        self._say("stopping the robot; press Ctrl-C again to leave at once")
