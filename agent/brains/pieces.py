"""A text piece by piece, while another thread makes it."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable, Generator
from dataclasses import dataclass, field
from typing import TypeVar

T = TypeVar("T")
UNFINISHED = "\N{REPLACEMENT CHARACTER}"
"""What a decoder shows for the first bytes of a character whose last ones are still to come."""


@dataclass
class Growing:
    """A text that grows at its end; what is new of it is told once."""

    tell: Callable[[str], None]
    told: str = field(default="", init=False)

    def grown(self, text: str, *, whole: bool = False) -> None:
        """Tells what came since the last time.

        Args:
            text: everything so far.
            whole: nothing comes any more, so that an unfinished character at the end is told too.
        """
        sure = text if whole else text.rstrip(UNFINISHED)
        if len(sure) > len(self.told):
            self.tell(sure[len(self.told) :])
            self.told = sure


def pieces(make: Callable[[Callable[[str], None], Callable[[], bool]], T]) -> Generator[str, None, T]:
    """Runs `make` in a thread and yields what it tells at once; its value is the generator's, its errors are raised here.

    Closing the generator asks `make` to end and waits for it.

    Args:
        make: is given what takes a piece, and what says whether nobody wants further ones.
    """
    waiting: queue.SimpleQueue[str | None] = queue.SimpleQueue()
    left = threading.Event()
    values: list[T] = []
    errors: list[BaseException] = []

    def run() -> None:
        try:
            values.append(make(waiting.put, left.is_set))
        except BaseException as error:  # it belongs to whoever reads the pieces
            errors.append(error)
        finally:
            waiting.put(None)

    thread = threading.Thread(target=run, name="pieces", daemon=True)
    thread.start()
    try:
        while (piece := waiting.get()) is not None:
            yield piece
    finally:
        left.set()
        thread.join()
    if errors:
        raise errors[0]
    return values[0]
