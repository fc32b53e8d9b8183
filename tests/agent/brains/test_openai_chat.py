"""The OpenAI-compatible chat against a server on loopback that shows every fault; nothing here really waits."""

from __future__ import annotations

import socket
from datetime import UTC, datetime

import numpy as np
import pytest

from agent.brain import BrainFaultError
from agent.brains.back_off import back_off, retry_after
from agent.brains.chat import Message, Prompt
from agent.brains.openai_chat import RETRIES, OpenAIChat
from kb.errors import EnvironmentFaultError
from tests.brain_fixtures import Behaviour, fault_server, status

KEY = "sk-very-secret-1234567890"
PROMPT = Prompt("think", (Message("system", "Be brief."), Message("user", "Hello", (b"png",))), {"type": "object"})


class Waits:
    """A clock that only waiting moves, and how long was waited."""

    def __init__(self) -> None:
        self.now = 0.0
        self.slept: list[float] = []

    def sleep(self, seconds: float) -> None:
        """Moves the clock."""
        self.now += seconds
        self.slept.append(seconds)

    def clock(self) -> float:
        """The time."""
        return self.now


def ask(
    *script: Behaviour, waits: Waits | None = None, prompt: Prompt = PROMPT, read: float = 5.0
) -> tuple[str, list[dict]]:
    """The reply and the requests of a chat with a server that follows the script."""
    waits = waits or Waits()
    with fault_server(*script) as server:
        chat = OpenAIChat(
            "good", server.url, rng=np.random.default_rng(3), sleep=waits.sleep, clock=waits.clock, read_seconds=read
        )
        return chat.reply(prompt).text, server.requests


def fault(*script: Behaviour, waits: Waits | None = None, read: float = 5.0) -> BrainFaultError:
    """The fault that such a chat ends with."""
    with pytest.raises(BrainFaultError) as caught:
        ask(*script, waits=waits, read=read)
    return caught.value


@pytest.fixture(autouse=True)
def key(monkeypatch: pytest.MonkeyPatch) -> None:
    """A key that must never show up anywhere."""
    monkeypatch.setenv("OPENAI_API_KEY", KEY)


def test_a_reply_is_streamed_with_schema_pictures_and_counts() -> None:
    """The request carries the JSON schema, the picture as a data URL and temperature 0; the pieces are joined."""
    text, requests = ask(("ok", '{"a": 1}'))
    assert text == '{"a": 1}'
    sent = requests[0]
    assert sent["response_format"]["json_schema"] == {"name": "think", "schema": {"type": "object"}, "strict": True}
    assert sent["messages"][1]["content"][1]["image_url"]["url"].startswith("data:image/png;base64,")
    assert (sent["temperature"], sent["stream"]) == (0.0, True)


@pytest.mark.parametrize("passing", [status(429), status(500), status(503), ("cut", '{"a"')])
def test_what_may_pass_is_tried_again(passing: Behaviour) -> None:
    """After two such faults the third trial counts, and the waits grow with jitter."""
    waits = Waits()
    text, requests = ask(passing, passing, ("ok", "{}"), waits=waits)
    assert (text, len(requests)) == ("{}", 3)
    assert 0.25 + 0.5 <= sum(waits.slept) <= 0.5 + 1.0


def test_retry_after_is_honoured() -> None:
    """At least as long as the server asks is waited."""
    waits = Waits()
    ask(status(429, retry_after="7"), ("ok", "{}"), waits=waits)
    assert sum(waits.slept) >= 7.0 - 1e-9


@pytest.mark.parametrize(
    ("behaviour", "says"),
    [
        (status(429), "overloaded"),
        (status(500), "status 500"),
        (("cut", "{"), "cut off"),
        (("garbage", b""), "cut off"),
    ],
)
def test_what_does_not_pass_is_a_clear_fault(behaviour: Behaviour, says: str) -> None:
    """After all trials the fault says what it was and how often it was tried."""
    found = fault(behaviour)
    assert says in found.what
    assert f"({RETRIES + 1} trials)" in found.what


