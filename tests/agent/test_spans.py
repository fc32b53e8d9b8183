"""Spans of a conversation: every node and tool once, in a tree, by the OpenInference convention; and to a collector."""

from __future__ import annotations

import http.server
import json
import threading
from pathlib import Path

import pytest

from agent.chat import Conversation


class Collector(http.server.BaseHTTPRequestHandler):
    """Keeps what it is sent."""

    got: list[dict] = []  # noqa: RUF012
    arrived = threading.Event()

    def do_POST(self) -> None:
        """One export."""
        Collector.got.append(json.loads(self.rfile.read(int(self.headers["Content-Length"]))))
        self.send_response(200)
        self.end_headers()
        Collector.arrived.set()

    def log_message(self, *_: object) -> None:
        """Says nothing."""


def test_spans_are_a_tree_of_nodes_and_tools(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One AGENT span a turn; each tool within its node; ids are hex of the protocol's length; the collector has the same."""
    server = http.server.HTTPServer(("127.0.0.1", 0), Collector)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    monkeypatch.setenv("RAGVLM_OTLP", f"http://127.0.0.1:{server.server_port}")
    with Conversation.open(
        "single_cube", 10_001, thread="t", threads=tmp_path / "t.sqlite", perception="oracle", evaluator="analytic"
    ) as talk:
        list(talk.say("pick up the cube"))
        assert talk.folder is not None
        spans = [json.loads(line) for line in (talk.folder / "spans.jsonl").read_text().splitlines()]
    assert Collector.arrived.wait(10.0)
    server.shutdown()
    by_id = {span["context"]["span_id"]: span for span in spans}
    kinds = [span["attributes"]["openinference.span.kind"] for span in spans]
    assert kinds.count("AGENT") == 1
    parents = {s["name"]: by_id[s["parent_id"]]["name"] for s in spans if s["parent_id"] is not None}
    assert parents["perceive"] == "look"
    assert parents["execute_grasp"] == "act"
    assert parents["plan_grasp"] == "plan"
    assert len({span["context"]["trace_id"] for span in spans}) == 1
    assert all(len(span["context"]["trace_id"]) == 32 and len(span["context"]["span_id"]) == 16 for span in spans)
    assert all(span["end_time"] >= span["start_time"] for span in spans)
    sent = Collector.got[0]["resourceSpans"][0]["scopeSpans"][0]["spans"]
    assert {span["spanId"] for span in sent} == set(by_id)
