"""Plain requests and the pages' conversation channel: files of the page, camera pictures, orders in, messages out."""

from __future__ import annotations

import asyncio
import contextlib
import re
from collections.abc import Callable, Coroutine
from importlib import resources
from pathlib import Path
from typing import Any

from app.web.desk import Desk
from app.web.gate import Reply
from app.web.hall import Hall, Page
from app.web.orders import parse_enter, parse_order
from app.web.points import ends_of_turns
from app.web.portage import Portage
from kb.errors import BadInputError, RagVlmError

KINDS = {".html": "text/html", ".css": "text/css", ".js": "text/javascript", ".svg": "image/svg+xml"}
FILES = re.compile(r"^/static/([a-z_]+\.(?:css|js|svg))$")
PICTURES = re.compile(r"^/pictures/([0-9]+-[A-Za-z0-9_-]+\.jpg)$")
ENTER_S = 10.0
"""For this long a page may take to say who it is [s]."""
TURNS = {
    "why": "Why did you grasp it that way?", "compare": "Compare the last two attempts.", "undo": "Undo that.",
    "remember": "Remember that.", "recall": "What do you remember?", "report": "Report.", "resume": "Go on.",
}  # fmt: skip
"""Orders that are a turn of the conversation by themselves, and how they read in the transcript."""
SESSION_FILES = re.compile(r"^/session/([A-Za-z0-9_-]+\.png)$")
MAX_FILE = 20_000_000
"""Largest picture of a session that is sent to a page [bytes]."""
MAX_STRIKES = 10
"""Messages beyond the rate after which a page is cut off."""
FREE = ("stop", "take", "point", "offers")
"""Orders that a page without the controls may give: anyone may stop the robot."""


