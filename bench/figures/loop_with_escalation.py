"""Figure: the agentic loop with an escalation through all levels, from one real run."""

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
from bench.figures.traced_run import TracedRun, first_run, levels_tried, understood
from kb.run_result import AttemptRecord, RunResult
from sim.viewpoint import Viewpoint

SCENE = Path(__file__).parent / "scenes" / "soapy_cube.yaml"
NAMES = ("attempt 1", "level 1: tune parameters", "level 2: switch the grasp type", "level 3: plan anew")
WIDTH, GAP, LEFT = 2.9, 0.22, 0.35
NEAR = Viewpoint(eye=(1.16, -0.62, 0.47), target=(0.47, 0.02, 0.14), fovy=31.0)
"""Close to the object."""


def draw(path: Path) -> Path:
    """Finds a run that needs all four attempts and draws it."""

    def wanted(result: RunResult) -> bool:
        return result.success and understood(result) and levels_tried(result) == [[False, False, False, True]]

    run = first_run(str(SCENE), "pick up the cube", wanted, seed=10_009)
    attempts = run.result.goals[0].attempts
    width = 2 * LEFT + len(attempts) * WIDTH + (len(attempts) - 1) * GAP
    figure, axis = sheet(width, 8.65)
    words(axis, LEFT, 0.28, "Thought → Action → Observation, and what happens after a failure", size=TITLE, bold=True)
    note = (
        f"“{run.result.instruction}”: a wooden cube as smooth as wet soap, which no camera sees "
        f"(scene {SCENE.stem}, seed {run.result.seed}). The robot knows only what it feels."
    )
    words(axis, LEFT, 0.62, note, size=BODY, colour=MUTED)
    _cycle(axis, width, 1.0)
    shown = [_shown(run, motion, attempt) for motion, attempt in zip(run.grasps(), attempts, strict=True)]
    frames = run.frames(shown, NEAR)
    for number, attempt in enumerate(attempts):
        _column(axis, LEFT + number * (WIDTH + GAP), run, number, attempt, frames[number])
    return save(figure, path)


def _cycle(axis: Any, width: float, top: float) -> None:
    """The loop as a strip of boxes."""
    names = (
        ("Thought", "grasp, constraints, history", BLUE),
        ("Action", "execute_grasp", BLUE),
        ("Observation", "fingers, wrist, next look", BLUE),
        ("Diagnosis", "one of 14 failure types", RED),
        ("Correction", "level of the next attempt", ORANGE),
    )
    wide = (width - 2 * LEFT - 2.45 - 5 * 0.3) / len(names)
    for number, (name, what, colour) in enumerate(names):
        x = LEFT + number * (wide + 0.3)
        box(axis, x, top, wide, 0.62, colour)
        words(axis, x + wide / 2, top + 0.1, name, size=HEAD, bold=True, align="center")
        words(axis, x + wide / 2, top + 0.35, what, size=SMALL, colour=MUTED, align="center")
        arrow(axis, (x + wide, top + 0.31), (x + wide + 0.3, top + 0.31))
    x = LEFT + len(names) * (wide + 0.3)
    box(axis, x, top, 2.45, 0.62, PURPLE)
    words(axis, x + 1.22, top + 0.1, "look again, up to 3 retries", size=HEAD, bold=True, align="center")
    words(axis, x + 1.22, top + 0.35, "a success goes into the memory M", size=SMALL, colour=MUTED, align="center")
    arrow(axis, (x + 1.2, top + 0.64), (LEFT + wide / 2, top + 0.64), MUTED, bend=-0.035)


def _shown(run: TracedRun, motion: int, attempt: AttemptRecord) -> Any:
    """Where a failed attempt ended, or the held object."""
    if attempt.success:
        return run.moment(motion, "shake")
    return run.last_of(motion, "shake", "hold", "lift", "close", "approach", share=0.75)


def _column(axis: Any, x: float, run: TracedRun, number: int, attempt: AttemptRecord, pixels: Any) -> None:
    colour = GREEN if attempt.success else RED
    top = 2.28
    words(axis, x, top, NAMES[number], size=HEAD, bold=True)
    height = picture(axis, pixels, x, top + 0.28, WIDTH, frame=colour)
    outcome = "held" if attempt.success else f"{attempt.failure}".lower().replace("_", " ")
    badge(axis, x + 0.1, top + 0.39, outcome, colour)
    y = top + 0.28 + height + 0.12
    thought = run.of_kind("thought")[number].text
    for name, said, most, room in (
        ("Thought", thought, 8, 1.6),
        ("Action", _action(attempt), 2, 0.62),
        ("Observation", run.of_kind("observation")[number].text, 5, 0.95),
    ):
        words(axis, x, y, name, size=BODY, bold=True, colour=BLUE)
        words(axis, x, y + 0.19, typeset(said), size=SMALL, wrap=45, most=most)
        y += room
    reflections = run.of_kind("reflection")
    if attempt.success:
        words(axis, x, y, f"The observer: {_seen(attempt)}", size=SMALL, wrap=45, colour=GREEN)
    elif number < len(reflections) and reflections[number].correction is not None:
        words(axis, x, y, "Correction", size=BODY, bold=True, colour=ORANGE)
        words(axis, x, y + 0.19, typeset(reflections[number].correction.rule), size=SMALL, wrap=45, most=3)
    if number:
        arrow(axis, (x - GAP + 0.02, top + 0.28 + height / 2), (x - 0.02, top + 0.28 + height / 2), ORANGE, width=2.2)


def _action(attempt: AttemptRecord) -> str:
    grasp = attempt.grasp
    assert grasp is not None
    return f"{grasp.type} grasp of the {attempt.region}, {grasp.force:.1f} N, opening {1000 * grasp.aperture:.0f} mm"


def _seen(attempt: AttemptRecord) -> str:
    verdict = attempt.verdict
    assert verdict is not None
    return (
        f"raised {100 * verdict.lifted_m:.0f} cm, held {verdict.held_s:.1f} s and through the shake, slip "
        f"{1000 * verdict.slip_m:.1f} mm"
    )