def test_a_server_that_hangs_is_left() -> None:
    """No piece within the read time: a time-out, tried again within the time that is left."""
    assert "in time" in fault(("hang", None), read=0.05).what


def test_slow_tokens_end_at_the_time_limit() -> None:
    """A reply that crawls is given up when its time is over, and is not tried again."""

    class Crawling(Waits):
        def clock(self) -> float:
            self.now += 50.0
            return self.now

    assert "too slow" in fault(("ok", "{}"), waits=Crawling()).what


def test_unreachable_wrong_key_and_wrong_model_say_their_mend(caplog: pytest.LogCaptureFixture) -> None:
    """Each has its own mend; the key is in none of the texts, though the server repeats it."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    waits = Waits()
    chat = OpenAIChat(
        "good", f"http://127.0.0.1:{port}/v1", rng=np.random.default_rng(3), sleep=waits.sleep, clock=waits.clock
    )
    with pytest.raises(BrainFaultError) as caught:
        chat.reply(PROMPT)
    key, model = fault(status(401, f"Incorrect API key provided: {KEY}")), fault(status(404, "no such model"))
    odd = fault(status(418, f"teapot {KEY}"))
    assert "--base-url" in (caught.value.mend or "")
    assert "OPENAI_API_KEY" in (key.mend or "")
    assert model.mend == "choose one of: good"
    told = [f"{f.what} {f.mend} {f!r}" for f in (caught.value, key, model, odd)]
    assert KEY not in " ".join(told) + caplog.text + repr(chat.__dict__["_client"])
    assert "[key]" in odd.what


@pytest.mark.parametrize(
    ("complaint", "left_out"),
    [
        (status(400, "response_format json_schema is not supported"), "response_format"),
        (status(400, "Unknown parameter: stream_options"), "stream_options"),
    ],
)
def test_what_a_server_does_not_know_is_left_out(complaint: Behaviour, left_out: str) -> None:
    """Older servers lack one or the other; the second request comes at once and without it."""
    waits = Waits()
    text, requests = ask(complaint, ("ok", "{}"), waits=waits)
    assert (text, waits.slept) == ("{}", [])
    assert left_out in requests[0]
    assert left_out not in requests[1]


def test_a_server_without_eyes_is_sent_text() -> None:
    """A complaint about the picture stops sending pictures for good."""
    text, requests = ask(status(500, "image input is not supported"), ("ok", "{}"))
    assert text == "{}"
    assert requests[1]["messages"][1]["content"] == "Hello"


def test_a_stop_ends_the_trials() -> None:
    """Once the person has stopped, nothing is tried again."""
    with fault_server(status(500)) as server:
        chat = OpenAIChat("good", server.url, rng=np.random.default_rng(3), stopped=lambda: True)
        with pytest.raises(BrainFaultError):
            chat.reply(PROMPT)
        assert len(server.requests) == 1


def test_openai_itself_needs_a_key(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without key and address there is nobody to ask, which is said before anything is sent."""
    monkeypatch.delenv("OPENAI_API_KEY")
    with pytest.raises(EnvironmentFaultError, match="OPENAI_API_KEY"):
        OpenAIChat("gpt", rng=np.random.default_rng(0))


def test_waits_grow_and_stay_bounded() -> None:
    """Half to the whole of 0.5 s times 2 to the trial, at most 30 s, never less than the server asks for."""
    for trial in range(12):
        waits = [back_off(trial, np.random.default_rng(seed)) for seed in range(20)]
        whole = min(30.0, 0.5 * 2**trial)
        assert all(whole / 2 <= wait <= whole for wait in waits)
        assert len(set(waits)) > 1
    assert back_off(0, np.random.default_rng(0), asked=9.0) == 9.0
    now = datetime(2026, 1, 1, tzinfo=UTC)
    assert retry_after("Thu, 01 Jan 2026 00:00:05 GMT", now) == 5.0
    assert (retry_after("junk"), retry_after("100000"), retry_after(None)) == (None, 120.0, None)
