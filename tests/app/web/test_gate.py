"""Laws of the door, tried on the real server: token, origin, limits, headers, and one port only."""

from __future__ import annotations

import http.client
import json
from typing import Any

import pytest


def _get(site: Any, path: str, **headers: str) -> tuple[int, dict[str, str], bytes]:
    connection = http.client.HTTPConnection("127.0.0.1", site.port, timeout=20)
    connection.request("GET", path, headers=headers)
    answer = connection.getresponse()
    found = (answer.status, {name.lower(): value for name, value in answer.getheaders()}, answer.read())
    connection.close()
    return found


def _cookie(site: Any) -> str:
    status, headers, _ = _get(site, f"/?token={site.guard.token}")
    assert (status, headers["location"]) == (303, "/")
    return headers["set-cookie"].partition(";")[0]


def _connect(site: Any, path: str, **headers: str) -> Any:
    from websockets.sync.client import connect

    protocols: Any = [f"viser-v{__import__('viser').__version__}"] if path == "/view" else None
    origin: Any = headers.pop("Origin", None)
    return connect(
        f"ws://127.0.0.1:{site.port}{path}", additional_headers=headers, origin=origin, proxy=None,
        subprotocols=protocols, max_size=None,
    )  # fmt: skip


def _origin(site: Any) -> str:
    return f"http://127.0.0.1:{site.port}"


def _enter(site: Any, page: str) -> Any:
    socket = _connect(site, "/talk", Cookie=_cookie(site), Origin=_origin(site))
    socket.send(json.dumps({"type": "enter", "page": page}))
    return socket


def _until(socket: Any, kind: str) -> dict[str, Any]:
    while True:
        message = json.loads(socket.recv(timeout=20))
        if message["type"] == kind:
            return message


@pytest.mark.parametrize(
    "path", ["/", "/view/", "/view/index.html", "/static/page.js", "/pictures/1-front.jpg", "/nothing"]
)
def test_a_missing_token_gets_403(site: Any, path: str) -> None:
    """No path answers without the cookie, not even with 404."""
    assert _get(site, path)[0] == 403
    assert _get(site, f"{path}?token=wrong")[0] == 403


@pytest.mark.parametrize("path", ["/talk", "/view"])
def test_a_websocket_needs_cookie_and_own_origin(site: Any, path: str) -> None:
    """Conversation and 3D view alike: 403 without cookie, from a foreign origin, and without any origin."""
    from websockets.exceptions import InvalidStatus

    cookie = _cookie(site)
    for headers in ({"Origin": _origin(site)}, {"Cookie": cookie, "Origin": "http://evil.example"}, {"Cookie": cookie}):
        with pytest.raises(InvalidStatus) as caught:
            _connect(site, path, **headers)
        assert caught.value.response.status_code == 403
    with _connect(site, path, Cookie=cookie, Origin=_origin(site)):
        pass


def test_pages_may_fetch_nothing_from_elsewhere(site: Any) -> None:
    """Page and 3D view carry a policy that names no other host; the page's own files name none either."""
    cookie = _cookie(site)
    for path in ("/", "/view/"):
        status, headers, body = _get(site, path, Cookie=cookie)
        assert status == 200
        policy = headers["content-security-policy"]
        assert "default-src 'none'" in policy
        assert "http" not in policy
        assert headers["x-content-type-options"] == "nosniff"
        assert path == "/view/" or b"://" not in body
    assert b"http" not in _get(site, "/static/page.js", Cookie=cookie)[2].replace(b"https:", b"")


@pytest.mark.parametrize(
    "path", ["/static/../serve.py", "/static/%2e%2e/serve.py", "/view/../serve.py", "/session/../threads.sqlite"]
)
def test_paths_do_not_lead_out(site: Any, path: str) -> None:
    """Nothing but the page's own files can be read."""
    assert _get(site, path, Cookie=_cookie(site))[0] == 404


def test_a_huge_message_and_a_flood_end_the_connection_only(site: Any) -> None:
    """A message beyond the limit closes that page's connection, a flood is warned and then cut off; the server goes on."""
    from websockets.exceptions import ConnectionClosed

    with _enter(site, "flooding-page") as socket:
        _until(socket, "hello")
        for _ in range(100):
            socket.send('{"type": "point", "name": null}')
        assert "too many" in _until(socket, "notice")["text"]
        with pytest.raises(ConnectionClosed):
            _until(socket, "never")
    with _enter(site, "shouting-page") as socket:
        _until(socket, "hello")
        socket.send("x" * 300_000)
        with pytest.raises(ConnectionClosed):
            _until(socket, "never")
    assert _get(site, "/", Cookie=_cookie(site))[0] == 200


def test_the_second_page_may_look_and_stop(site: Any) -> None:
    """The first page has the controls; the second is told who, is refused orders, and may stop the robot."""
    with _enter(site, "page-number-one") as first:
        _until(first, "hello")
        first.send('{"type": "take"}')
        with _enter(site, "page-number-two") as second:
            held = _until(second, "controls")
            while held["pages"] < 2:
                held = _until(second, "controls")
            assert (held["yours"], held["free"]) == (False, False)
            second.send('{"type": "say", "text": "pick up the cube"}')
            assert "controls" in _until(second, "notice")["text"]
            second.send('{"type": "stop"}')
            while not _until(first, "status")["status"]["stopped"]:
                pass
            second.send('{"type": "release"}')
            assert "controls" in _until(second, "notice")["text"]
            assert site.desk.talk.stopped
        first.send('{"type": "release"}')
        while _until(first, "status")["status"]["stopped"]:
            pass


def test_only_the_public_port_is_open(site: Any) -> None:
    """The server of viser listens nowhere else: all listening sockets of this process that speak HTTP are the public one."""
    assert site._server.get_port() == site.port
