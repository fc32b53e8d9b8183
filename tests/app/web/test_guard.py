"""Laws of the guard: nothing passes without the token's cookie, from a foreign origin, or under a foreign name."""

from __future__ import annotations

from http import HTTPStatus

import pytest

from app.web.guard import Guard, RateLimit, Refusal, Welcome

HOST = "127.0.0.1:8080"


def _known(guard: Guard) -> dict[str, str]:
    welcome = guard.judge(f"/?token={guard.token}", {"Host": HOST})
    assert isinstance(welcome, Welcome)
    return {"Host": HOST, "Cookie": f"other=1; {welcome.cookie.partition(';')[0]}"}


def _refused(verdict: object) -> bool:
    return isinstance(verdict, Refusal) and verdict.status == HTTPStatus.FORBIDDEN


def test_the_token_opens_once_and_the_cookie_from_then_on() -> None:
    """The right token is answered with a cookie that scripts cannot read and other sites do not send; it lets all in."""
    guard = Guard(8080)
    welcome = guard.judge(f"/?token={guard.token}", {"Host": HOST})
    assert isinstance(welcome, Welcome)
    assert "HttpOnly" in welcome.cookie
    assert "SameSite=Strict" in welcome.cookie
    assert guard.token not in welcome.cookie
    headers = _known(guard)
    assert guard.judge("/", headers) is None
    socket = {**headers, "Upgrade": "websocket", "Origin": f"http://{HOST}"}
    assert guard.judge("/talk", socket) is None


@pytest.mark.parametrize(
    "target", ["/", "/?token=", "/?token=wrong", "/view/", "/talk", "/static/page.js", "/pictures/1-front.jpg"]
)
def test_without_the_token_there_is_nothing(target: str) -> None:
    """Every path is refused without token and cookie, and with wrong ones; also with another server's cookie."""
    guard = Guard(8080)
    assert _refused(guard.judge(target, {"Host": HOST}))
    assert _refused(guard.judge(target, {"Host": HOST, "Cookie": "ragvlm_8080=guess"}))
    assert _refused(guard.judge(target, {**_known(Guard(8080)), "Host": HOST}))


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "null", "", "http://127.0.0.1:9999", "http://127.0.0.1.evil.example:8080"]
)
def test_a_foreign_origin_is_refused_even_with_the_cookie(origin: str) -> None:
    """A WebSocket from any other origin is refused though the browser sent the cookie; so is one without an origin."""
    guard = Guard(8080)
    socket = {**_known(guard), "Upgrade": "websocket"}
    assert _refused(guard.judge("/talk", {**socket, "Origin": origin}))
    assert _refused(guard.judge("/view", {**socket, "Origin": origin}))
    assert _refused(guard.judge("/talk", socket))
    assert _refused(guard.judge("/", {**_known(guard), "Origin": origin}))


def test_a_foreign_name_is_refused_on_loopback() -> None:
    """A page bound to loopback answers only to loopback names, which is what stops DNS rebinding."""
    guard = Guard(8080)
    for host in ("evil.example:8080", "127.0.0.1:1", ""):
        assert _refused(guard.judge(f"/?token={guard.token}", {"Host": host}))
    assert isinstance(guard.judge(f"/?token={guard.token}", {"Host": "localhost:8080"}), Welcome)
    remote = Guard(8080, remote=True)
    assert isinstance(remote.judge(f"/?token={remote.token}", {"Host": "robot.lab:8080"}), Welcome)


def test_the_token_never_opens_a_websocket() -> None:
    """A token in a WebSocket's address is refused: only the cookie, which other sites cannot send, opens it."""
    guard = Guard(8080)
    socket = {"Host": HOST, "Upgrade": "websocket", "Origin": f"http://{HOST}"}
    assert _refused(guard.judge(f"/talk?token={guard.token}", socket))


def test_the_rate_limit_refuses_what_exceeds_burst_and_rate() -> None:
    """A burst passes, the next message does not, and after a second as many pass as the rate says."""
    now = 0.0
    limit = RateLimit(5.0, 10, clock=lambda: now)
    assert [limit.allow() for _ in range(11)] == [True] * 10 + [False]
    now = 1.0
    assert [limit.allow() for _ in range(6)] == [True] * 5 + [False]
