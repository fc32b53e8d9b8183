"""Prints the steps of a run as they happen: Thought, Action, Observation and what lies between, with measured numbers."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from app.words import WordsPrinter

if TYPE_CHECKING:
    from rich.console import Console

    from kb.sensing import Plan

LABELS: dict[str, tuple[str, str]] = {
    "understood": ("Goal", "bold"),
    "look": ("Look", "cyan"),
    "grounding": ("Meant", "cyan"),
    "retrieved": ("Experience", "blue"),
    "graphed": ("Scene graph", "blue"),
    "constrained": ("Constraints", "yellow"),
    "planned": ("Plan", "blue"),
    "thought": ("Thought", "bold magenta"),
    "approval": ("Approval", "bold yellow"),
    "action": ("Action", "bold green"),
    "observation": ("Observation", "bold cyan"),
    "reflection": ("Reflection", "bold magenta"),
    "remembered": ("Memory", "blue"),
    "model_call": ("Model", "dim"),
    "reply_refused": ("Refused", "yellow"),
    "fallback": ("Rules", "bold yellow"),
    "named": ("Named", "cyan"),
    "sub_goal": ("First", "bold"),
    "question": ("Question", "bold yellow"),
    "answer": ("Answer", "bold"),
}
"""Kind of step -> what stands in front of it, and how."""
NOTHING_NEAR = 0.5
"""From this clearance on the number says nothing [m]."""
WIDTH = 13
"""Column at which the text of a step begins."""


class StepPrinter:
    """Prints each step once, in order."""

    def __init__(self, console: Console) -> None:
        self._console = console
        self._words = WordsPrinter(console, WIDTH)

    def end_words(self) -> None:
        """Ends the line on which a model's words grow, before anything else is printed."""
        self._words.end()

    def show(self, step: Any) -> None:
        """Prints a step of `agent.events`: its sentence, and under it the numbers that belong to it."""
        from rich.text import Text

        from agent.chat.heard import inert

        if step.kind == "saying":
            self._words.show(step)
            return
        self._words.end()
        label, style = LABELS.get(step.kind, (step.kind.capitalize(), "bold"))
        # A model's thought may hold anything; nothing of it may steer the terminal.
        text = inert(str(step.text))
        first, *rest = text.splitlines() or [""]
        line = Text(f"{label:<{WIDTH}}", style=style)
        line.append(first, style="default")
        self._console.print(line)
        details = DETAILS.get(step.kind)
        for extra in [*rest, *(line for line in (details(step) if details else ()) if line not in text)]:
            self._console.print(Text(" " * WIDTH + inert(extra), style="dim"))


def _look(step: Any) -> list[str]:
    """What was seen, with confidence and measured size."""
    lines = []
    if step.percept.perception == "oracle":
        lines.append("oracle perception: read from the simulator's truth, not seen")
    for thing in step.percept.objects:
        size = " x ".join(f"{side * 1000:.0f}" for side in thing.size)
        x, y, z = thing.position
        state = "" if thing.state == "empty" else f", {thing.state}"
        lines.append(
            f"{thing.id} {thing.colour_name} {thing.category} {thing.confidence:.2f}{state}: "
            f"({x:.3f}, {y:.3f}, {z:.3f}) m, {size} mm"
        )
    return lines


def _retrieved(step: Any) -> list[str]:
    """The best experiences with the three scores."""
    funnel = step.retrieval.funnel
    lines = [
        f"{item.experience.id} score {item.score:.3f} = category {item.s_cat:.2f}, affordance {item.s_aff:.2f}, "
        f"looks {item.s_vis:.2f}; {item.experience.n_success}/{item.experience.n_trials} trials succeeded"
        for item in step.retrieval.top
    ]
    # The step's own sentence has the funnel already, where there is nothing to add.
    return [f"funnel {funnel.total} > {funnel.level1} > {funnel.level2} > {funnel.level3}", *lines] if lines else []


def _graphed(step: Any) -> list[str]:
    """The relations that matter for grasping, each said once; where things lie from each other is in the record."""
    from tools.draw_scene_graph import ARROWS, distinct_edges

    lines = []
    for edge in distinct_edges(step.graph):
        if edge.relation in ARROWS:
            gap = "" if edge.gap is None else f" ({edge.gap * 1000:.0f} mm)"
            lines.append(f"{edge.source} {edge.relation} {edge.target}{gap}")
    return lines


def _constrained(step: Any) -> list[str]:
    return [item.reason for item in step.constraints.active]


def _planned(step: Any) -> list[str]:
    """The grasp, and where each of its numbers comes from."""
    if step.plan is None:
        return []
    return [grasp_line(step.plan), *provenance_lines(step.plan)]


def grasp_line(plan: Plan) -> str:
    """The grasp's numbers on one line."""
    grasp = plan.grasp
    x, y, z = grasp.position
    tilt = math.degrees(math.acos(max(-1.0, min(1.0, -grasp.approach[2]))))
    free = "nothing near" if plan.clearance >= NOTHING_NEAR else f"clearance {plan.clearance * 1000:.0f} mm"
    return (
        f"at ({x:.3f}, {y:.3f}, {z:.3f}) m, approach {tilt:.0f} deg off vertical, yaw {math.degrees(grasp.yaw):.0f} deg, "
        f"opening {grasp.aperture * 1000:.0f} mm, force {grasp.force:.1f} N, {grasp.type}; "
        f"quality {plan.quality.q:.2f}, {free}"
    )


def provenance_lines(plan: Plan) -> list[str]:
    """One line a field: the sources of its value, in order."""
    lines = []
    for field, sources in plan.provenance.items():
        words = ", ".join(f"{s.source} {s.id}" if s.id and s.id != s.source else s.source for s in sources)
        lines.append(f"{field}: {words}")
    return lines


def _observation(step: Any) -> list[str]:
    """What the robot sensed of the grip."""
    sensed = step.sensing
    if sensed is None:
        return []
    return [
        f"fingers {sensed.aperture_start * 1000:.1f} > {sensed.aperture_closed * 1000:.1f} > "
        f"{sensed.aperture_end * 1000:.1f} mm, motor {sensed.motor_force_end:.1f} N, "
        f"load {sensed.load_end * 1000:.0f} g, lifted {sensed.lift_height * 100:.1f} cm, held {sensed.held_s:.1f} s"
    ]


DETAILS: dict[str, Callable[[Any], list[str]]] = {
    "look": _look,
    "retrieved": _retrieved,
    "graphed": _graphed,
    "constrained": _constrained,
    "planned": _planned,
    "observation": _observation,
}
