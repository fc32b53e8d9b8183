"""What the panels beside the 3D view show, as plain data, kept up to date by the steps of the conversation.

Every number comes from a typed field of a step, a result or the robot's sensors; no text is parsed.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Sequence
from typing import Any

from app.steps import NOTHING_NEAR
from app.web.view import Candidate

CURVE_POINTS = 240
"""Most points of a force curve sent to a page."""
UNITS = {
    "mm": (1.0, "mm", 1),
    "m": (1000.0, "mm", 1),
    "n": (1.0, "N", 1),
    "deg": (1.0, "°", 1),
    "rad": (57.29578, "°", 1),
    "kg": (1000.0, "g", 0),
}
"""Ending of a measurement's name -> scale, unit and digits shown."""
MAX_ATTEMPTS = 24
"""Attempts kept on the timeline."""


class Board:
    """The panels' contents. `tell(part, value)` is called whenever a part changes."""

    def __init__(self, tell: Callable[[str, Any], None]) -> None:
        self._tell = tell
        self._lock = threading.RLock()
        self.parts: dict[str, Any] = {}
        self.clear()

    def clear(self) -> None:
        """As before anything was said."""
        for name, empty in (("look", None), ("graph", []), ("constraints", []), ("plan", None), ("attempts", []),
                            ("memory", []), ("pictures", {}), ("pending", None), ("experiences", None)):  # fmt: skip
            self.put(name, empty)

    def put(self, part: str, value: Any) -> None:
        """Replaces one part."""
        self.parts[part] = value
        self._tell(part, value)

    def on_step(self, step: Any) -> None:
        """Takes from a step what belongs on a panel."""
        take = getattr(self, f"_on_{step.kind}", None)
        if take is not None:
            with self._lock:
                take(step)

    def name(self, object_id: str) -> str:
        """What a perceived object looks like, before its id: "magenta cup (obj_1)"."""
        rows = (self.parts["look"] or {}).get("objects", ())
        found = next((row["name"] for row in rows if row["id"] == object_id), None)
        return object_id if found is None else f"{found} ({object_id})"

    # Steps of the task graph --------------------------------------------------------------------------------------

    def _on_understood(self, step: Any) -> None:
        if any(goal.kind not in ("look", "answer") for goal in step.goals):
            self.put("plan", None)
            self.put("constraints", [])

    def _on_look(self, step: Any) -> None:
        percept = step.percept
        rows = [object_row(thing) for thing in percept.objects]
        target = (self.parts["look"] or {}).get("target")
        self.put("look", {"number": percept.look, "by": percept.perception, "objects": rows, "target": target})

    def _on_grounding(self, step: Any) -> None:
        if self.parts["look"] is not None:
            self.put("look", {**self.parts["look"], "target": step.target})

    def _on_retrieved(self, step: Any) -> None:
        rows = [
            {
                "id": item.experience.id, "score": round(item.score, 3), "category": round(item.s_cat, 2),
                "affordance": round(item.s_aff, 2), "looks": round(item.s_vis, 2),
                "worked": item.experience.n_success, "of": item.experience.n_trials,
            }
            for item in step.retrieval.top
        ]  # fmt: skip
        funnel = step.retrieval.funnel
        self.put("experiences", {"funnel": [funnel.total, funnel.level1, funnel.level2, funnel.level3], "top": rows})

    def _on_graphed(self, step: Any) -> None:
        from tools.draw_scene_graph import ARROWS, distinct_edges

        rows = [
            {"source": e.source, "relation": e.relation, "target": e.target, "gap": millimetres(e.gap)}
            for e in distinct_edges(step.graph)
        ]
        telling = sum(row["relation"] in ARROWS for row in rows)
        order = [*(r for r in rows if r["relation"] in ARROWS), *(r for r in rows if r["relation"] not in ARROWS)]
        self.put("graph", [{**row, "telling": number < telling} for number, row in enumerate(order)][:60])

    def _on_constrained(self, step: Any) -> None:
        rows = [
            {"kind": c.kind, "target": self.name(c.target), "reason": c.reason, "gap": millimetres(c.gap), "state": "watched",
             "measured": []}
            for c in step.constraints.active
        ]  # fmt: skip
        self.put("constraints", rows)

    def _on_planned(self, step: Any) -> None:
        self.put("plan", None if step.plan is None else plan_panel(step.plan, self.name(step.plan.target)))

    def _on_action(self, step: Any) -> None:
        if step.plan is not None:
            self.put("plan", plan_panel(step.plan, self.name(step.plan.target)))
        row = {
            "motion": step.motion, "attempt": step.attempt, "level": step.level, "tool": step.tool, "text": step.text,
            "force": step.plan.grasp.force if step.plan else None, "state": "moving", "failure": None,
            "observed": None, "curve": [], "phases": [], "note": "", "verdict": None,
        }  # fmt: skip
        self.put("attempts", [*self.parts["attempts"], row][-MAX_ATTEMPTS:])

    def _on_observation(self, step: Any) -> None:
        stopped = step.sensing is not None and step.sensing.stopped_by == "stop"
        state = "stopped" if stopped else "claimed" if step.claimed else "failed"
        self._last_attempt(state=state, failure=step.failure, note=step.text)

    def _on_reflection(self, step: Any) -> None:
        if step.correction is not None:
            self._last_attempt(correction=step.correction.rule)

    # Steps of the conversation ------------------------------------------------------------------------------------

    def _on_asked(self, step: Any) -> None:
        self.pending(step.plan, step.thought)

    def _on_finished(self, step: Any) -> None:
        result = step.result
        records = [record for goal in result.goals for record in goal.attempts]
        rows = list(self.parts["attempts"])
        # The last attempts on the timeline are those of this turn; placing motions carry no record of their own.
        grasps = [row for row in rows if row["tool"] == "execute_grasp"][-len(records) :] if records else []
        for row, record in zip(grasps, records, strict=False):
            row["observed"] = bool(record.success)
            row["observed_failure"] = record.observed_failure
            row["verdict"] = verdict_row(record.verdict)
        if records:
            self.put("attempts", rows)
        if result.constraints and result.executed:
            self.put("constraints", lamps(self.parts["constraints"], result))

    # Between steps ------------------------------------------------------------------------------------------------

    def pending(self, plan: Any, thought: str) -> None:
        """The motion that waits for a person's word."""
        self.put("plan", plan_panel(plan, self.name(plan.target)))
        grasp = plan.grasp.model_dump(mode="json")
        self.put("pending", {"grasp": grasp, "thought": thought, "target": self.name(plan.target)})

    def forces(self, rows: Sequence[dict[str, Any]]) -> None:
        """The forces sensed so far in the running motion, for the last attempt on the timeline. From any thread."""
        with self._lock:
            attempts = self.parts["attempts"]
            if attempts and rows and attempts[-1]["state"] == "moving":
                motion = rows[-1]["motion"]
                self._last_attempt(motion=motion, **curve([row for row in rows if row["motion"] == motion]))

    def remembered(self, items: Sequence[Any]) -> None:
        """What the episodic memory holds."""
        rows = [
            {
                "category": i.category, "type": i.type, "region": i.region, "force": round(i.force, 1),
                "aperture": round(i.aperture * 1000), "attempts": i.attempts, "source": i.source,
                "mass": None if i.mass is None else round(i.mass * 1000),
            }
            for i in items
        ]  # fmt: skip
        self.put("memory", rows)

    def _last_attempt(self, **changes: Any) -> None:
        rows = self.parts["attempts"]
        if rows:
            self.put("attempts", [*rows[:-1], {**rows[-1], **changes}])


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
            "yaw": round(math.degrees(c.grasp.yaw)),
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


