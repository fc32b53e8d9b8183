"""Models made by hand for tests: a chat that replies from a list, and a server on loopback that misbehaves on demand."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from agent.brains.chat import Prompt, Reply


def think(**changes: Any) -> str:
    """A valid reply to "think": act on the plan as it is."""
    reply = {
        "thought": "It stands free.", "choice": "act", "candidate": 0, "force_n": 0, "opening_mm": 0,
        "speed_percent": 0, "question": "",
    }  # fmt: skip
    return json.dumps(reply | changes)


def understand(*goals: dict[str, Any], refusal: str = "", question: str = "") -> str:
    """A valid reply to "understand"."""
    empty = {"thing": "", "place": "", "measure": "none", "force_n": 0}
    return json.dumps({"goals": [empty | goal for goal in goals], "refusal": refusal, "question": question})


GOOD: dict[str, str] = {
    "understand": understand({"action": "pick", "thing": "the cube"}),
    "think": think(),
    "reflect": json.dumps({"thought": "It slipped.", "choice": 0, "give_up": False}),
    "answer": json.dumps({"text": "That is what happened."}),
    "perceive": json.dumps({"objects": [], "relations": []}),
}
"""A sensible reply for every question."""


class ScriptedChat:
    """Replies from a function of the prompt, and remembers what it was asked."""

    name = "scripted"

    def __init__(self, reply: Callable[[Prompt, int], str] | None = None, *, sees: bool = True) -> None:
        self._reply = reply or (lambda prompt, _count: GOOD[prompt.role])
        self.sees = sees
        self.prompts: list[Prompt] = []

    def reply(self, prompt: Prompt) -> Reply:
        """The next reply; tokens are counted as words."""
        self.prompts.append(prompt)
        text = self._reply(prompt, len(self.prompts) - 1)
        return Reply(text, sum(len(m.text.split()) for m in prompt.messages), len(text.split()))


Behaviour = tuple[str, Any]
"""What the server does with one request: ("ok", text), ("status", code), ("cut", text), ..."""


class FaultServer:
    """An OpenAI-compatible server that does what its script says, one entry a request, the last one for ever."""

    def __init__(self, *script: Behaviour) -> None:
        self.script = list(script)
        self.requests: list[dict[str, Any]] = []
        self.keys: list[str] = []
        self.over = threading.Event()
        outer = self

        class Handler(BaseHTTPRequestHandler):
            protocol_version = "HTTP/1.1"

            def log_message(self, format: str, *args: Any) -> None:
                """Silent."""

            def do_GET(self) -> None:
                self._json(
                    200, {"object": "list", "data": [{"id": "good", "object": "model", "created": 0, "owned_by": "x"}]}
                )

            def do_POST(self) -> None:
                body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
                outer.requests.append(body)
                outer.keys.append(self.headers.get("Authorization", ""))
                kind, value = outer.script.pop(0) if len(outer.script) > 1 else outer.script[0]
                if kind == "by_role":
                    role = body["response_format"]["json_schema"]["name"]
                    kind, value = "ok", value[role]
                getattr(self, f"_{kind}")(value)

            def _ok(self, text: str) -> None:
                self._start()
                for piece in (text[: len(text) // 2], text[len(text) // 2 :]):
                    self._event({"choices": [{"index": 0, "delta": {"role": "assistant", "content": piece}}]})
                self._event({"choices": [{"index": 0, "delta": {}, "finish_reason": "stop"}]})
                self._event({"choices": [], "usage": {"prompt_tokens": 7, "completion_tokens": 3, "total_tokens": 10}})
                self._chunk(b"data: [DONE]\n\n")
                self._chunk(b"")

            def _cut(self, text: str) -> None:
                self._start()
                self._event({"choices": [{"index": 0, "delta": {"role": "assistant", "content": text}}]})
                self.close_connection = True

            def _hang(self, _value: Any) -> None:
                outer.over.wait(20.0)
                self.close_connection = True

            def _status(self, value: tuple[int, str, dict[str, str]]) -> None:
                code, message, headers = value
                self._json(code, {"error": {"message": message, "type": "x", "code": code}}, headers)

            def _garbage(self, value: bytes) -> None:
                self.send_response(200)
                self.send_header("Content-Type", "text/event-stream")
                self.send_header("Content-Length", str(len(value)))
                self.end_headers()
                self.wfile.write(value)

            def _start(self) -> None:
                self.send_response(200)
                self.send_header("Content-Type", "text/event-stream")
                self.send_header("Transfer-Encoding", "chunked")
                self.end_headers()

            def _event(self, row: dict[str, Any]) -> None:
                full = {"id": "1", "object": "chat.completion.chunk", "created": 0, "model": "good", **row}
                self._chunk(b"data: " + json.dumps(full).encode() + b"\n\n")

            def _chunk(self, blob: bytes) -> None:
                self.wfile.write(f"{len(blob):x}\r\n".encode() + blob + b"\r\n")
                self.wfile.flush()

            def _json(self, code: int, value: Any, headers: dict[str, str] | None = None) -> None:
                blob = json.dumps(value).encode()
                self.send_response(code)
                self.send_header("Content-Type", "application/json")
                self.send_header("Content-Length", str(len(blob)))
                for name, text in (headers or {}).items():
                    self.send_header(name, text)
                self.end_headers()
                self.wfile.write(blob)

        self._server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self._server.daemon_threads = True
        self.url = f"http://127.0.0.1:{self._server.server_address[1]}/v1"

    def start(self) -> None:
        """Serves in a thread."""
        threading.Thread(target=self._server.serve_forever, args=(0.01,), daemon=True).start()

    def stop(self) -> None:
        """Lets hanging requests go and ends."""
        self.over.set()
        self._server.shutdown()
        self._server.server_close()


@contextmanager
def fault_server(*script: Behaviour) -> Iterator[FaultServer]:
    """A running server."""
    server = FaultServer(*script)
    server.start()
    try:
        yield server
    finally:
        server.stop()


def status(code: int, message: str = "no", **headers: str) -> Behaviour:
    """An error reply."""
    return ("status", (code, message, {name.replace("_", "-"): text for name, text in headers.items()}))
