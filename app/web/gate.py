"""The one public port: viser's server with our guard in front of every request and our page beside its 3D view.

viser has no authentication, accepts any Origin and opens its own port. Its server is therefore started on a socket of
ours and through a door of ours: guard, routes, limits, security headers. The version is pinned; tests try the door.
"""

from __future__ import annotations

import logging
import socket
from collections.abc import Awaitable, Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from http import HTTPStatus
from typing import TYPE_CHECKING, Any

from app.web.guard import Guard, RateLimit, Refusal, Welcome
from kb.errors import EnvironmentFaultError

if TYPE_CHECKING:
    import viser
    from websockets.http11 import Request, Response

MAX_MESSAGE = 256 * 1024
"""Largest message that a page may send [bytes]."""
MAX_CONNECTIONS = 16
"""WebSockets open at the same time: each page has two."""
VIEW_RATE, VIEW_BURST = 120.0, 600
"""Messages a second from a 3D view: it reports its camera while it is turned."""
VIEW, TALK = "/view", "/talk"
"""Paths of viser's client and of the conversation."""
PAGE_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; "
    "connect-src 'self'; frame-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
VIEW_POLICY = (
    "default-src 'none'; script-src 'self' 'unsafe-inline' 'wasm-unsafe-eval' blob:; style-src 'unsafe-inline'; "
    "img-src 'self' data: blob:; font-src data:; worker-src blob:; connect-src 'self' data: blob:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'self'"
)
"""Nothing may be fetched from elsewhere, whatever a library would like to."""

VIEW_EXTRAS = (
    b"<style>.mantine-Paper-root,.mantine-Notifications-root{display:none!important}</style>"
    b"<script>{const post=Worker.prototype.postMessage;Worker.prototype.postMessage=function(data,...more){"
    b'if(data?.message?.type==="ViewerCameraMessage")window.camera=data.message;return post.call(this,data,...more)}}'
    b"</script>"
)
"""Hides what viser's client would lay over the scene, and notes the camera that it tells its server of."""


@dataclass(frozen=True)
class Reply:
    """An answer to a plain request."""

    body: bytes
    kind: str
    """Content type."""
    policy: str = PAGE_POLICY
    name: str | None = None
    """File name, if the answer is a download."""


@dataclass(frozen=True)
class Door:
    """What stands behind the guard."""

    guard: Guard
    page: Callable[[str], Reply | None]
    """Path -> answer, None if there is nothing."""
    talk: Callable[[Any], Awaitable[None]]
    """Serves the WebSocket of a page's conversation."""


def bind(host: str, port: int) -> socket.socket:
    """The public socket.

    Raises:
        EnvironmentFaultError: the port is taken or may not be used, or the host is not of this machine.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    sock = socket.socket(family, socket.SOCK_STREAM)
    try:
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        sock.bind((host, port))
        sock.listen(64)
    except OSError as error:
        sock.close()
        why = error.strerror or str(error)
        raise EnvironmentFaultError(f"cannot listen on {host} port {port}: {why}", mend="try another --port") from error
    return sock


def open_gate(sock: socket.socket, door: Door) -> viser.ViserServer:
    """Starts viser's server behind the door; its scene is the 3D view under `VIEW`."""
    import rich
    import viser
    from viser import _messages

    console = rich.get_console()
    loud, console.quiet = console.quiet, True
    try:
        with _through(sock, door):
            server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    finally:
        console.quiet = loud
    # A view could ask viser to publish the robot through a relay on the internet: nobody answers that here.
    handlers = server._websock_server._incoming_handlers
    for wish in (_messages.ShareUrlRequest, _messages.ShareUrlDisconnect):
        handlers.pop(wish, None)
    return server


@contextmanager
def _through(sock: socket.socket, door: Door) -> Iterator[None]:
    """While viser starts, its server is opened on our socket with our handlers."""
    from websockets.asyncio import server as library

    original = library.serve

    def serve(view: Any, _host: str, _port: int, **settings: Any) -> Any:
        files = settings.pop("process_request")
        settings.update(max_size=MAX_MESSAGE, max_queue=32, open_timeout=10, close_timeout=1)
        return original(
            _router(view, door),
            sock=sock,
            process_request=_request_handler(files, door),
            create_connection=_limited(library.ServerConnection),
            logger=_quiet_logger(),
            **settings,
        )

    library.serve = serve  # type: ignore[assignment]
    try:
        yield
    finally:
        library.serve = original