class Reception:
    """Serves the pages of one desk."""

    def __init__(self, desk: Desk, hall: Hall, offers: Callable[[], dict[str, Any]]) -> None:
        """Args: the desk, its pages, and what they can choose from (scenes, models, sessions)."""
        self._desk, self._hall, self._offers = desk, hall, offers
        self._files: dict[str, bytes] = {}
        self._tasks: set[asyncio.Task[None]] = set()
        self._portage = Portage(self._tell)

    def _tell(self, page: Page, message: dict[str, Any]) -> None:
        """To one page."""
        self._hall.tell(message, to=lambda other: other is page)

    def _aside(self, work: Coroutine[Any, Any, None]) -> None:
        """Something that takes its time: reading from the disk must not hold up a stop."""
        task = asyncio.create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    # Plain requests -----------------------------------------------------------------------------------------------

    def reply(self, path: str) -> Reply | None:
        """The answer to a plain request that the guard let through."""
        if path == "/":
            return Reply(self._file("page.html"), KINDS[".html"])
        found = FILES.match(path)
        if found is not None:
            body = self._file(found[1])
            return None if not body else Reply(body, KINDS[Path(found[1]).suffix])
        found = PICTURES.match(path)
        if found is not None:
            body = self._desk.pictures.get(found[1])
            return None if body is None else Reply(body, "image/jpeg")
        if path.startswith("/export/"):
            return self._portage.reply(path)
        found = SESSION_FILES.match(path)
        return None if found is None else self._picture(found[1])

    def _picture(self, name: str) -> Reply | None:
        """A picture that the conversation has written into its session's folder."""
        talk = self._desk.talk
        file = None if talk is None or talk.folder is None else talk.folder / name
        if file is None or not file.is_file() or file.stat().st_size > MAX_FILE:
            return None
        return Reply(file.read_bytes(), "image/png")

    def _file(self, name: str) -> bytes:
        if name not in self._files:
            file = resources.files("app.web").joinpath("static", name)
            self._files[name] = file.read_bytes() if file.is_file() else b""
        return self._files[name]

    # The conversation channel -------------------------------------------------------------------------------------

    async def talk(self, connection: Any) -> None:
        """Serves one page until it goes."""
        try:
            first = parse_enter(await asyncio.wait_for(connection.recv(), ENTER_S))
        except (BadInputError, TimeoutError):
            await connection.close(1008, "say first who you are")
            return
        page = self._hall.enter(first.page)
        page.queue.put_nowait(_text({**self._desk.hello(), "offers": await asyncio.to_thread(self._offers)}))
        self._hall.announce()
        sender = asyncio.create_task(self._send(connection, page))
        try:
            async for raw in connection:
                if not page.limit.allow():
                    page.strikes += 1
                    if page.strikes > MAX_STRIKES:
                        await connection.close(1008, "too many messages")
                        break
                    self._tell(page, {"type": "notice", "text": "too many messages at once"})
                    await asyncio.sleep(0.1)
                    continue
                self._receive(page, raw)
        finally:
            sender.cancel()
            with contextlib.suppress(asyncio.CancelledError, Exception):
                await sender
            self._portage.forget(page)
            self._hall.leave(page)

    async def _send(self, connection: Any, page: Page) -> None:
        while True:
            text = await page.queue.get()
            if page.lost:
                await connection.close(1013, "this page does not keep up")
                return
            await connection.send(text)

    def _receive(self, page: Page, raw: str | bytes) -> None:
        """Carries out one order. Nothing here waits: a stop must get through at once."""
        try:
            if isinstance(raw, bytes):
                self._take(page, raw)
                return
            order = parse_order(raw)
            if order.type not in FREE and not self._hall.holds(page):
                raise BadInputError("another page has the controls; this one may look, and stop the robot")
            self._obey(page, order)
        except RagVlmError as error:
            self._tell(page, {"type": "notice", "text": str(error)})

    def _take(self, page: Page, piece: bytes) -> None:
        """A piece of a file."""
        body = self._portage.take(page, piece)
        if body is not None:
            self._aside(self._portage.bring_in(page, body, lambda: self._aside(self._offer(page))))

    def _obey(self, page: Page, order: Any) -> None:
        desk, talk = self._desk, self._desk.talk
        assert talk is not None
        match order.type:
            case "stop":
                desk.stop()
            case "release":
                desk.release()
            case "say":
                desk.say(order.text)
            case "approve":
                desk.turn("approved", talk.approve, goes_on=True)
            case "reject":
                desk.turn("rejected", talk.reject, goes_on=True)
            case "edit":
                changes = order.model_dump(exclude={"type"}, exclude_none=True)
                desk.turn("edited", lambda: talk.edit(**changes), goes_on=True)
            case "whatif":
                changes = order.model_dump(exclude={"type"}, exclude_none=True)
                desk.turn(_words(changes), lambda: talk.whatif(**changes))
            case name if name in TURNS:
                desk.turn(TURNS[name], getattr(talk, name))
            case "offers":
                self._aside(self._offer(page))
            case "session" if order.action == "export":
                self._aside(self._portage.export(page, order.thread))
            case "upload":
                self._portage.begin(page, order.size)
            case "asks":
                desk.set_asks(order.on)
            case "speed":
                desk.set_speed(float(order.value))
            case "replay":
                desk.show_replay(order.run, order.share)
            case "live":
                desk.show_now()
            case "point":
                desk.view.point(order.name)
            case "take":
                if not self._hall.take(page):
                    raise BadInputError("the page that has the controls is still open")
            case _:
                self._change(order)

    async def _offer(self, page: Page) -> None:
        """Tells a page what there is to choose from now."""
        value = await asyncio.to_thread(lambda: {**self._offers(), "points": ends_of_turns(self._desk.talk)})
        self._tell(page, {"type": "offers", "value": value})

    def _change(self, order: Any) -> None:
        """Orders that open another world or session."""
        from app.web.adding import scene_with
        from app.web.names import new_thread

        desk = self._desk
        if desk.status.busy:
            raise BadInputError("the robot is at work; stop it first")
        match order.type:
            case "scene":
                desk.order(lambda: desk.move_to(order.name, order.seed))
            case "fork":
                desk.order(lambda: desk.go_back(order.point))
            case "fresh":
                desk.change(thread=new_thread(desk.status.scene), scene=desk.status.scene, seed=desk.status.seed)
            case "add":
                status = desk.status
                opened = None if desk.talk is None else desk.talk.agent.opened
                added = (status.scene, order.model, order.position, opened)
                desk.order(lambda: desk.move_to(scene_with(*added), status.seed))
            case "session" if order.action == "open":
                desk.change(scene=None, seed=None, thread=order.thread)
            case "session":
                desk.order(lambda: self._delete(order.thread))
            case _:
                raise BadInputError(f"there is no order {order.type!r}")

    def _delete(self, thread: str) -> None:
        from agent.chat.sessions import delete_session

        if thread == self._desk.status.thread:
            raise BadInputError("this session is open; open another one first")
        delete_session(thread)
        self._hall.tell({"type": "offers", "value": self._offers()})


def _words(changes: dict[str, Any]) -> str:
    """A what-if as the person would say it."""
    units = {"force": (1.0, " N"), "aperture": (1000.0, " mm"), "yaw": (57.29578, "°")}
    said: list[str] = []
    for name, value in changes.items():
        scale, unit = units.get(name, (None, ""))
        said.append(f"{name} {value}" if scale is None else f"{name} {value * scale:.3g}{unit}")
    return f"What if: {', '.join(said)}?"


def _text(message: dict[str, Any]) -> str:
    import json

    return json.dumps(message)
