"""Percepts, plans, attempts and constraints as rows of plain data for the page's panels."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from app.steps import NOTHING_NEAR
from app.web.hands import hand_shape
from app.web.view import Candidate

UNITS = {
    "mm": (1.0, "mm", 1),
    "m": (1000.0, "mm", 1),
    "n": (1.0, "N", 1),
    "deg": (1.0, "°", 1),
    "rad": (57.29578, "°", 1),
    "kg": (1000.0, "g", 0),
}
"""Ending of a measurement's name -> scale, unit and digits shown."""


def object_row(thing: Any) -> dict[str, Any]:
    """A perceived object in words and numbers."""
    return {
        "id": thing.id, "name": f"{thing.colour_name} {thing.category}", "confidence": round(thing.confidence, 2),
        "state": thing.state, "size": [round(side * 1000) for side in thing.size],
        "position": [round(value, 3) for value in thing.position],
        "parts": [part.region for part in thing.parts], "fragility": round(thing.affordance.fragility, 2),
    }  # fmt: skip


def candidates_of(plan: Any) -> list[Candidate]:
    """The chosen grasp and its rivals, the best first."""
    rivals = sorted((r for r in plan.alternatives if r[2] != plan.candidate), key=lambda rival: -rival[1])
    best = [Candidate(plan.candidate, plan.grasp, plan.quality.q if plan.score is None else plan.score, chosen=True)]
    return best + [Candidate(name, grasp, float(value), chosen=False) for grasp, value, name in rivals]


def plan_panel(plan: Any, name: str) -> dict[str, Any]:
    """The planned grasp of the thing of that name, the source of each number, and its rivals."""
    rows = [
        {
            "name": c.name, "score": round(c.score, 2), "chosen": c.chosen, "type": c.grasp.type,
            "force": round(c.grasp.force, 1), "opening": round(c.grasp.aperture * 1000),
            "tilt": round(math.degrees(math.acos(max(-1.0, min(1.0, -c.grasp.approach[2]))))),
            "yaw": round(math.degrees(c.grasp.yaw)), "hand": hand_shape(c.grasp),
        }
        for c in candidates_of(plan)[:8]
    ]  # fmt: skip
    grasp = plan.grasp
    values = {
        "position": ", ".join(f"{v:.3f}" for v in grasp.position) + " m", "yaw": f"{math.degrees(grasp.yaw):.0f}°",
        "approach": f"{rows[0]['tilt']}° off vertical", "aperture": f"{grasp.aperture * 1000:.0f} mm",
        "force": f"{grasp.force:.1f} N", "type": grasp.type, "standoff": f"{grasp.standoff * 1000:.0f} mm",
        "speed": f"{grasp.speed:.2f} of full",
    }  # fmt: skip
    sources = [
        {
            "field": field,
            "value": value,
            "sources": [{"source": s.source, "id": s.id} for s in plan.provenance.get(field, ())],
        }
        for field, value in values.items()
    ]
    clear = None if plan.clearance >= NOTHING_NEAR else millimetres(plan.clearance)
    return {
        "target": name, "region": plan.region, "quality": round(plan.quality.q, 2), "clearance": clear,
        "candidates": rows, "rejected": plan.rejected, "provenance": sources,
    }  # fmt: skip


def lamps(watched: Sequence[dict[str, Any]], result: Any) -> list[dict[str, Any]]:
    """The constraints after a turn: inferred ones with their reasons, required ones with what the observer measured."""
    rows = []
    for item in result.constraints:
        own = _reason(watched, item)
        state = "kept" if item.satisfied else "broken"
        measured = [measurement(key, value) for key, value in item.measured.items()]
        reason = own.get("reason") or ("" if item.inferred else "required by the task; the agent did not infer it")
        rows.append(
            {"kind": item.kind, "target": item.target, "reason": reason, "gap": own.get("gap"), "state": state,
             "measured": measured[:6]}
        )  # fmt: skip
    return rows or list(watched)


def is_lamp(row: Any) -> bool:
    """Whether it has what a page draws of a constraint; a session's file may hold anything."""
    keys = ("kind", "target", "reason", "state")
    return (
        isinstance(row, dict)
        and all(isinstance(row.get(key), str) for key in keys)
        and isinstance(row.get("gap"), int | None)
        and isinstance(row.get("measured"), list)
    )


def _reason(watched: Sequence[dict[str, Any]], item: Any) -> dict[str, Any]:
    """The watched row that a measured constraint came from; empty if several could be meant.

    The robot speaks of what it saw ("grey vase (obj_0)"), the observer of the scene's own names ("vase").
    """
    same = [row for row in watched if row["kind"] == item.kind] if item.inferred else []
    if len(same) > 1:
        words = set(item.target.split("_"))
        same = [row for row in same if words & set(row["target"].replace("_", " ").split())]
    return same[0] if len(same) == 1 else {}


def measurement(key: str, value: Any) -> str:
    """A measured value with its unit, which the key ends with: "moved_m" 0.004 is "moved 4.0 mm"."""
    stem, _, unit = key.rpartition("_")
    if isinstance(value, int | float) and not isinstance(value, bool) and unit in UNITS:
        scale, name, digits = UNITS[unit]
        return f"{stem.replace('_', ' ')} {value * scale:.{digits}f} {name}"
    if isinstance(value, float):
        value = f"{value:.3g}"
    return f"{key.replace('_', ' ')} {str(value)[:40]}"


def millimetres(metres: float | None) -> int | None:
    """Metres as whole millimetres."""
    return None if metres is None else round(metres * 1000)
