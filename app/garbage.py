"""When the interpreter looks for garbage: between turns, not while the robot moves.

A search through everything holds every thread for 0.14 s in a process with the agent's libraries loaded, and with them the
control loop and the key that stops it.
"""

from __future__ import annotations

import gc

RARELY = 1000
"""Searches of the middle generation before one through everything happens by itself: hours instead of seconds."""


class Garbage:
    """Looks for garbage when it is told to, and spares what stays until the process ends."""

    def __init__(self) -> None:
        """From now on nothing but small searches (under 10 ms) happen by themselves."""
        young, middle, _ = gc.get_threshold()
        gc.set_threshold(young, middle, RARELY)
        gc.freeze()
        self._settled = False

    def collect(self) -> None:
        """Between turns: a search through what came since the first one, which loads most of what is loaded late."""
        gc.collect()
        if not self._settled:
            gc.freeze()
            self._settled = True
