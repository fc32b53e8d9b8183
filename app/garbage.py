"""When the interpreter looks for garbage, between turns and not while the robot moves, and where memory comes from.

A search through everything holds every thread for 0.14 s in a process with the agent's libraries loaded, and with them the
control loop and the key that stops it.
"""

from __future__ import annotations

import ctypes
import gc

RARELY = 1000
"""Searches of the middle generation before one through everything happens by itself: hours instead of seconds."""

ARENA_MAX = -8
"""glibc's `M_ARENA_MAX` (malloc.h)."""


class Garbage:
    """Looks for garbage when it is told to, and spares what stays until the process ends."""

    def __init__(self) -> None:
        """From now on nothing but small searches (under 10 ms) happen by themselves."""
        young, middle, _ = gc.get_threshold()
        gc.set_threshold(young, middle, RARELY)
        gc.freeze()
        self._settled = False
        _one_arena()

    def collect(self) -> None:
        """Between turns: a search through what came since the first one, which loads most of what is loaded late."""
        gc.collect()
        if not self._settled:
            gc.freeze()
            self._settled = True


def _one_arena() -> None:
    """Lets all threads take memory from one place.

    Each turn has threads of its own. With an arena for each (glibc's default; elsewhere this does nothing) the process is 40 MB
    larger and goes up and down by a tenth, as pieces of one turn hold what another has left.
    """
    choose = getattr(ctypes.CDLL(None), "mallopt", None)
    if choose is not None:
        choose(ARENA_MAX, 1)
