"""Figure: from the scene graph to constraints to the changed grasp, one real run per constraint type."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from bench.figures.drawing import (
    BLUE,
    BODY,
    GREEN,
    HEAD,
    INK,
    MUTED,
    ORANGE,
    RED,
    RULE,
    SMALL,
    TITLE,
    arrow,
    badge,
    picture,
    save,
    sheet,
    typeset,
    words,
)  # fmt: skip
from bench.figures.traced_run import Picture, TracedRun, trace
from kb.constraint import Adjustment
from kb.scene_graph import SceneGraph
from kb.vocabulary import INVERSE
from tools.draw_scene_graph import draw_scene_graph

CASES = (
    ("content", "filled_cup", 10_000, "pick up the cup"),
    ("collision", "cup_near_vase", 10_003, "pick up the cup"),
    ("support", "block_on_bowl", 10_000, "pick up the bowl"),
    ("occlusion", "ball_behind_box", 10_000, "pick up the ball"),
)
"""Constraint type, scene, seed, instruction."""
WIDTH, GAP, LEFT = 2.9, 0.22, 0.35
SHOWN = ("ON_TOP_OF", "CONTAINS", "ADJACENT_TO", "OCCLUDES", "BEHIND", "SUPPORTS", "BLOCKS_APPROACH", "TOUCHING")
"""Relations that are written on the graph's edges; directions like LEFT_OF hold between almost all pairs."""
CAMERA_SCALE = 2
MEASURED = {
    "force_n": "touched with {:.1f} N",
    "displacement_mm": "moved {:.1f} mm",
    "spilled": "{:.0%} spilled",
    "tilt_deg": "tilted {:.1f}°",
    "distance_mm": "set down {:.0f} mm away before the bowl was taken",
}
"""How the observer's numbers read."""


def draw(path: Path) -> Path:
    """Runs one scene per type and draws picture, graph, constraint and adjustment below each other."""
    width = 2 * LEFT + len(CASES) * WIDTH + (len(CASES) - 1) * GAP
    figure, axis = sheet(width, 8.75)
    words(axis, LEFT, 0.28, "From the scene graph to constraints to the grasp", size=TITLE, bold=True)
    note = "What the robot perceives (no scene truth), the relations that follow, and what they change in the grasp."
    words(axis, LEFT, 0.62, note, size=BODY, colour=MUTED)
    for number, (kind, scene, seed, instruction) in enumerate(CASES):
        _column(axis, LEFT + number * (WIDTH + GAP), kind, trace(scene, seed, instruction))
    return save(figure, path)


def _column(axis: Any, x: float, kind: str, run: TracedRun) -> None:
    """One constraint type."""
    # Before a support is lifted, what rests on it is taken off in a sub-goal: the first constraint of the kind counts.
    step = next(
        step for step in run.of_kind("constrained") if any(item.kind == kind for item in step.constraints.active)
    )
    constraint = next(item for item in step.constraints.active if item.kind == kind)
    graph: SceneGraph = run.of_kind("graphed")[0].graph
    view, percept = run.looks[0]
    target = run.of_kind("grounding")[0].target
    top = 1.02
    words(axis, x, top, kind, size=HEAD, bold=True)
    words(axis, x, top + 0.24, f"“{run.result.instruction}”", size=SMALL, colour=MUTED)
    pixels = around(draw_scene_graph(view, percept, target=target, scale=CAMERA_SCALE), view, percept)
    height = picture(axis, pixels, x, top + 0.48, WIDTH)
    badge(axis, x + 0.1, top + 0.59, "perceived", BLUE)
    y = top + 0.48 + height + 0.15
    _graph(axis, x, y, graph, target)
    y += 1.75
    words(axis, x, y, "Constraint", size=BODY, bold=True, colour=ORANGE)
    reason = constraint.reason[:1].upper() + constraint.reason[1:]
    words(axis, x, y + 0.19, typeset(reason), size=SMALL, wrap=45, most=4)
    y += 0.92
    words(axis, x, y, "Change of the grasp Δg", size=BODY, bold=True, colour=ORANGE)
    for line in adjustment_lines(step.constraints.adjustment, graph):
        y += 0.19
        words(axis, x, y, line, size=SMALL)
    y = 7.62
    words(axis, x, y, "Observed", size=BODY, bold=True, colour=GREEN)
    words(axis, x, y + 0.19, _observed(kind, run), size=SMALL, wrap=45, most=3)


