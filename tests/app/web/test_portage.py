"""Whole sessions through the page: exported and imported as one file, within bounds, and only what was announced."""

from __future__ import annotations

import http.client
import json
import zipfile
from io import BytesIO
from typing import Any

import pytest

from app.web.orders import parse_order
from kb.errors import BadInputError


def _cookie(site: Any) -> str:
    connection = http.client.HTTPConnection("127.0.0.1", site.port, timeout=20)
    connection.request("GET", f"/?token={site.guard.token}")
    found = connection.getresponse().headers["set-cookie"].partition(";")[0]
    connection.close()
    return found


def _get(site: Any, path: str, cookie: str) -> tuple[int, Any, bytes]:
    connection = http.client.HTTPConnection("127.0.0.1", site.port, timeout=20)
    connection.request("GET", path, headers={"Cookie": cookie})
    answer = connection.getresponse()
    found = (answer.status, answer.headers, answer.read())
    connection.close()
    return found


def _until(socket: Any, kind: str) -> dict[str, Any]:
    while True:
        message = json.loads(socket.recv(timeout=20))
        if message["type"] == kind:
            return message


def _send(socket: Any, body: bytes) -> None:
    """In pieces, as the page does."""
    socket.send(json.dumps({"type": "upload", "size": len(body)}))
    for first in range(0, len(body), 100_000):
        _until(socket, "upload")
        socket.send(body[first : first + 100_000])


def test_a_session_goes_out_and_comes_in(site: Any) -> None:
    """Packed it can be fetched once, with the cookie only; sent back it is there under a free name; rubbish is refused."""
    from websockets.sync.client import connect
    from websockets.typing import Origin

    cookie, origin = _cookie(site), Origin(f"http://127.0.0.1:{site.port}")
    socket = connect(
        f"ws://127.0.0.1:{site.port}/talk", additional_headers={"Cookie": cookie}, origin=origin, max_size=None
    )
    socket.send(json.dumps({"type": "enter", "page": "0123456789abcdef"}))
    _until(socket, "hello")
    list(site.desk.talk.say("what do you see"))
    socket.send(json.dumps({"type": "session", "action": "export", "thread": "tested"}))
    told = _until(socket, "download")
    assert told["name"] == "tested.zip"
    assert _get(site, told["path"], "")[0] == 403
    status, headers, body = _get(site, told["path"], cookie)
    assert (status, headers["content-disposition"]) == (200, 'attachment; filename="tested.zip"')
    assert _get(site, told["path"], cookie)[0] == 404
    assert "checkpoints.sqlite" in zipfile.ZipFile(BytesIO(body)).namelist()
    _send(socket, body)
    assert "session tested-2 is here" in _until(socket, "notice")["text"]
    threads = [row["thread"] for row in _until(socket, "offers")["value"]["sessions"]]
    assert {"tested", "tested-2"} <= set(threads)
    _send(socket, b"PK no session" * 9_000)
    assert "not an exported session" in _until(socket, "notice")["text"]
    socket.send(b"not announced")
    assert "announced" in _until(socket, "notice")["text"]
    socket.send(json.dumps({"type": "session", "action": "export", "thread": "nobody"}))
    assert "no session 'nobody'" in _until(socket, "notice")["text"]
    socket.close()


@pytest.mark.parametrize("size", [0, -1, 100_000_001])
def test_a_file_beyond_the_bounds_is_not_taken(size: int) -> None:
    """Empty files and those above 100 MB are refused before a byte of them is sent."""
    with pytest.raises(BadInputError):
        parse_order(json.dumps({"type": "upload", "size": size}))
