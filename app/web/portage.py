"""Whole sessions out of and into the page, as files of bounded size; nothing here holds up the server's event loop."""

from __future__ import annotations

import asyncio
import re
import secrets
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from app.web.gate import Reply
from kb.errors import BadInputError, EnvironmentFaultError

MAX_FILE = 100_000_000
"""Largest session that goes through the page [bytes]; `/sessions export` in the terminal takes larger ones."""
EXPORTS = re.compile(r"^/export/([0-9a-f]{16})\.zip$")


@dataclass
class Upload:
    """A file that a page is sending in pieces."""

    size: int
    data: bytearray = field(default_factory=bytearray)


class Portage:
    """Packs sessions for a page to fetch, and takes in those that it sends."""

    def __init__(self, tell: Callable[[Any, dict[str, Any]], None]) -> None:
        """Args: sends a message to one page."""
        self._tell = tell
        self._packed: tuple[str, str, bytes] | None = None
        self._uploads: dict[Any, Upload] = {}
        self._busy = asyncio.Lock()

    def reply(self, path: str) -> Reply | None:
        """The packed session, once."""
        found = EXPORTS.match(path)
        if found is None or self._packed is None or self._packed[0] != found[1]:
            return None
        _, thread, body = self._packed
        self._packed = None
        return Reply(body, "application/zip", name=f"{thread}.zip")

    async def export(self, page: Any, thread: str) -> None:
        """Packs a session and tells the page where to fetch it."""
        async with self._busy:
            try:
                body = await asyncio.to_thread(_pack, thread)
            except (BadInputError, EnvironmentFaultError) as error:
                self._tell(page, {"type": "notice", "text": str(error)})
                return
            name = secrets.token_hex(8)
            self._packed = (name, thread, body)
            self._tell(page, {"type": "download", "path": f"/export/{name}.zip", "name": f"{thread}.zip"})

    def begin(self, page: Any, size: int) -> None:
        """A page will send a file of that size in binary messages."""
        self._uploads.clear()  # one at a time: what came before was left
        self._uploads[page] = Upload(size)
        self._tell(page, {"type": "upload", "got": 0})

    def forget(self, page: Any) -> None:
        """The page has gone."""
        self._uploads.pop(page, None)

    def take(self, page: Any, piece: bytes) -> bytes | None:
        """One piece; the whole file once it is there.

        Raises:
            BadInputError: no file was announced, or it is longer than announced.
        """
        upload = self._uploads.get(page)
        if upload is None or len(upload.data) + len(piece) > upload.size:
            self.forget(page)
            raise BadInputError("this is no part of a file that was announced", where="import")
        upload.data += piece
        if len(upload.data) < upload.size:
            self._tell(page, {"type": "upload", "got": len(upload.data)})
            return None
        self.forget(page)
        return bytes(upload.data)

    async def bring_in(self, page: Any, body: bytes, then: Callable[[], None]) -> None:
        """Keeps a session that was sent; `then` is called when it is there."""
        async with self._busy:
            try:
                name = await asyncio.to_thread(_unpack, body)
            except (BadInputError, EnvironmentFaultError) as error:
                self._tell(page, {"type": "notice", "text": str(error)})
                return
            self._tell(page, {"type": "notice", "text": f"session {name} is here; Open takes it up"})
            then()


def _pack(thread: str) -> bytes:
    """The session's file.

    Raises:
        BadInputError: no such session, or one that is too large for the page.
        EnvironmentFaultError: there is no room for it.
    """
    from agent.chat.portable import export_session

    try:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "session.zip"
            size = export_session(thread, file)
            if size > MAX_FILE:
                raise BadInputError(
                    f"the session takes {size // 1_000_000} MB, through the page at most {MAX_FILE // 1_000_000}; "
                    "/sessions export in the terminal takes it",
                    where="export",
                )
            return file.read_bytes()
    except OSError as error:
        raise EnvironmentFaultError(
            f"cannot pack the session: {error.strerror}", mend="make room on the disk"
        ) from error


def _unpack(body: bytes) -> str:
    """Keeps the session under its own name or a free one like it; returns the name.

    Raises:
        BadInputError: not an exported session.
        EnvironmentFaultError: it cannot be kept.
    """
    from agent.chat.portable import import_session

    try:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "session.zip"
            file.write_bytes(body)
            return import_session(file, free_name=True)
    except OSError as error:
        raise EnvironmentFaultError(
            f"cannot keep the session: {error.strerror}", mend="make room on the disk"
        ) from error
