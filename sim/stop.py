"""The stop switch: a latch that any thread may press and that the control loop reads at every check."""

from __future__ import annotations

import threading
import time


class StopSwitch:
    """Once pressed it stays pressed, and no motion starts or continues, until it is released on purpose."""

    def __init__(self) -> None:
        self._pressed = threading.Event()
        self.is_pressed = self._pressed.is_set
        """`pressed` as a function, for loops that ask at every step."""
        self._since = 0.0

    def press(self) -> None:
        """Stops the robot; may be called from any thread and more than once."""
        if not self._pressed.is_set():
            self._since = time.monotonic()
        self._pressed.set()

    def release(self) -> None:
        """Allows motion again. Nothing moves by itself after that."""
        self._pressed.clear()

    @property
    def waited(self) -> float:
        """Wall time since it was pressed [s]; 0 while it is not."""
        return time.monotonic() - self._since if self._pressed.is_set() else 0.0

    @property
    def pressed(self) -> bool:
        """True from `press` until `release`."""
        return self._pressed.is_set()
