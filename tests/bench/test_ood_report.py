"""The table of objects in and outside the distribution, from rows made by hand."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from bench.ood_report import groups, headline, main, per_object
from bench.report.value import Count, text
from bench.trial import digest
from kb.errors import BadInputError
from tests.report_fixtures import attempt_row, goal_row, trial_row


def row(configuration: str, suite: str, task: str, trial: int, success: bool, **more: Any) -> dict[str, Any]:
    goals = [goal_row([attempt_row(0, False), attempt_row(1, success)] if trial == 0 else [attempt_row(0, success)])]
    return trial_row(configuration, task, trial=trial, goals=goals, suite=suite, **more)


def rows() -> list[dict[str, Any]]:
    """Ten far trials: 9 with retrieval, 6 without; ten near ones without an ablation."""
    admitted = {
        "funnel": {"fallback": True},
        "experiences": [{"s_aff": 0.5, "success": False}, {"s_aff": 0.95, "success": True}],
    }
    far = [row("full_blind", "ood_far", "ood_egg", i, i != 9, **admitted) for i in range(10)]
    bare = [row("no_haarag", "ood_far", "ood_egg", i, i < 6) for i in range(10)]
    return far + bare + [row("full", "ood_near", "ood_bud_vase", i, i > 1) for i in range(10)]


def test_the_ablation_stands_beside_each_number() -> None:
    """9 of 10 against 6 of 10 on the same worlds: +30 points, p = 2/8 exactly; first attempts 8; targets 80 and 90 %."""
    near, far = headline(groups([digest(one) for one in rows()])).rows
    assert [text(cell) for cell in near] == [
        "near", "`full`", "8/10 (80.0 %)", "[49.0, 94.3]", "≥ 90: **no**", "–", "8/10 (80.0 %)", "not run", "–", "–", "–", "–",
    ]  # fmt: skip
    assert [text(cell) for cell in far[:4]] == ["far, `blind`", "`full_blind`", "9/10 (90.0 %)", "[59.6, 98.2]"]
    assert [text(cell) for cell in far[4:10]] == [
        "≥ 80: yes", "54.4", "8/10 (80.0 %)", "6/10 (60.0 %)", "[31.3, 83.2]", "+30.0",
    ]  # fmt: skip
    assert text(far[11]) == "0.250"
    assert per_object(groups([digest(one) for one in rows()])).rows[1][2:] == (Count(9, 10), Count(6, 10))


def test_the_command_prints_all_tables(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Folders are put together; fallback and the affordance score of the best success are counted; twice the same."""
    for name, own in (("far", rows()[:20]), ("near", rows()[20:])):
        (tmp_path / name).mkdir()
        (tmp_path / name / "trials.jsonl").write_text("".join(json.dumps(one) + "\n" for one in own))
    words = [str(tmp_path / "far"), str(tmp_path / "near"), "--out", str(tmp_path / "table.md")]
    assert main(words) == 0
    said = capsys.readouterr().out
    assert said == (tmp_path / "table.md").read_text()
    assert "| far, `blind` | no category fits, all entries admitted | 10/10 (100.0 %) | 9/10 (90.0 %) | 0.95 |" in said
    assert "| near | nothing retrieved (not seen, or ended before) | 10/10 (100.0 %) | 8/10 (80.0 %) | – |" in said
    assert main(words) == 0
    assert capsys.readouterr().out == said


def test_runs_of_another_suite_are_refused() -> None:
    """The twelve tasks have no row here."""
    with pytest.raises(BadInputError, match="--suite ood"):
        groups([digest(trial_row())])
