"""The stop switch: a latch that any thread may press and that the control loop reads at every check."""

from __future__ import annotations

import threading


class StopSwitch:
    """Once pressed it stays pressed, and no motion starts or continues, until it is released on purpose."""

    def __init__(self) -> None:
        self._pressed = threading.Event()

    def press(self) -> None:
        """Stops the robot; may be called from any thread and more than once."""
        self._pressed.set()

    def release(self) -> None:
        """Allows motion again. Nothing moves by itself after that."""
        self._pressed.clear()

    @property
    def pressed(self) -> bool:
        """True from `press` until `release`."""
        return self._pressed.is_set()
