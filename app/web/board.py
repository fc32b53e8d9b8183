"""What the panels beside the 3D view show, as plain data, kept up to date by the steps of the conversation.

Every number comes from a typed field of a step, a result or the robot's sensors; no text is parsed.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from typing import Any

from app.timeline import Timeline
from app.web.rows import lamps, millimetres, object_row, plan_panel


class Board:
    """The panels' contents. `tell(part, value)` is called whenever a part changes."""

    def __init__(self, tell: Callable[[str, Any], None]) -> None:
        self._tell = tell
        self._lock = threading.RLock()
        self.parts: dict[str, Any] = {}
        self.timeline = Timeline(lambda rows: self.put("attempts", rows))
        """The motions with their forces."""
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
        self.timeline.on_step(step)
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
        self._see(step.percept)

    def _see(self, percept: Any) -> None:
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
        self.put("constraints", self._watched(step.constraints))

    def _watched(self, constraints: Any) -> list[dict[str, Any]]:
        """The lamps of constraints that nobody has measured yet."""
        return [
            {"kind": c.kind, "target": self.name(c.target), "reason": c.reason, "gap": millimetres(c.gap), "state": "watched",
             "measured": []}
            for c in constraints.active
        ]  # fmt: skip

    def _on_planned(self, step: Any) -> None:
        self.put("plan", None if step.plan is None else plan_panel(step.plan, self.name(step.plan.target)))

    def _on_action(self, step: Any) -> None:
        if step.plan is not None:
            self.put("plan", plan_panel(step.plan, self.name(step.plan.target)))

    def restore(self, state: Any, measured: Sequence[dict[str, Any]]) -> None:
        """The panels of a conversation that was left: what it saw, planned and tried, and the lamps as last `measured`."""
        with self._lock:
            if state.percept is not None:
                self._see(state.percept)
            if state.plan is not None:
                self.put("plan", plan_panel(state.plan, self.name(state.plan.target)))
            self.put("constraints", list(measured) or self._watched(state.constraints))

    # Steps of the conversation ------------------------------------------------------------------------------------

    def _on_asked(self, step: Any) -> None:
        self.pending(step)

    def _on_finished(self, step: Any) -> None:
        if step.result.constraints and step.result.executed:
            self.put("constraints", lamps(self.parts["constraints"], step.result))

    # Between steps ------------------------------------------------------------------------------------------------

    def pending(self, asked: Any) -> None:
        """The motion that waits for a person's word: a proposal, or the step that tells of it; with what can be changed."""
        plan, place = asked.plan, asked.motion == "place"
        if place:
            numbers = {} if asked.point is None else dict(zip(("x", "y"), asked.point, strict=True))
            question = asked.text if hasattr(asked, "text") else asked.question
        else:
            self.put("plan", plan_panel(plan, self.name(plan.target)))
            grasp = plan.grasp.model_dump(mode="json")
            numbers = {name: grasp[name] for name in ("force", "aperture", "yaw", "standoff", "speed")}
            question = f"May I grasp the {self.name(plan.target)}?"
        self.put("pending", {"question": question, "numbers": numbers, "thought": asked.thought})

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
