"""The open pages: what each is told, and which one holds the controls."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from app.web.guard import RateLimit

MAX_WAITING = 400
"""Messages that may wait for a slow page before it is cut off; it can reload and gets everything anew."""
RATE, BURST = 20.0, 60
"""Messages a second from a page."""
GRACE_S = 8.0
"""For this long the controls wait for a page that has gone, so that a reload keeps them [s]."""


@dataclass(eq=False)
class Page:
    """One open page."""

    id: str
    """Drawn by the page; stays over a reload."""
    number: int
    queue: asyncio.Queue[str] = field(default_factory=lambda: asyncio.Queue(MAX_WAITING))
    limit: RateLimit = field(default_factory=lambda: RateLimit(RATE, BURST))
    strikes: int = 0
    """Messages that came faster than the limit."""
    lost: bool = False
    """It did not keep up and is being cut off."""


class Hall:
    """All pages. Its methods run in the server's event loop, except `tell`, which any thread may call."""

    def __init__(self) -> None:
        self.pages: list[Page] = []
        self._loop: asyncio.AbstractEventLoop | None = None
        self._holder: str | None = None
        self._left_at = 0.0
        self._numbers: dict[str, int] = {}

    # Talking ----------------------------------------------------------------------------------------------------

    def tell(self, message: dict[str, Any], *, to: Callable[[Page], bool] = lambda _page: True) -> None:
        """Sends to all pages, or to those of a kind."""
        if self._loop is None or self._loop.is_closed():
            return
        text = json.dumps(message)
        try:
            self._loop.call_soon_threadsafe(self._put, text, to)
        except RuntimeError:
            # The server is closing; there is nobody left to tell.
            return

    def _put(self, text: str, to: Callable[[Page], bool]) -> None:
        for page in self.pages:
            if page.lost or not to(page):
                continue
            try:
                page.queue.put_nowait(text)
            except asyncio.QueueFull:
                page.lost = True

    # Coming and going -------------------------------------------------------------------------------------------

    def enter(self, page_id: str) -> Page:
        """A page has opened; the first one gets the controls, and so does the one that held them before a reload."""
        self._loop = asyncio.get_running_loop()
        number = self._numbers.setdefault(page_id, len(self._numbers) + 1)
        page = Page(page_id, number)
        self.pages.append(page)
        gone = not any(other.id == self._holder for other in self.pages)
        if self._holder is None or (gone and self._loop.time() - self._left_at > GRACE_S):
            self._holder = page_id
        self.announce()
        return page

    def leave(self, page: Page) -> None:
        """A page has closed. If it held the controls, they wait a moment for its return, then anyone may take them."""
        self.pages.remove(page)
        if page.id == self._holder and not any(other.id == page.id for other in self.pages):
            self._left_at = asyncio.get_running_loop().time()
        self.announce()

    def holds(self, page: Page) -> bool:
        """Whether this page has the controls."""
        return page.id == self._holder

    def take(self, page: Page) -> bool:
        """Gives the controls to this page if nobody who is here holds them."""
        if any(other.id == self._holder for other in self.pages):
            return self.holds(page)
        self._holder = page.id
        self.announce()
        return True

    def announce(self) -> None:
        """Tells every page who holds the controls."""
        present = any(other.id == self._holder for other in self.pages)
        number = self._numbers.get(self._holder or "", 0)
        for page in self.pages:
            held = {"type": "controls", "yours": self.holds(page), "holder": number, "you": page.number}
            self._put(json.dumps({**held, "free": not present, "pages": len(self.pages)}), lambda p, me=page: p is me)