def curve(rows: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Force samples thinned to what a plot can show, and where the phases begin."""
    start = rows[0]["t"]
    step = max(1, math.ceil(len(rows) / CURVE_POINTS))
    points = []
    for first in range(0, len(rows), step):
        part = rows[first : first + step]
        # Peaks must survive: of each group the largest value is kept.
        peak = [max(row[key] for row in part) for key in ("grip_n", "wrist_n")]
        points.append([round(part[0]["t"] - start, 2), round(peak[0], 2), round(peak[1], 2)])
    phases: list[list[Any]] = []
    for row in rows:
        if not phases or phases[-1][0] != row["phase"]:
            phases.append([row["phase"], round(row["t"] - start, 2)])
    return {"curve": points, "phases": phases}


def verdict_row(verdict: Any) -> dict[str, Any] | None:
    """The observer's measurements of one attempt."""
    if verdict is None:
        return None
    return {
        "lifted": round(verdict.lifted_m * 100, 1), "held": round(verdict.held_s, 1),
        "slip": round(verdict.slip_m * 1000, 1), "peak": round(verdict.peak_force_n, 1),
        "damage": list(verdict.damage), "disturbed": list(verdict.disturbed),
    }  # fmt: skip


def lamps(watched: Sequence[dict[str, Any]], result: Any) -> list[dict[str, Any]]:
    """The constraints after a turn: inferred ones with their reasons, required ones with what the observer measured."""
    rows = []
    reasons = {row["kind"]: row for row in watched}
    for item in result.constraints:
        own = reasons.get(item.kind, {})
        state = "kept" if item.satisfied else "broken"
        measured = [measurement(key, value) for key, value in item.measured.items()]
        reason = own.get("reason") or ("" if item.inferred else "required by the task; the agent did not infer it")
        rows.append(
            {"kind": item.kind, "target": item.target, "reason": reason, "gap": own.get("gap"), "state": state,
             "measured": measured[:6]}
        )  # fmt: skip
    return rows or list(watched)


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
