"""Rows and jobs made by hand, for tests of the benchmark's harness that need no world."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from bench.job import Job, Settings
from bench.row import Row, RowLine, error_row
from bench.suite import tasks_of

TIMES = (
    "timings_s",
    "wall_s",
    "bare_step_ratio",
    "bare_step_wall_ratio",
    "shared_looks",
    "shared_motions",
    "shared_steps",
)
"""Keys that may differ between two runs of the same trial: wall times, and what was shared with whom."""
ANALYTIC = Settings(evaluator="analytic", perception="oracle")


def job(trial: int = 0, task: str = "single_cube", settings: Settings = ANALYTIC, *names: str) -> Job:
    """A job of one trial."""
    return Job(
        settings=settings,
        task=tasks_of("tasks", [task])[0],
        configurations=names or ("full",),
        repetition=0,
        trial=trial,
        seed=settings.seed + trial,
        noise=1.0,
    )


def row(trial: int = 0, configuration: str = "full") -> Row:
    """A row without a run."""
    return error_row(job(trial), configuration, "made by hand")


def lasting(row: Row | RowLine | dict[str, Any]) -> dict[str, Any]:
    """What of a row must be the same whenever it is run."""
    line = row.line if isinstance(row, Row) else row
    content = json.loads(line.text) if isinstance(line, RowLine) else dict(line)
    return {key: value for key, value in content.items() if key not in TIMES}


def read(folder: Path) -> dict[tuple[Any, ...], dict[str, Any]]:
    """The lasting part of all rows in a folder by key; doubled keys are an error."""
    found: dict[tuple[Any, ...], dict[str, Any]] = {}
    for line in (folder / "trials.jsonl").read_text(encoding="utf-8").splitlines():
        content = json.loads(line)
        key = tuple(content[name] for name in ("configuration", "task", "repetition", "trial", "noise"))
        assert key not in found, f"{key} stands twice"
        found[key] = lasting(content)
    return found
