"""Two attempts side by side: which numbers, places and readings differed, and how each ended."""

from __future__ import annotations

from typing import Any

from agent import phrases
from agent.attempt import Attempt
from agent.chat.events import Compared, Difference
from agent.chat.explain import shown
from kb.grasp import Grasp

SAME = 1e-4
"""Numbers nearer than this, relative to the larger, count as the same."""


def compare(first: Attempt, second: Attempt) -> Compared:
    """What differed between two attempts."""
    rows = [
        Difference(field=name, first=_value(one), second=_value(two))
        for name, one, two in _pairs(first, second)
        if not _same(one, two) and shown(name, one) != shown(name, two)
    ]
    head = f"Attempt {first.number + 1} ({_end(first)}) and attempt {second.number + 1} ({_end(second)})"
    if not rows:
        text = f"{head} did not differ in anything that I recorded."
    else:
        text = "\n".join([f"{head} differ in:", *(_line(row) for row in rows)])
    return Compared(text=text, attempts=(first.number, second.number), rows=tuple(rows))


def _pairs(first: Attempt, second: Attempt) -> list[tuple[str, Any, Any]]:
    def seen(a: Attempt) -> dict[str, Any]:
        grasp = {name: getattr(a.plan.grasp, name) for name in Grasp.model_fields}
        return {
            "object": f"{phrases.plain(a.target.category)} ({a.target.id})",
            "level": a.level,
            "region": a.plan.region,
            "candidate": a.plan.candidate,
            **grasp,
            "quality": a.plan.quality.q,
            "clearance [mm]": a.plan.clearance * 1000,
            "correction": a.correction.rule if a.correction else "none",
            "constraints": ", ".join(f"{c.kind}:{c.target}" for c in a.constraints.active) or "none",
            "outcome": _end(a),
            "load [g]": a.sensing.load_end * 1000,
            "held [s]": a.sensing.held_s,
            "motor force [N]": a.sensing.motor_force_end,
            "opening at the end [mm]": a.sensing.aperture_end * 1000,
            "lift [cm]": a.sensing.lift_height * 100,
        }

    one, two = seen(first), seen(second)
    return [(name, one[name], two[name]) for name in one]


def _same(one: Any, two: Any) -> bool:
    if isinstance(one, float | int) and isinstance(two, float | int):
        return abs(one - two) <= SAME * max(abs(one), abs(two), 1e-3)
    if isinstance(one, tuple) and isinstance(two, tuple):
        return len(one) == len(two) and all(_same(a, b) for a, b in zip(one, two, strict=True))
    return one == two


def _value(value: Any) -> Any:
    return tuple(round(float(v), 6) for v in value) if isinstance(value, tuple) else value


def _line(row: Difference) -> str:
    return f"- {row.field}: {shown(row.field, row.first)} | {shown(row.field, row.second)}"


def _end(attempt: Attempt) -> str:
    return f"it {phrases.ended(attempt)}"
