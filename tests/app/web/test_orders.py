"""Laws of a page's orders: what is not known, too long or beyond the hand's limits is refused before anything happens."""

from __future__ import annotations

import json
from typing import Any

import pytest

from app.web.orders import parse_enter, parse_order
from kb.errors import BadInputError


@pytest.mark.parametrize(
    "order",
    [
        {"type": "edit", "force": 71.0},
        {"type": "edit", "force": 0.5},
        {"type": "edit", "aperture": 0.09},
        {"type": "edit", "speed": 5},
        {"type": "edit", "position": [0, 0, 0]},
        {"type": "say", "text": ""},
        {"type": "say", "text": "x" * 10_001},
        {"type": "speed", "value": 1000},
        {"type": "session", "action": "open", "thread": "../../etc/passwd"},
        {"type": "replay", "run": -1, "share": 0.5},
        {"type": "replay", "run": 0, "share": 2},
        {"type": "whatif", "force": 500},
        {"type": "exec", "code": "1"},
        {"type": "stop", "extra": 1},
        [],
        "stop",
    ],
)
def test_a_wrong_order_is_refused(order: Any) -> None:
    """Each wrong order is a BadInputError of one line, never another exception."""
    with pytest.raises(BadInputError) as caught:
        parse_order(json.dumps(order))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("raw", [b"\xff\xfe", "{", '{"type": "stop"', "[" * 5000, '{"type":"edit","force":NaN}'])
def test_garbage_is_refused(raw: str | bytes) -> None:
    """Bytes that are no JSON, cut or nested without end are refused the same way."""
    with pytest.raises(BadInputError):
        parse_order(raw)


def test_right_orders_pass() -> None:
    """Orders within the limits keep their values."""
    assert parse_order('{"type": "edit", "force": 12.5}').force == 12.5
    assert parse_order('{"type": "stop"}').type == "stop"
    assert parse_enter('{"type": "enter", "page": "0123456789abcdef"}').page == "0123456789abcdef"
    with pytest.raises(BadInputError):
        parse_enter('{"type": "enter", "page": "<script>"}')