def _router(view: Callable[[Any], Awaitable[None]], door: Door) -> Callable[[Any], Awaitable[None]]:
    """Hands a WebSocket to the conversation or to viser, and turns away one too many."""
    open_now = 0

    async def route(connection: Any) -> None:
        nonlocal open_now
        if open_now >= MAX_CONNECTIONS:
            await connection.close(1013, "too many pages are open")
            return
        open_now += 1
        try:
            path = connection.request.path.partition("?")[0].rstrip("/")
            if path == TALK:
                await door.talk(connection)
            elif path == VIEW:
                await view(connection)
            else:
                await connection.close(1008, "there is nothing here")
        finally:
            open_now -= 1

    return route


def _request_handler(files: Callable[[Any, Any], Response | None], door: Door) -> Callable[[Any, Any], Response | None]:
    """Judges, then answers plain requests; None lets a WebSocket open."""
    from dataclasses import replace

    from websockets.datastructures import Headers

    def handle(connection: Any, request: Request) -> Response | None:
        verdict = door.guard.judge(request.path, request.headers)
        if isinstance(verdict, Refusal):
            return _response(verdict.status, f"{verdict.status.value}: {verdict.reason}\n".encode(), "text/plain")
        if isinstance(verdict, Welcome):
            return _response(HTTPStatus.SEE_OTHER, b"", "text/plain", {"Set-Cookie": verdict.cookie, "Location": "/"})
        if request.headers.get("Upgrade", "").lower() == "websocket":
            return None
        path = request.path.partition("?")[0]
        if path == VIEW or path.startswith(f"{VIEW}/"):
            answer = files(connection, replace(request, path=path.removeprefix(VIEW) or "/", headers=Headers()))
            return None if answer is None else _view_only(answer)
        reply = door.page(path)
        if reply is None:
            return _response(HTTPStatus.NOT_FOUND, b"404: there is nothing here\n", "text/plain")
        extra = {"Content-Disposition": f'attachment; filename="{reply.name}"'} if reply.name else {}
        return _response(HTTPStatus.OK, reply.body, reply.kind, extra, reply.policy)

    return handle


def _view_only(answer: Response) -> Response:
    """The client of viser without its own panel and notices: the page around it has the controls."""
    if answer.status_code == HTTPStatus.OK:
        answer.body = answer.body.replace(b"</head>", VIEW_EXTRAS + b"</head>", 1)
        del answer.headers["Content-Length"]
        answer.headers["Content-Length"] = str(len(answer.body))
    return _hardened(answer, VIEW_POLICY)


def _response(
    status: HTTPStatus, body: bytes, kind: str, extra: dict[str, str] | None = None, policy: str = PAGE_POLICY
) -> Response:
    from websockets.datastructures import Headers
    from websockets.http11 import Response as Answer

    kind = f"{kind}; charset=utf-8" if kind.startswith("text/") else kind
    headers = Headers({"Content-Type": kind, "Content-Length": str(len(body)), "Connection": "close", **(extra or {})})
    return _hardened(Answer(status.value, status.phrase, headers, body), policy)


def _hardened(response: Response, policy: str) -> Response:
    """Adds the headers that keep a browser from fetching elsewhere, guessing types, or being framed."""
    response.headers["Content-Security-Policy"] = policy
    response.headers["X-Content-Type-Options"] = "nosniff"
    response.headers["Referrer-Policy"] = "no-referrer"
    response.headers["Cache-Control"] = "no-store"
    return response


def _limited(base: type) -> type:
    """Connections of 3D views that are closed when they send more than a view ever does."""

    class LimitedConnection(base):  # type: ignore[misc, valid-type]
        def __init__(self, *args: Any, **kwargs: Any) -> None:
            super().__init__(*args, **kwargs)
            self._limit = RateLimit(VIEW_RATE, VIEW_BURST)

        async def recv(self, *args: Any, **kwargs: Any) -> Any:
            message = await super().recv(*args, **kwargs)
            if not self._limit.allow():
                await self.close(1008, "too many messages")
            return message

    return LimitedConnection


def _quiet_logger() -> logging.Logger:
    """The library reports every refused handshake with a traceback; a refusal is no event here."""
    logger = logging.getLogger("ragvlm.web")
    logger.setLevel(logging.CRITICAL)
    return logger
