"""Trials as they are read from trials.jsonl."""

from __future__ import annotations

import json
import logging
from pathlib import Path

import pytest

from bench.row import Row
from bench.trial import digest, in_order, read_trials
from kb.errors import BadInputError
from tests.report_fixtures import attempt_row, error_row, goal_row, trial_row


def write(path: Path, rows: list[dict[str, object]], tail: str = "") -> Path:
    """A trials.jsonl."""
    path.write_text("".join(json.dumps(row) + "\n" for row in rows) + tail, encoding="utf-8")
    return path


def test_sub_goals_are_what_is_grasped() -> None:
    """Of "clear the table" with three objects, the three placings count, not the request itself."""
    children = [goal_row([attempt_row(0, True)], parent=0) for _ in range(3)]
    asked = goal_row([], success=True) | {"kind": "clear", "claimed": True}
    found = digest(trial_row(task="clear_table", goals=[asked, *children]))
    assert [goal.kind for goal in found.subgoals] == ["place"] * 3
    assert (found.attempts, found.success, found.claimed) == (3, True, True)


def test_recovered_means_failed_first_and_solved_later() -> None:
    """Failure then success is a recovery; success at once and failure throughout are none."""
    second = goal_row([attempt_row(0, False), attempt_row(1, True)])
    at_once = goal_row([attempt_row(0, True)])
    never = goal_row([attempt_row(0, False), attempt_row(1, False)])
    goals = digest(trial_row(goals=[second, at_once, never])).subgoals
    assert [(goal.recovered, goal.first_failed) for goal in goals] == [(True, True), (False, False), (False, True)]


def test_a_harness_error_is_never_a_success() -> None:
    """Whatever else the line says."""
    found = digest(error_row("full", "single_cup") | {"success": True})
    assert (found.success, found.claimed, found.harness_error) == (False, False, "RuntimeError: worker died")


def test_lines_of_the_runner_are_understood() -> None:
    """A row that the runner's own model writes keeps its key, outcome and numbers."""
    row = trial_row("no_memory", "single_apple", repetition=2, trial=7, noise=2.0)
    row["goals"] = [goal_row([], success=True) | {"kind": "look"}]
    found = digest(json.loads(Row.model_validate(row).model_dump_json()))
    assert found.key == ("no_memory", "single_apple", 2, 7, 2.0)
    assert (found.success, found.wall_s, found.seed, found.suite) == (True, 2.5, 22007, "tasks")


def test_cut_off_last_line_is_left_out_with_a_warning(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    """A kill in the middle of a write costs that line and nothing else."""
    path = write(tmp_path / "trials.jsonl", [trial_row(trial=n) for n in range(3)], '{"task": "single_c')
    with caplog.at_level(logging.WARNING):
        assert len(read_trials(path)) == 3
    assert "line (4) is cut off" in caplog.text


def test_broken_line_in_the_middle_is_refused(tmp_path: Path) -> None:
    """Nothing is skipped silently: damage before the end is named with its line."""
    path = tmp_path / "trials.jsonl"
    path.write_text('{"task": \n' + json.dumps(trial_row()) + "\n", encoding="utf-8")
    with pytest.raises(BadInputError, match="line 1 is not JSON"):
        read_trials(path)


def test_a_doubled_trial_counts_once(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    """The first line of a key stands; the second is reported."""
    path = write(tmp_path / "trials.jsonl", [trial_row(), trial_row(goals=[])])
    with caplog.at_level(logging.WARNING):
        (only,) = read_trials(path)
    assert only.success
    assert "more than once" in caplog.text


@pytest.mark.parametrize(
    ("content", "says"), [(None, "no such file"), ("", "no trial"), ("{}\n", "lacks configuration")]
)
def test_unusable_files_are_named(tmp_path: Path, content: str | None, says: str) -> None:
    """Missing, empty and foreign files are bad input, not a traceback."""
    path = tmp_path / "trials.jsonl"
    if content is not None:
        path.write_text(content, encoding="utf-8")
    with pytest.raises(BadInputError, match=says):
        read_trials(path)


def test_order_does_not_depend_on_the_workers() -> None:
    """Trials that arrive in any order stand in one order."""
    trials = [digest(trial_row(name, trial=n)) for name in ("full", "heuristic") for n in range(3)]
    assert in_order(reversed(trials)) == in_order(trials)
