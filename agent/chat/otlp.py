"""Spans to a collector by OTLP over HTTP, encoded as JSON: switched on by `RAGVLM_OTLP=http://HOST:4318`."""

from __future__ import annotations

import json
import os
import threading
import urllib.error
import urllib.request
from typing import Any

PATIENCE_S = 3.0
"""How long a collector may take [s]; one that does not answer costs its spans, not the conversation."""


def address() -> str | None:
    """Where spans go, or None."""
    base = os.environ.get("RAGVLM_OTLP", "").strip().rstrip("/")
    return f"{base}/v1/traces" if base.startswith(("http://", "https://")) else None


def send(spans: list[dict[str, Any]], to: str) -> threading.Thread:
    """Sends finished spans in a thread of its own."""
    body = json.dumps(encoded(spans)).encode()

    def post() -> None:
        request = urllib.request.Request(to, body, {"Content-Type": "application/json"})
        try:
            urllib.request.urlopen(request, timeout=PATIENCE_S).close()
        except (OSError, urllib.error.URLError, ValueError):
            return

    thread = threading.Thread(target=post, name="ragvlm-otlp", daemon=True)
    thread.start()
    return thread


def encoded(spans: list[dict[str, Any]]) -> dict[str, Any]:
    """The spans as an OTLP ExportTraceServiceRequest in JSON (OpenTelemetry protocol, JSON encoding)."""
    service = [{"key": "service.name", "value": {"stringValue": "ragvlm"}}]
    return {
        "resourceSpans": [
            {
                "resource": {"attributes": service},
                "scopeSpans": [{"scope": {"name": "ragvlm"}, "spans": [_span(span) for span in spans]}],
            }
        ]
    }


def _span(span: dict[str, Any]) -> dict[str, Any]:
    good = span["status"]["status_code"] == "OK"
    return {
        "traceId": span["context"]["trace_id"],
        "spanId": span["context"]["span_id"],
        **({"parentSpanId": span["parent_id"]} if span["parent_id"] else {}),
        "name": span["name"],
        "kind": 1,
        "startTimeUnixNano": str(span["start_time"]),
        "endTimeUnixNano": str(span["end_time"]),
        "attributes": [{"key": key, "value": _value(value)} for key, value in span["attributes"].items()],
        "status": {"code": 1 if good else 2, "message": span["status"].get("description", "")},
    }


def _value(value: Any) -> dict[str, Any]:
    return {"intValue": str(value)} if isinstance(value, int) else {"stringValue": str(value)}
