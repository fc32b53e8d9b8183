"""Cells and summary.json."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from bench.cells import cell, cells, summarise, write_summary
from bench.trial import digest
from tests.report_fixtures import attempt_row, error_row, goal_row, required_row, trial_row


def vase(trial: int, *, satisfied: bool = True, **more: object) -> dict[str, object]:
    """A trial of the cup near the vase."""
    return trial_row("full", "cup_near_vase", trial=trial, constraints=[required_row(satisfied=satisfied)], **more)


def test_counts_of_a_cell() -> None:
    """Two successes (one recovered), one failure after four attempts, with damage: all integers of the cell."""
    recovered = goal_row([attempt_row(0, False), attempt_row(1, True)])
    failed = goal_row([attempt_row(level, False) for level in range(4)])
    rows = [vase(0), vase(1, goals=[recovered]), vase(2, goals=[failed], satisfied=False, damage_events=1)]
    found = cell(map(digest, rows))
    assert (found.n, found.successes, found.harness_errors, found.damage_events, found.attempts) == (3, 2, 0, 1, 7)
    assert (found.constraints_required, found.constraints_satisfied) == (3, 2)
    assert (found.first_successes, found.first_failures, found.recovered, found.subgoals) == (1, 2, 1, 3)


def test_harness_errors_are_failures_and_counted_apart() -> None:
    """They are in n, not in the successes, and their constraints count as required and not satisfied."""
    found = cell(map(digest, [vase(0), vase(1), error_row("full", "cup_near_vase", trial=2)]))
    assert (found.n, found.successes, found.harness_errors) == (3, 2, 1)
    assert (found.constraints_required, found.constraints_satisfied) == (3, 2)


def test_a_false_claim_is_the_robots_word_against_the_observers() -> None:
    """Claimed by the robot, denied by the observer."""
    fooled = goal_row([attempt_row(0, False, claimed=True)])
    found = cell(map(digest, [trial_row(goals=[fooled]), trial_row(trial=1)]))
    assert (found.claimed, found.false_claims, found.successes) == (2, 1, 1)


def test_cells_never_mix_what_differs() -> None:
    """Configuration, task, suite and noise each open a cell of their own."""
    rows = [
        trial_row(),
        trial_row("heuristic"),
        trial_row(task="single_apple"),
        trial_row(noise=2.0),
        trial_row(suite="clutter"),
    ]
    assert [c.n for c in cells(map(digest, rows))] == [1] * 5
    with pytest.raises(ValueError, match="one cell expected"):
        cell(map(digest, rows))


def test_summary_keeps_its_promise(tmp_path: Path) -> None:
    """summary.json holds the promised keys, whatever the order in which the trials came."""
    trials = [digest(trial_row(trial=n, bare_step_ratio=1.1 + 0.1 * n)) for n in range(3)]
    path = write_summary(summarise(reversed(trials), wall_s=12.5, workers=2), tmp_path)
    found = json.loads(path.read_text(encoding="utf-8"))
    assert {"cells", "wall_s", "trials", "workers", "bare_step_ratio"} <= set(found)
    assert (found["wall_s"], found["trials"], found["workers"], found["bare_step_ratio"]) == (12.5, 3, 2, 1.2)
    promised = {
        "configuration", "task", "n", "successes", "harness_errors", "damage_events", "attempts",
        "constraints_required", "constraints_satisfied",
    }  # fmt: skip
    assert promised <= set(found["cells"][0])
    assert summarise(trials, wall_s=12.5, workers=2) == summarise(reversed(trials), wall_s=12.5, workers=2)
