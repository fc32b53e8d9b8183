"""Laws of the tables of predictions and forces, and of the results page."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from bench.report.__main__ import main, together
from bench.report.predictions import SCALES, brier, calibration_error, forces, habits, within
from bench.report.results import Results
from bench.report.results_page import targets
from bench.trial import digest
from kb.errors import BadInputError


def line(trial: int = 0, *, success: bool = True, configuration: str = "full", peak: float = 10.0) -> dict[str, Any]:
    """A line of trials.jsonl with one sub-goal; a failed one has two attempts."""
    verdict = {"peak_force_n": peak}
    attempt = {"level": 0, "success": success, "claimed": success, "verdict": verdict, "quality": {"q": 0.8}}
    return {
        "configuration": configuration, "task": "single_cup", "repetition": 0, "trial": trial, "seed": 10000 + trial,
        "success": success, "executed": True, "strict": success, "damage_limit_n": {"cup": 16.0},
        "goals": [{"kind": "pick", "object": "cup", "success": success, "attempts": [attempt] * (1 if success else 2)}],
    }  # fmt: skip


def folder_of(path: Path, *lines: dict[str, Any]) -> Path:
    """A folder with these trials."""
    path.mkdir(parents=True)
    (path / "trials.jsonl").write_text("".join(json.dumps(item) + "\n" for item in lines), encoding="utf-8")
    return path


def test_brier_and_ece_of_known_predictions() -> None:
    """A sure and right forecast has error 0, a sure and wrong one 1, a coin of 0.5 a Brier score of 0.25 and ECE 0."""
    assert brier([1.0, 0.0], [True, False]) == calibration_error([1.0, 0.0], [True, False]) == 0.0
    assert brier([1.0], [False]) == calibration_error([1.0], [False]) == 1.0
    assert brier([0.5, 0.5], [True, False]) == 0.25
    assert calibration_error([0.5, 0.5], [True, False]) == 0.0


def test_success_within_attempts_never_falls() -> None:
    """success@k grows with k and ends at the successes."""
    results = Results([digest(line(0)), digest(line(1, success=False))])
    (row,) = within(results).rows
    counts = [cell.k for cell in row[1:]]  # type: ignore[union-attr]
    assert counts == sorted(counts)
    assert counts[-1] == 1


def test_damage_limits_are_scaled() -> None:
    """A peak of 10 N against a limit of 16 N is too much at half the limit and at no other."""
    results = Results([digest(line())])
    (row,) = forces(results).rows
    assert [cell.k for cell in row[3 : 3 + len(SCALES)]] == [1, 0, 0]  # type: ignore[union-attr]
    assert row[-1].k == 0  # type: ignore[union-attr]


def test_strict_is_counted_only_where_it_was_judged() -> None:
    """A line without the key takes no part in strict success."""
    old = {key: value for key, value in line(1).items() if key != "strict"}
    (row,) = habits(Results([digest(line()), digest(old)])).rows
    assert (row[1].k, row[1].n) == (1, 1)  # type: ignore[union-attr]


def test_targets_are_met_or_missed_by_the_counts() -> None:
    """One success of two misses 95 %; what was not run is neither met nor missed."""
    found = {item.what: item.met for item in targets(Results([digest(line(0)), digest(line(1, success=False))]))}
    assert found["all twelve tasks"] is False
    assert found["LH"] is None
    assert found["clutter, own perception"] is None


def test_folders_are_put_together_without_doubles(tmp_path: Path) -> None:
    """A trial in two folders counts once; with two outcomes the folders don't fit together."""
    one, two = folder_of(tmp_path / "a", line(0), line(1)), folder_of(tmp_path / "b", line(1), line(2))
    assert len(together([one, two])) == 3
    with pytest.raises(BadInputError, match="different outcomes"):
        together([one, folder_of(tmp_path / "c", line(1, success=False))])


def test_results_page_names_command_commit_and_what_falls_short(tmp_path: Path) -> None:
    """One command writes the page from a folder; figures stand beside it and are whole SVG files."""
    folder = folder_of(tmp_path / "run", line(0), line(1, success=False))
    session = {"command": "ragvlm bench --trials 2", "commit": "abcdef0123", "wall_s": 60.0, "workers": 2, "rows": 2,
               "finished": "2026-11-22T17:00:00Z"}  # fmt: skip
    (folder / "run.json").write_text(json.dumps({"sessions": [session]}), encoding="utf-8")
    page = tmp_path / "docs" / "results.md"
    assert main([str(folder), "--out", str(tmp_path / "out"), "--results", str(page)]) == 0
    text = page.read_text(encoding="utf-8")
    assert "`ragvlm bench --trials 2`: commit abcdef01, finished 2026-11-22T17:00:00Z" in text
    assert "Falls short: all twelve tasks" in text
    assert "1/2 (50.0 %)" in text
    assert "blind_retry at noise 1: nothing to compare" in text
    svg = (tmp_path / "docs" / "images" / "results_success.svg").read_text(encoding="utf-8")
    assert svg.startswith("<svg")
    assert "--c-blue" in svg
