"""Who may see the page: a random token in the first address, a cookie afterwards, and the page's own origin only.

Everything is refused unless it is known to be right: the 3D view, its WebSocket, pictures and the conversation alike.
"""

from __future__ import annotations

import hmac
import secrets
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from http import HTTPStatus
from urllib.parse import parse_qs, urlsplit

TOKEN_BYTES = 24
LOOPBACK = ("127.0.0.1", "localhost", "[::1]")
"""Names under which a page that binds the loopback interface may be asked for (against DNS rebinding)."""


@dataclass(frozen=True)
class Refusal:
    """Why a request is not answered."""

    status: HTTPStatus
    reason: str


@dataclass(frozen=True)
class Welcome:
    """The token was right: the browser gets its cookie and goes on to the page without the token in the address."""

    cookie: str


class Guard:
    """Judges every request before anything else sees it."""

    def __init__(self, port: int, *, remote: bool = False) -> None:
        """Draws the secrets.

        Args:
            port: The public port.
            remote: The page was opened beyond the loopback interface on purpose: any host name may be asked for.
        """
        self.token = secrets.token_urlsafe(TOKEN_BYTES)
        self._secret = secrets.token_urlsafe(TOKEN_BYTES)
        self._name = f"ragvlm_{port}"
        self._hosts = (
            None if remote else {f"{name}:{port}" for name in LOOPBACK} | ({*LOOPBACK} if port == 80 else set())
        )

    def judge(self, target: str, headers: Mapping[str, str]) -> Refusal | Welcome | None:
        """None lets the request through.

        Args:
            target: Path and query as requested.
            headers: Of the request; names in any case.
        """
        host = headers.get("Host", "")
        if not host or (self._hosts is not None and host not in self._hosts):
            return Refusal(HTTPStatus.FORBIDDEN, "this page is not served under that name")
        upgrade = headers.get("Upgrade", "").lower() == "websocket"
        origin = headers.get("Origin")
        # A browser always says where a WebSocket comes from; whoever does not is no page of ours.
        if (origin is not None or upgrade) and urlsplit(origin or "").netloc != host:
            return Refusal(HTTPStatus.FORBIDDEN, "foreign origin")
        if self._knows(headers.get("Cookie", "")):
            return self._forget_token(target)
        given = parse_qs(urlsplit(target).query).get("token", [""])[0]
        if not upgrade and hmac.compare_digest(given.encode(), self.token.encode()):
            return Welcome(self._cookie())
        return Refusal(HTTPStatus.FORBIDDEN, "open the address that ragvlm serve printed, with its token")

    def _forget_token(self, target: str) -> Welcome | None:
        """A browser that is known already and still has the token in its address is sent to the address without it."""
        return Welcome(self._cookie()) if "token" in parse_qs(urlsplit(target).query) else None

    def _cookie(self) -> str:
        return f"{self._name}={self._secret}; Path=/; HttpOnly; SameSite=Strict"

    def _knows(self, cookies: str) -> bool:
        pairs = (pair.strip().partition("=") for pair in cookies.split(";"))
        return any(n == self._name and hmac.compare_digest(v.encode(), self._secret.encode()) for n, _, v in pairs)


class RateLimit:
    """A leaky bucket: at most `burst` at once and `rate` a second in the long run."""

    def __init__(self, rate: float, burst: int, clock: Callable[[], float] = time.monotonic) -> None:
        self._rate, self._burst, self._clock = rate, float(burst), clock
        self._left, self._last = float(burst), clock()

    def allow(self) -> bool:
        """Whether one more is within the limit; counts it if so."""
        now = self._clock()
        self._left = min(self._burst, self._left + (now - self._last) * self._rate)
        self._last = now
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True
