"""The desk's own thread: orders are carried out in it, one after the other, so that giving one never waits."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable

from kb.errors import RagVlmError

MAX_WAITING = 8
"""Orders that may wait for the one being carried out."""


class Worker:
    """Carries out orders in line."""

    def __init__(self, refuse: Callable[[str], None], done: Callable[[], None]) -> None:
        """Args: who is told why an order was not carried out; and that one is over, however it ended."""
        self._refuse, self._done = refuse, done
        self._orders: queue.Queue[Callable[[], None] | None] = queue.Queue(MAX_WAITING)
        self._thread = threading.Thread(target=self._work, name="ragvlm-desk", daemon=True)
        self._thread.start()

    def order(self, work: Callable[[], None]) -> None:
        """Puts work in line; refuses it when too much waits already. Returns at once."""
        try:
            self._orders.put_nowait(work)
        except queue.Full:
            self._refuse("too many orders are waiting; one thing after the other, please")

    def close(self) -> None:
        """Ends the thread after what is in line."""
        self._orders.put(None)
        self._thread.join(timeout=10.0)

    def _work(self) -> None:
        while (work := self._orders.get()) is not None:
            try:
                work()
            except RagVlmError as error:
                self._refuse(str(error))
            except Exception as error:
                # A bug must not end the thread: whoever sits at the page has to be able to stop the robot.
                self._refuse(f"internal error: {type(error).__name__}: {error}")
            finally:
                self._done()
