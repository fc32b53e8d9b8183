"""Cells of the benchmark's table: what happened in each configuration on each task, as integers (summary.json)."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path
from statistics import median
from typing import Any

from bench.trial import Trial


@dataclass(frozen=True)
class Cell:
    """Counts of one configuration on one task; a harness error is one of the `n` and no success."""

    configuration: str
    task: str
    n: int
    successes: int
    harness_errors: int
    damage_events: int
    attempts: int
    constraints_required: int
    constraints_satisfied: int
    suite: str
    noise: float
    claimed: int
    """Trials of which the robot itself said that they had succeeded."""
    false_claims: int
    """Claimed, but denied by the observer."""
    subgoals: int
    first_successes: int
    """Sub-goals whose first attempt succeeded."""
    recovered: int
    """Sub-goals that succeeded after a failed first attempt."""
    first_failures: int
    """Sub-goals whose first attempt failed."""


@dataclass(frozen=True)
class Summary:
    """The content of summary.json."""

    cells: tuple[Cell, ...]
    wall_s: float
    trials: int
    workers: int
    bare_step_ratio: float | None

    def to_json(self) -> str:
        """The summary as JSON text."""
        return json.dumps(asdict(self), indent=1) + "\n"


def cell(trials: Iterable[Trial]) -> Cell:
    """The counts of trials that share configuration, task, suite and noise.

    Raises:
        ValueError: no trial, or trials of several cells.
    """
    own = list(trials)
    names = {(t.configuration, t.task, t.suite, t.noise) for t in own}
    if len(names) != 1:
        raise ValueError(f"one cell expected, not {sorted(names)}")
    configuration, task, suite, noise = names.pop()
    required = [sum(item.required for item in t.constraints) for t in own]
    # A trial that a harness error cut short reports no constraints; the task required them all the same.
    unreported = sum(t.harness_error is not None and not t.constraints for t in own)
    goals = [goal for t in own for goal in t.subgoals]
    return Cell(
        configuration=configuration,
        task=task,
        n=len(own),
        successes=sum(t.success for t in own),
        harness_errors=sum(t.harness_error is not None for t in own),
        damage_events=sum(t.damage_events for t in own),
        attempts=sum(t.attempts for t in own),
        constraints_required=sum(required) + unreported * max(required),
        constraints_satisfied=sum(item.required and item.satisfied for t in own for item in t.constraints),
        suite=suite,
        noise=noise,
        claimed=sum(t.claimed for t in own),
        false_claims=sum(t.claimed and not t.success for t in own),
        subgoals=len(goals),
        first_successes=sum(bool(goal.attempts) and goal.attempts[0].success for goal in goals),
        recovered=sum(goal.recovered for goal in goals),
        first_failures=sum(goal.first_failed for goal in goals),
    )


def cells(trials: Iterable[Trial]) -> tuple[Cell, ...]:
    """All cells, ordered by configuration, task, suite and noise; independent of the order of the trials."""
    groups: dict[tuple[Any, ...], list[Trial]] = {}
    for trial in trials:
        groups.setdefault((trial.configuration, trial.task, trial.suite, trial.noise), []).append(trial)
    return tuple(cell(groups[name]) for name in sorted(groups))


def summarise(
    trials: Iterable[Trial], *, wall_s: float | None = None, workers: int = 1, bare_step_ratio: float | None = None
) -> Summary:
    """The summary of a run.

    Args:
        trials: All trials of the run.
        wall_s: Wall time of the whole run [s]; without it the trials' own times are added and divided by the workers.
        workers: Processes that ran them.
        bare_step_ratio: Wall time of `execute_grasp` over bare steps; without it the median of the trials' ratios.
    """
    own = list(trials)
    ratios = [t.bare_step_ratio for t in own if t.bare_step_ratio is not None]
    if bare_step_ratio is None and ratios:
        bare_step_ratio = round(median(ratios), 4)
    spent = sum(t.wall_s for t in own) / max(1, workers) if wall_s is None else wall_s
    return Summary(cells(own), round(spent, 3), len(own), workers, bare_step_ratio)


def write_summary(summary: Summary, folder: Path) -> Path:
    """Writes summary.json into the folder."""
    path = folder / "summary.json"
    path.write_text(summary.to_json(), encoding="utf-8")
    return path
