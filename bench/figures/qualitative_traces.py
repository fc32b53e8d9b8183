"""Figure: execution traces. First try; a slip, level 1 and recovery; three objects with memory."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from bench.figures.drawing import (
    BLUE,
    GREEN,
    HEAD,
    MUTED,
    ORANGE,
    RED,
    SMALL,
    TITLE,
    badge,
    picture,
    save,
    sheet,
    typeset,
    words,
)
from bench.figures.traced_run import TracedRun, first_run, known, levels_tried, understood
from kb.run_result import RunResult
from sim.video import Moment

SCENES = Path(__file__).parent / "scenes"
COLUMNS, WIDTH, GAP, LEFT = 5, 2.32, 0.12, 0.35

Frame = tuple[Moment, str, str, str]
"""Moment, badge, colour of the badge, caption."""


def draw(path: Path) -> Path:
    """Runs the three examples and draws them as rows."""
    rows = [
        ("Single grasp: the first attempt holds", *_single()),
        ("Interactive: slip, correction at level 1, recovery beside a vase", *_recovery()),
        ("Long horizon: three objects into the bin; what held the first cup is used for the second", *_memory()),
    ]
    figure, axis = sheet(LEFT * 2 + COLUMNS * WIDTH + (COLUMNS - 1) * GAP, 10.0)
    words(axis, LEFT, 0.28, "Three runs of the agent", size=TITLE, bold=True)
    top = 0.78
    for title, run, frames in rows:
        top = _row(axis, top, title, run, frames) + 0.2
    return save(figure, path)


def _row(axis: Any, top: float, title: str, run: TracedRun, frames: list[Frame]) -> float:
    words(axis, LEFT, top, title, size=HEAD, bold=True)
    said = f"“{run.result.instruction}”   scene {Path(run.result.scene).stem}, seed {run.result.seed}"
    words(axis, LEFT, top + 0.24, said, size=SMALL, colour=MUTED)
    y, lowest = top + 0.5, 0.0
    pictures = run.frames([moment for moment, *_ in frames])
    for column, (pixels, (_, label, colour, caption)) in enumerate(zip(pictures, frames, strict=True)):
        x = LEFT + column * (WIDTH + GAP)
        height = picture(axis, pixels, x, y, WIDTH)
        badge(axis, x + 0.09, y + 0.1, label, colour)
        words(axis, x, y + height + 0.07, caption, size=SMALL, wrap=36, most=4)
        lowest = max(lowest, y + height)
    return lowest + 0.72


def _grasped(attempt: Any) -> str:
    grasp = attempt.grasp
    return f"{grasp.type} grasp of the {attempt.region}, {grasp.force:.1f} N, opening {1000 * grasp.aperture:.0f} mm"


def _single() -> tuple[TracedRun, list[Frame]]:
    run = first_run("single_banana", "pick up the banana", lambda result: result.success)
    motion, attempt = run.grasps()[0], run.result.goals[0].attempts[0]
    best = run.of_kind("retrieved")[0].retrieval.best()
    entry, verdict, quality = known(best).experience, known(attempt.verdict), known(attempt.quality)
    return run, [
        (run.moment(motion, "transit", 0.0), "1 look", BLUE, run.of_kind("look")[0].text),
        (run.moment(motion, "approach", 0.0), "2 retrieve", BLUE,
         f"experience {entry.id}: the {entry.strategy.region}, held in {entry.n_success} of {entry.n_trials} trials, "
         f"score {best.score:.2f}"),
        (run.moment(motion, "close", 1.0), "3 grasp", BLUE, _grasped(attempt)),
        (run.moment(motion, "lift", 1.0), "4 lift", BLUE,
         f"predicted quality {quality.q:.2f}; lifted {100 * verdict.lifted_m:.0f} cm"),
        (run.moment(motion, "shake", 1.0), "held", GREEN,
         f"held {verdict.held_s:.1f} s and through the shake; slip {1000 * verdict.slip_m:.1f} mm"),
    ]  # fmt: skip


def _recovery() -> tuple[TracedRun, list[Frame]]:
    def wanted(result: RunResult) -> bool:
        return result.success and understood(result) and levels_tried(result) == [[False, True]]

    run = first_run(str(SCENES / "soapy_bowl.yaml"), "pick up the bowl", wanted, seed=10_010)
    first, second = run.grasps()[:2]
    failed, held = run.result.goals[0].attempts
    reason = run.of_kind("constrained")[0].constraints.active[0].reason
    reflection = run.of_kind("reflection")[0]
    kept = next(item for item in run.result.constraints if item.required)
    return run, [
        (run.moment(first, "transit", 0.0), "constraint", BLUE, reason),
        (run.moment(first, "close", 1.0), "attempt 1", BLUE, _grasped(failed)),
        (run.last_of(first, "shake", "hold", "lift", "close"), f"{failed.observed_failure}".lower(), RED,
         f"the robot says {failed.failure}, so does the observer"),
        (run.moment(second, "close", 1.0), "level 1", ORANGE,
         typeset(f"{reflection.correction.rule}: {_grasped(held)}")),
        (run.moment(second, "shake", 1.0), "recovered", GREEN,
         f"held {known(held.verdict).held_s:.1f} s; the vase was moved {kept.measured.get('displacement_mm', 0.0):.1f} mm"),
    ]  # fmt: skip


def _memory() -> tuple[TracedRun, list[Frame]]:
    def wanted(result: RunResult) -> bool:
        tried = levels_tried(result)
        cups = any(goal.object == "cup_1" for goal in result.goals)
        return result.success and cups and tried == [[True]] * 3 and _remembered(result) == 1

    run = first_run("repeated_categories", "clear the table", wanted, seed=10_002)
    goals = [goal for goal in run.result.goals if goal.attempts]
    motions = run.grasps()
    frames: list[Frame] = [(run.moment(motions[0], "transit", 0.0), "plan", BLUE, run.of_kind("understood")[0].text)]
    for goal, motion in zip(goals, motions, strict=True):
        attempt = goal.attempts[0]
        from_memory = any(item.source == "memory" for item in attempt.provenance.get("type", ()))
        label, colour = ("from memory", ORANGE) if from_memory else (str(goal.object), BLUE)
        source = "parameters remembered from the first cup: " if from_memory else ""
        frames.append((run.moment(motion, "lift", 1.0), label, colour, f"{goal.object}: {source}{_grasped(attempt)}"))
    frames.append(
        (run.moments[-1], "cleared", GREEN, f"{run.result.answer} {len(goals)} attempts for {len(goals)} objects")
    )
    return run, frames


def _remembered(result: RunResult) -> int:
    """Goals whose grasp took its type from the episodic memory."""
    return sum(
        any(item.source == "memory" for item in attempt.provenance.get("type", ()))
        for goal in result.goals
        for attempt in goal.attempts[:1]
    )
