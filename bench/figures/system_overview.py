"""Figure: the system, each stage with what it said in one real run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from bench.figures.drawing import (
    BLUE,
    BODY,
    GREEN,
    HEAD,
    MUTED,
    ORANGE,
    PURPLE,
    RED,
    SMALL,
    TITLE,
    arrow,
    badge,
    box,
    picture,
    save,
    sheet,
    typeset,
    words,
)  # fmt: skip
from bench.figures.graph_to_constraints import CAMERA_SCALE, around
from bench.figures.traced_run import TracedRun, trace
from tools.draw_scene_graph import draw_scene_graph

SCENE, SEED, INSTRUCTION = "cup_near_vase", 10_003, "pick up the cup next to the vase"
LEFT, WIDTH, GAP, HEIGHT = 0.35, 2.42, 0.32, 1.62
SIDE = 2.75
"""Width of the pictures at both ends."""


def draw(path: Path) -> Path:
    """Runs the agent once and draws what every stage made of it."""
    run = trace(SCENE, SEED, INSTRUCTION)
    figure, axis = sheet(2 * LEFT + 2 * SIDE + 3 * WIDTH + 4 * GAP, 7.05)
    words(
        axis,
        LEFT,
        0.28,
        "Agentic RAG-VLM: from a sentence and two RGB-D cameras to a judged grasp",
        size=TITLE,
        bold=True,
    )
    said = f"Every text below comes from one run: scene {SCENE}, seed {SEED}, offline on a CPU."
    words(axis, LEFT, 0.62, said, size=BODY, colour=MUTED)
    _input(axis, LEFT, 1.1, run)
    x = LEFT + SIDE + GAP
    for number, (name, text, colour) in enumerate(_stages(run)):
        column, row = number % 3, number // 3
        left, top = x + column * (WIDTH + GAP), 1.1 + row * (HEIGHT + 0.34)
        _stage(axis, left, top, f"{number + 1}  {name}", text, colour)
        if column:
            arrow(axis, (left - GAP, top + HEIGHT / 2), (left, top + HEIGHT / 2))
        elif row:
            # From the end of the row above to the beginning of this one.
            middle = top - 0.17
            end = x + 3 * WIDTH + 2 * GAP
            axis.plot(
                [end - WIDTH / 2, end - WIDTH / 2, left + WIDTH / 2], [top - 0.34, middle, middle], color=MUTED, lw=1.6
            )
            arrow(axis, (left + WIDTH / 2, middle - 0.01), (left + WIDTH / 2, top + 0.02))
    arrow(axis, (LEFT + SIDE, 1.1 + HEIGHT / 2), (x, 1.1 + HEIGHT / 2))
    end = x + 3 * (WIDTH + GAP)
    second = 1.1 + HEIGHT + 0.34
    arrow(axis, (end - GAP, second + HEIGHT / 2), (end, second + HEIGHT / 2))
    _outcome(axis, end, 1.1, run)
    _recovery(axis, x, second + HEIGHT + 0.5)
    return save(figure, path)


def _stages(run: TracedRun) -> list[tuple[str, str, str]]:
    """Six stages with their own words; the seventh is the loop below them."""
    plan = run.of_kind("planned")[0]
    return [
        ("Perceive", run.of_kind("look")[0].text + _measures(run), BLUE),
        ("Ground", run.of_kind("grounding")[0].text, BLUE),
        ("Retrieve (HAA-RAG)", run.of_kind("retrieved")[0].text, BLUE),
        ("Graph and constraints", run.of_kind("graphed")[0].text + " " + run.of_kind("constrained")[0].text, PURPLE),
        ("Plan", plan.text + _provenance(plan.plan), PURPLE),
        ("Act and observe", run.of_kind("observation")[0].text, GREEN),
    ]


def _measures(run: TracedRun) -> str:
    objects = run.looks[0][1].objects
    return "".join(
        f"\n{thing.category}: {1000 * thing.size[0]:.0f} × {1000 * thing.size[1]:.0f} × {1000 * thing.size[2]:.0f} mm, "
        f"{thing.confidence:.2f}"
        for thing in objects
    )


def _provenance(plan: Any) -> str:
    sources = dict.fromkeys(item.source for items in plan.provenance.values() for item in items)
    return f"\nEvery number has its source: {', '.join(sources)}."


def _stage(axis: Any, x: float, y: float, name: str, text: str, colour: str) -> None:
    box(axis, x, y, WIDTH, HEIGHT, colour)
    words(axis, x + 0.12, y + 0.12, name, size=HEAD, bold=True, colour=colour)
    words(axis, x + 0.12, y + 0.4, typeset(text), size=SMALL, wrap=36, most=7)


def _input(axis: Any, x: float, y: float, run: TracedRun) -> None:
    """The sentence and the front camera."""
    box(axis, x, y, SIDE, 0.62, ORANGE)
    words(axis, x + 0.12, y + 0.1, "Instruction", size=SMALL, colour=MUTED)
    words(axis, x + 0.12, y + 0.3, f"“{run.result.instruction}”", size=SMALL, bold=True)
    view, percept = run.looks[0]
    top = y + 0.78
    height = picture(axis, view.rgb, x, top, SIDE)
    badge(axis, x + 0.1, top + 0.11, "front camera", MUTED)
    target = run.of_kind("grounding")[0].target
    second = top + height + 0.14
    pixels = draw_scene_graph(view, percept, target=target, scale=CAMERA_SCALE)
    picture(axis, around(pixels, view, percept), x, second, SIDE)
    badge(axis, x + 0.1, second + 0.11, "perceived", BLUE)


def _outcome(axis: Any, x: float, y: float, run: TracedRun) -> None:
    """The held object, what the robot says and what the observer says."""
    motion = run.grasps()[0]
    pixels = run.frames([run.moment(motion, "hold")])[0]
    height = picture(axis, pixels, x, y, SIDE)
    badge(axis, x + 0.1, y + 0.11, "the robot claims success", BLUE)
    verdict = run.result.goals[0].verdict
    kept = next(item for item in run.result.constraints if item.required)
    top = y + height + 0.14
    box(axis, x, top, SIDE, 1.55, GREEN)
    words(axis, x + 0.12, top + 0.12, "The observer judges", size=HEAD, bold=True, colour=GREEN)
    assert verdict is not None
    text = (
        f"From true contacts and poses, afterwards; nothing of it reaches the agent.\n{'Success' if run.result.success else 'Failure'}: "
        f"raised {100 * verdict.lifted_m:.0f} cm, held {verdict.held_s:.1f} s, slip {1000 * verdict.slip_m:.1f} mm, damage "
        f"{', '.join(verdict.damage) or 'none'}; the vase was moved {kept.measured['displacement_mm']:.1f} mm."
    )
    words(axis, x + 0.12, top + 0.4, text, size=SMALL, wrap=38, most=7)


def _recovery(axis: Any, x: float, y: float) -> None:
    """Stage 7: the recovery ladder and the memory."""
    whole = 3 * WIDTH + 2 * GAP
    box(axis, x, y, whole, 1.45, RED, fill="#fdf6f3")
    words(axis, x + 0.12, y + 0.12, "7  Reflect and remember", size=HEAD, bold=True, colour=RED)
    words(
        axis,
        x + 2.6,
        y + 0.14,
        "after a failure: diagnose, correct, look again; at most three retries",
        size=SMALL,
        colour=MUTED,
    )
    steps = (
        ("Diagnose", "one of 14 types, from\nthe robot's own sensing", RED),
        ("Level 1", "tune parameters:\nforce, width, height", ORANGE),
        ("Level 2", "switch the grasp type:\npower → pinch → side", ORANGE),
        ("Level 3", "plan anew from the\nnext experience, ± 1 cm", ORANGE),
        ("Memory M", "what held is used for\nthe next of its kind", GREEN),
    )
    wide = (whole - 0.24 - 4 * 0.2) / 5
    for number, (name, text, colour) in enumerate(steps):
        left = x + 0.12 + number * (wide + 0.2)
        box(axis, left, y + 0.5, wide, 0.8, colour)
        words(axis, left + wide / 2, y + 0.62, name, size=BODY, bold=True, colour=colour, align="center")
        words(axis, left + wide / 2, y + 0.88, text, size=7.5, align="center")
        if number:
            arrow(axis, (left - 0.2, y + 0.9), (left, y + 0.9))
    right = x + whole - WIDTH / 2
    arrow(axis, (right - 0.3, y - 0.5), (right - 0.3, y), RED)
    words(axis, right - 0.22, y - 0.36, "failed or held", size=SMALL, colour=MUTED)
    arrow(axis, (x + WIDTH / 2, y), (x + WIDTH / 2, y - 0.5), ORANGE)
    words(axis, x + WIDTH / 2 + 0.08, y - 0.36, "corrected: look and plan again", size=SMALL, colour=MUTED)
