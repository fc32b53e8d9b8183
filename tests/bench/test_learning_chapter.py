"""The growth curve in the report: the learning study's summary as a chapter."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from bench.report.__main__ import main
from bench.report.learning import growth_chart, read_learning, tables
from bench.report.value import text
from kb.errors import BadInputError
from tests.report_fixtures import trial_row


def summary(blocks: int = 3) -> dict[str, Any]:
    """A study that grows from 80 to 100 %."""
    growth = [
        {"trials": 50 * (i + 1), "success": 0.8 + 0.1 * i, "attempts": 1.6 - 0.3 * i, "entries": 3 * i}
        for i in range(blocks)
    ]
    return {
        "asked": {"trials": 50 * blocks, "evaluator": "mujoco", "perception": "rgbd", "false_claims": 0.2},
        "learner": {"n": 50 * blocks, "successes": 45 * blocks, "growth": growth},
        "shipped": {"n": 50 * blocks, "successes": 48 * blocks, "growth": growth},
        "difference": {"value": -0.06, "low": -0.1, "high": -0.02},
        "promotions": [{}, {}], "wrong_promotions": 0, "refused": 1,
    }  # fmt: skip


def test_the_chapter_has_both_curves_and_the_interval() -> None:
    """One dot a block, arm and panel; the difference with its interval; the rows of growth are those of the study."""
    both, growth = tables(summary())
    assert [text(cell) for cell in both.rows[0]][1:] == [
        "135/150 (90.0 %)", "[84.2, 93.8]", "\N{MINUS SIGN}6.0", "[\N{MINUS SIGN}10.0, \N{MINUS SIGN}2.0]",
    ]  # fmt: skip
    assert [text(cell) for cell in growth.rows[2]] == ["150", "100.0 %", "1.00", "6", "100.0 %", "1.00"]
    assert "20 % of failed attempts" in both.note
    drawn = growth_chart(summary())
    assert drawn.count("<circle") - growth_chart(summary(0)).count("<circle") == 3 * 2 * 2
    assert drawn == growth_chart(summary())


def test_the_report_takes_the_study_in(tmp_path: Path) -> None:
    """`--learning` puts the chapter into report, tables and results page; a folder without a study is refused."""
    run, study = tmp_path / "run", tmp_path / "learn"
    run.mkdir()
    study.mkdir()
    (run / "trials.jsonl").write_text(json.dumps(trial_row()) + "\n")
    (study / "summary.json").write_text(json.dumps(summary()))
    assert main([str(run), "--learning", str(study), "--results", str(tmp_path / "docs" / "results.md")]) == 0
    assert "Success and attempts against trials seen" in (run / "report.html").read_text()
    assert "Learning from nothing" in (run / "tables.md").read_text()
    assert "images/results_growth.svg" in (tmp_path / "docs" / "results.md").read_text()
    assert (tmp_path / "docs" / "images" / "results_growth.svg").read_text().startswith("<svg")
    with pytest.raises(BadInputError, match="no summary of a learning study"):
        read_learning(run)
