"""Traces by the OpenInference convention: one span for each turn, node, tool and model call, a JSON line each.

Written into the session's folder as `spans.jsonl`. The attribute names are those of OpenInference's semantic conventions
(`openinference.span.kind`, `input.value`, `output.value`, `llm.model_name`, ...). Values are cut off, so that the file
stays small; of the world's snapshots nothing is in it. With `RAGVLM_OTLP` set they go to a collector, too.
"""

from __future__ import annotations

import json
import secrets
import threading
import time
from pathlib import Path
from typing import Any, TextIO
from uuid import UUID

from langchain_core.callbacks import BaseCallbackHandler

from agent.chat import otlp

LONGEST = 2_000
"""Characters of an input or output that a span keeps."""
MAX_BYTES = 20_000_000
"""The file begins anew (the former one is kept as `spans.1.jsonl`) at this size."""
NO_PARENT = None


class Spans(BaseCallbackHandler):
    """Listens to a graph's run and writes its spans; that one cannot be written costs nothing but the span."""

    def __init__(self, folder: Path, thread: str) -> None:
        self._file = folder / "spans.jsonl"
        self._thread = thread
        self._open: dict[UUID, dict[str, Any]] = {}
        self._traces: dict[UUID, str] = {}
        self._lock = threading.Lock()
        self._collector = otlp.address()
        self._ended: list[dict[str, Any]] = []
        self._stream: TextIO | None = None

    # Nodes of the graph; a run without a parent is the turn --------------------------------------------------------

    def on_chain_start(
        self, serialized: dict[str, Any], inputs: Any, *, run_id: UUID, parent_run_id: UUID | None = None, **kwargs: Any
    ) -> None:
        """A node, a route or the whole turn begins."""
        name = str(kwargs.get("name") or (serialized or {}).get("name") or "chain")
        kind = "AGENT" if parent_run_id is None else "CHAIN"
        self._begin(run_id, parent_run_id, name, kind, _brief(inputs))

    def on_chain_end(self, outputs: Any, *, run_id: UUID, **_: Any) -> None:
        """It ended."""
        self._end(run_id, _brief(outputs))

    def on_chain_error(self, error: BaseException, *, run_id: UUID, **_: Any) -> None:
        """It failed, or waits for a person."""
        waits = type(error).__name__ == "GraphInterrupt"
        self._end(run_id, "waits for a person" if waits else "", None if waits else error)

    # Tools ----------------------------------------------------------------------------------------------------------

    def on_tool_start(
        self, serialized: dict[str, Any], input_str: str, *, run_id: UUID, parent_run_id: UUID | None = None, **_: Any
    ) -> None:
        """A tool is used."""
        name = str((serialized or {}).get("name") or "tool")
        self._begin(run_id, parent_run_id, name, "TOOL", input_str, {"tool.name": name})

    def on_tool_end(self, output: Any, *, run_id: UUID, **_: Any) -> None:
        """It gave its result."""
        self._end(run_id, _brief(output))

    def on_tool_error(self, error: BaseException, *, run_id: UUID, **_: Any) -> None:
        """It failed."""
        self._end(run_id, "", error)

    # Models ---------------------------------------------------------------------------------------------------------

    def on_chat_model_start(
        self, serialized: dict[str, Any], messages: list[list[Any]], *, run_id: UUID, parent_run_id: UUID | None = None,
        **kwargs: Any,
    ) -> None:  # fmt: skip
        """A language model is asked."""
        asked = kwargs.get("invocation_params") or {}
        model = str(asked.get("model") or asked.get("model_name") or (serialized or {}).get("name") or "model")
        text = "\n".join(f"{m.type}: {m.content}" for batch in messages for m in batch)
        self._begin(run_id, parent_run_id, model, "LLM", text, {"llm.model_name": model})

    def on_llm_end(self, response: Any, *, run_id: UUID, **_: Any) -> None:
        """It answered."""
        usage = (getattr(response, "llm_output", None) or {}).get("token_usage") or {}
        counted = {
            f"llm.token_count.{ours}": usage[theirs]
            for ours, theirs in (
                ("prompt", "prompt_tokens"),
                ("completion", "completion_tokens"),
                ("total", "total_tokens"),
            )
            if theirs in usage
        }
        said = [g.text for batch in getattr(response, "generations", []) for g in batch]
        self._end(run_id, "\n".join(said), attributes=counted)

    def on_llm_error(self, error: BaseException, *, run_id: UUID, **_: Any) -> None:
        """It failed."""
        self._end(run_id, "", error)

    def close(self) -> None:
        """Nothing is written any more, until the next span."""
        with self._lock:
            if self._stream is not None:
                self._stream.close()
                self._stream = None

    # Writing --------------------------------------------------------------------------------------------------------

    def _begin(
        self, run: UUID, parent: UUID | None, name: str, kind: str, given: str, more: dict[str, Any] | None = None
    ) -> None:
        with self._lock:
            trace = self._traces.get(parent) if parent is not None else None
            self._traces[run] = trace or secrets.token_hex(16)
            above = self._open.get(parent) if parent is not None else None
            self._open[run] = {
                "name": name,
                "context": {"trace_id": self._traces[run], "span_id": secrets.token_hex(8)},
                "parent_id": above["context"]["span_id"] if above is not None else NO_PARENT,
                "start_time": time.time_ns(),
                "attributes": {
                    "openinference.span.kind": kind,
                    "session.id": self._thread,
                    "input.value": given[:LONGEST],
                    "input.mime_type": "text/plain",
                    **(more or {}),
                },
            }

    def _end(
        self, run: UUID, given: str, error: BaseException | None = None, attributes: dict[str, Any] | None = None
    ) -> None:
        with self._lock:
            span = self._open.pop(run, None)
            self._traces.pop(run, None)
            if span is None:
                return
            span["end_time"] = time.time_ns()
            span["status"] = {"status_code": "OK" if error is None else "ERROR"}
            if error is not None:
                span["status"]["description"] = f"{type(error).__name__}: {error}"[:LONGEST]
            span["attributes"] |= {
                "output.value": given[:LONGEST],
                "output.mime_type": "text/plain",
                **(attributes or {}),
            }
            self._write(span)
            if self._collector is not None:
                self._ended.append(span)
                if span["parent_id"] is None:  # the turn is over
                    otlp.send(self._ended, self._collector)
                    self._ended = []

    def _write(self, span: dict[str, Any]) -> None:
        try:
            if self._stream is not None and self._stream.tell() > MAX_BYTES:
                self._stream.close()
                self._stream = None
                self._file.replace(self._file.with_name("spans.1.jsonl"))
            if self._stream is None:  # it stays open: a turn has some fifty spans
                self._file.parent.mkdir(parents=True, exist_ok=True)
                self._stream = self._file.open("a", encoding="utf-8")
            self._stream.write(json.dumps(span) + "\n")
            self._stream.flush()
        except OSError:
            return


def _brief(value: Any) -> str:
    """What is worth keeping of a node's input or output: words and counts, never snapshots or pictures."""
    if isinstance(value, dict):
        kept = {
            key: _plain(item) for key, item in value.items() if key not in ("world", "memory", "messages", "attempts")
        }
        return json.dumps(kept, default=str)[:LONGEST]
    instruction = getattr(value, "instruction", None)
    return str(instruction)[:LONGEST] if instruction is not None else _plain(value)[:LONGEST]


def _plain(value: Any) -> str:
    if isinstance(value, bytes):
        return f"{len(value)} bytes"
    if isinstance(value, tuple | list):
        return f"{len(value)} items" if len(value) > 3 else "; ".join(_plain(item)[:300] for item in value)
    return str(value)[:500]
