"""Figure: the three levels of HAA-RAG with the counts of two real queries."""

from __future__ import annotations

import runpy
import tempfile
from pathlib import Path
from typing import Any

from bench.figures.drawing import (
    BLUE,
    BODY,
    GREEN,
    HEAD,
    INK,
    MUTED,
    ORANGE,
    PAPER,
    PURPLE,
    RED,
    SMALL,
    TITLE,
    badge,
    picture,
    save,
    sheet,
    words,
)  # fmt: skip
from bench.figures.graph_to_constraints import CAMERA_SCALE, around
from bench.figures.traced_run import TracedRun, trace
from kb.experience import Funnel, RetrievedExperience
from tools.draw_scene_graph import draw_scene_graph

EXAMPLE = Path(__file__).parents[2] / "examples" / "own_object.py"
"""The documented example of a user's own object, a knob that no category of the knowledge base fits."""
LEFT, PANEL, GAP = 0.35, 6.1, 0.4
LEVELS = (
    ("Knowledge base", "measured experiences", MUTED),
    ("Level 1: category", "same category or superclass, at most 30", BLUE),
    ("Level 2: affordance", "type, material, fragility, region: s_aff ≥ 0.3", PURPLE),
    ("Level 3: looks", "0.2 s_cat + 0.4 s_aff + 0.4 s_vis, best three", GREEN),
)
ROW, DOTS = 0.84, 58
"""Height of a level [in] and dots in a line."""


def draw(path: Path) -> Path:
    """Queries for a known object and for one outside the taxonomy, side by side."""
    known = trace("cup_near_vase", 10_003, "pick up the cup")
    with tempfile.TemporaryDirectory() as folder:
        strange = _strange(Path(folder))
    figure, axis = sheet(2 * LEFT + 2 * PANEL + GAP, 7.45)
    words(axis, LEFT, 0.28, "Hierarchical affordance-aware retrieval", size=TITLE, bold=True)
    note = (
        "Every dot is an experience that is still in the running. Left: a cup. Right: an object outside the taxonomy."
    )
    words(axis, LEFT, 0.62, note, size=BODY, colour=MUTED)
    _panel(axis, LEFT, known)
    _panel(axis, LEFT + PANEL + GAP, strange)
    return save(figure, path)


def _strange(folder: Path) -> TracedRun:
    """A run with the example's knob."""
    example = runpy.run_path(str(EXAMPLE))
    example["make_knob"](folder / "knob.stl")
    (folder / "workbench.yaml").write_text(example["SCENE"], encoding="utf-8")
    return trace(str(folder / "workbench.yaml"), 10_000, "pick up the knob")


def _panel(axis: Any, x: float, run: TracedRun) -> None:
    """One query: what is looked at, the funnel, the three best."""
    retrieval = run.of_kind("retrieved")[0].retrieval
    target = run.of_kind("grounding")[0].target
    view, percept = run.looks[0]
    thing = next(item for item in percept.objects if item.id == target)
    pixels = around(draw_scene_graph(view, percept, target=target, scale=CAMERA_SCALE), view, percept)
    height = picture(axis, pixels, x, 1.02, 1.75)
    badge(axis, x + 0.08, 1.11, "query", BLUE)
    facts = (
        f"“{run.result.instruction}”",
        f"category {thing.category} ({thing.confidence:.2f})",
        f"material {thing.affordance.material}, fragility {thing.affordance.fragility:.1f}",
        f"{thing.affordance.type.lower().replace('_', ' ')}, region {thing.affordance.region}",
    )
    for number, line in enumerate(facts):
        words(axis, x + 1.92, 1.08 + 0.22 * number, line, size=BODY, bold=not number)
    _funnel(axis, x, 1.02 + height + 0.3, retrieval.funnel)
    _best(axis, x, 1.02 + height + 0.3 + 4 * ROW + 0.16, retrieval.top)


def _funnel(axis: Any, x: float, y: float, funnel: Funnel) -> None:
    """Four levels with their survivors as dots."""
    counts = (funnel.total, funnel.level1, funnel.level2, funnel.level3)
    for number, ((name, what, colour), count) in enumerate(zip(LEVELS, counts, strict=True)):
        top = y + number * ROW
        words(axis, x, top, name, size=BODY, bold=True, colour=INK if colour == MUTED else colour)
        if number == 1 and funnel.fallback:
            what = "nothing related: every entry is admitted with s_cat = 0"
        words(axis, x + 1.75, top + 0.015, what, size=SMALL, colour=MUTED)
        words(axis, x + PANEL, top - 0.04, str(count), size=13, bold=True, align="right")
        columns = [x + 0.07 + (PANEL - 0.6) / DOTS * (i % DOTS) for i in range(funnel.total)]
        rows = [top + 0.34 + 0.16 * (i // DOTS) for i in range(funnel.total)]
        axis.scatter(columns[count:], rows[count:], s=13, facecolors=PAPER, edgecolors="#d5dade", linewidths=0.8)
        axis.scatter(columns[:count], rows[:count], s=15, color=colour, zorder=3)


def _best(axis: Any, x: float, y: float, top: tuple[RetrievedExperience, ...]) -> None:
    """The three best with their scores."""
    heads = (
        ("experience", 0.0),
        ("score", 1.42),
        ("category", 2.05),
        ("affordance", 2.85),
        ("looks", 3.75),
        ("held", 4.35),
    )
    for name, offset in heads:
        words(axis, x + offset, y, name, size=SMALL, colour=MUTED)
    words(axis, x + PANEL, y, "strategy", size=SMALL, colour=MUTED, align="right")
    for number, item in enumerate(top):
        line, entry = y + 0.24 + 0.23 * number, item.experience
        cells = (entry.id, f"{item.score:.3f}", f"{item.s_cat:.2f}", f"{item.s_aff:.2f}", f"{item.s_vis:.2f}",
                 f"{entry.n_success}/{entry.n_trials}")  # fmt: skip
        for (_, offset), cell in zip(heads, cells, strict=True):
            bold = offset in (0.0, 1.42) and not number
            colour = RED if cell == cells[-1] and not entry.success else INK
            words(axis, x + offset, line, cell, size=BODY, bold=bold, colour=colour)
        plan = f"{entry.strategy.region}, {entry.strategy.approach}, {entry.strategy.force:.0f} N"
        words(axis, x + PANEL, line, plan, size=BODY, colour=ORANGE if not number else INK, align="right")
    words(axis, x, y + 0.24 + 0.23 * len(top) + 0.06, "", size=HEAD)