def around(pixels: Picture, view: Any, percept: Any, ratio: float = 0.75) -> Picture:
    """The part of a camera picture that holds the perceived objects, with a margin; height over width is `ratio`."""
    from tools.draw_scene_graph import box_corners, project

    points = np.concatenate([project(view, box_corners(thing)) for thing in percept.objects]) * CAMERA_SCALE
    low, high = np.nanmin(points, axis=0), np.nanmax(points, axis=0)
    middle = (low + high) / 2
    wide = max(float(high[0] - low[0]) * 1.5, float(high[1] - low[1]) * 1.5 / ratio, 300.0)
    rows, columns = pixels.shape[:2]
    wide = min(wide, columns, rows / ratio)
    tall = wide * ratio
    left = int(np.clip(middle[0] - wide / 2, 0, columns - wide))
    above = int(np.clip(middle[1] - tall / 2, 0, rows - tall))
    return pixels[above : above + int(tall), left : left + int(wide)]


def _graph(axis: Any, x: float, y: float, graph: SceneGraph, target: str | None) -> None:
    """Nodes as discs from left to right as they lie on the table, with the telling relations between them."""
    from matplotlib.patches import Circle

    order = sorted(graph.nodes, key=lambda node: -node.position[1])
    step = WIDTH / max(len(order), 1)
    middle = {node.id: (x + step * (number + 0.5), y + 0.98) for number, node in enumerate(order)}
    for node in order:
        colour = ORANGE if node.id == target else RED if node.fragility >= 0.5 else MUTED
        axis.add_patch(Circle(middle[node.id], 0.27, facecolor="white", edgecolor=colour, linewidth=2.0, zorder=4))
        cx, cy = middle[node.id]
        axis.text(cx, cy, node.category.replace("_", "\n"), ha="center", va="center", fontsize=7.5, zorder=5, color=INK)
        state = "" if node.state == "empty" else f", {node.state}"
        words(axis, cx, cy + 0.33, f"fragility {node.fragility:.1f}{state}", size=7.5, colour=MUTED, align="center")
    pairs: dict[tuple[str, str], list[str]] = {}
    for edge in graph.edges:
        a, b = sorted((edge.source, edge.target), key=lambda name: middle[name][0])
        said = pairs.setdefault((a, b), [])
        inverse = (INVERSE.get(edge.relation) or "").lower().replace("_", " ")
        phrase = edge.relation.lower().replace("_", " ")
        if edge.relation in SHOWN and not any(line.strip("← →") in (phrase, inverse) for line in said):
            said.append(f"{phrase} →" if edge.source == a else f"← {phrase}")
    gaps = {frozenset((edge.source, edge.target)): edge.gap for edge in graph.edges if edge.gap is not None}
    for (a, b), said in pairs.items():
        if said:
            start, end = middle[a], middle[b]
            arrow(axis, (start[0] + 0.25, start[1]), (end[0] - 0.25, end[1]), INK, style="-", width=1.2)
            centre = (start[0] + end[0]) / 2
            for number, line in enumerate(reversed(said)):
                words(axis, centre, start[1] - 0.42 - 0.16 * number, line, size=7.5, align="center")
            gap = gaps.get(frozenset((a, b)))
            if gap is not None:
                words(axis, centre, start[1] + 0.06, f"{1000 * gap:.0f} mm", size=7.5, colour=MUTED, align="center")
    axis.plot([x, x + WIDTH], [y + 1.62, y + 1.62], color=RULE, linewidth=0.8)


def adjustment_lines(change: Adjustment, graph: SceneGraph) -> list[str]:
    """The parts of the adjustment vector that are active."""
    lines: list[str] = []
    if change.direction is not None:
        lines.append("approach d = (0, 0, −1)")
    if any(change.away):
        degrees = math.degrees(math.atan2(change.away[1], change.away[0]))
        lines.append(f"hand turned away from azimuth {degrees:.0f}°")
    if change.lateral is not None:
        degrees = math.degrees(math.atan2(change.lateral[1], change.lateral[0]))
        lines.append(f"lateral path, from azimuth {degrees:.0f}°")
    if change.force_scale != 1.0:
        lines.append(f"force f × {change.force_scale:g}")
    if change.standoff:
        lines.append(f"stand-off h + {1000 * change.standoff:.0f} mm")
    if change.speed != 1.0:
        lines.append(f"speed v ≤ {change.speed:g}")
    if change.max_tilt is not None:
        lines.append(f"tilt ≤ {math.degrees(change.max_tilt):.0f}°")
    if change.remove_first:
        names = {node.id: node.category for node in graph.nodes}
        lines.append(f"first take away the {', the '.join(names[thing] for thing in change.remove_first)}")
    return lines or ["nothing"]


def _observed(kind: str, run: TracedRun) -> str:
    """The observer's measurement of the constraint."""
    for item in run.result.constraints:
        if item.kind == kind and item.required:
            said = [form.format(item.measured[name]) for name, form in MEASURED.items() if name in item.measured]
            return f"{'kept' if item.satisfied else 'not kept'}: {', '.join(said)}"
    return "not required by the task"
