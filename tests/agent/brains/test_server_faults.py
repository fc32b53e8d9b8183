"""Whole runs against a server that misbehaves: what it says wrongly is refused, and what it must not say is never shown."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from agent import build_agent
from app.command_line import run_command_line
from tests.brain_fixtures import fault_server, status

KEY = "sk-very-secret-0987654321"


@pytest.fixture(autouse=True)
def key(monkeypatch: pytest.MonkeyPatch) -> None:
    """A key that must never show up anywhere."""
    monkeypatch.setenv("OPENAI_API_KEY", KEY)


@pytest.mark.parametrize(
    ("reply", "reason"),
    [("", "empty"), ("{not json", "not JSON"), ('{"goals": [', "not JSON"), ("[1, 2]", "does not fit the schema")],
)
def test_replies_that_are_none_are_refused_and_the_rules_finish(reply: str, reason: str) -> None:
    """Each of the two questions is asked four times in all, with the reason; then the rules decide, and the run succeeds."""
    steps = []
    with fault_server(("ok", reply)) as server:
        robot = build_agent(
            "single_cube", 10_001, brain="openai:good", base_url=server.url, perception="oracle", dry_run=True
        )
        result = robot.run("pick up the cube", steps.append)
        assert len(server.requests) == 8
        assert reason in str(server.requests[3]["messages"])
    assert result.success
    refused = [step for step in steps if step.kind == "reply_refused"]
    assert [step.role for step in refused] == ["understand"] * 4 + ["think"] * 4
    assert all(reason in step.reason for step in refused)
    assert len(result.model_use.fallbacks) == 2


def test_the_key_is_in_nothing_that_a_command_writes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A server that refuses the key, and one that repeats it in its error: exit 3 or a fallback, and neither the terminal,
    the result, the trace nor the record of replies holds the key, though every request carried it."""
    for name, behaviour in (
        ("refused", status(401, f"Incorrect API key provided: {KEY}")),
        ("odd", status(418, f"teapot {KEY}")),
        ("good", ("ok", "{}")),
    ):
        folder = tmp_path / name
        folder.mkdir()
        with fault_server(behaviour) as server:
            code = run_command_line([
                "run", "pick up the cube", "--scene", "single_cube", "--seed", "10001", "--perception", "oracle", "--dry-run",
                "--brain", "openai:good", "--base-url", server.url, "--json", str(folder / "result.json"),
                "--record", str(folder / "trace"), "--record-brain", str(folder / "replies.jsonl"),
            ])  # fmt: skip
            assert all(KEY in sent for sent in server.keys)
            assert server.keys
        told = capsys.readouterr()
        assert code == (3 if name == "refused" else 0)
        if name == "refused":
            assert "OPENAI_API_KEY" in told.err
        assert KEY not in told.out + told.err
        for file in folder.rglob("*"):
            assert not file.is_file() or KEY.encode() not in file.read_bytes()


def test_every_prompt_reply_refusal_and_fallback_is_in_the_trace(tmp_path: Path) -> None:
    """What the server was sent and what it replied stand in `trace.jsonl` of `--record`, word for word, with every refusal
    and its reason, and both fallbacks."""
    with fault_server(("ok", "no JSON at all")) as server:
        arguments = [
            "run", "pick up the cube", "--scene", "single_cube", "--seed", "10001", "--perception", "oracle", "--dry-run",
            "--brain", "openai:good", "--base-url", server.url, "--no-brain-pictures", "--record", str(tmp_path / "trace"),
        ]  # fmt: skip
        assert run_command_line(arguments) == 0
        sent = [[message["content"] for message in request["messages"]] for request in server.requests]
    rows = [json.loads(line) for line in (tmp_path / "trace" / "trace.jsonl").read_text().splitlines()]
    calls = [row["exchange"] for row in rows if row["kind"] == "model_call"]
    assert [[message["text"] for message in call["messages"]] for call in calls] == sent
    assert [call["reply"] for call in calls] == ["no JSON at all"] * 8
    assert [row["role"] for row in rows if row["kind"] == "reply_refused"] == ["understand"] * 4 + ["think"] * 4
    assert all(row["reason"] for row in rows if row["kind"] == "reply_refused")
    assert [row["role"] for row in rows if row["kind"] == "fallback"] == ["understand", "think"]
