"""Agreement of two evaluators."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from bench.agreement import agreement, auc, main, table
from bench.trial import digest
from kb.errors import BadInputError
from tests.report_fixtures import attempt_row, goal_row, trial_row

YES, NO = [goal_row([attempt_row(0, True)])], [goal_row([attempt_row(0, False)])]


def test_kappa_of_a_worked_example() -> None:
    """20 both, 5 and 10 one-sided, 15 neither: accuracy 0.70, chance 0.50, kappa 0.40."""
    pairs = [(True, True)] * 20 + [(True, False)] * 5 + [(False, True)] * 10 + [(False, False)] * 15
    found = agreement(pairs)
    assert found.accuracy == pytest.approx(0.70)
    assert found.kappa == pytest.approx(0.40)


def test_kappa_of_one_sided_data_is_undefined() -> None:
    """If both say yes to everything, agreement beyond chance cannot be measured, and is not reported as 0 or 1."""
    assert agreement([(True, True)] * 9).kappa is None


def test_auc_of_perfect_useless_and_inverted_scores() -> None:
    """1, 0.5 and 0; None where nothing failed."""
    assert auc([0.9, 0.8, 0.2], [True, True, False]) == 1.0
    assert auc([0.5, 0.5, 0.5], [True, True, False]) == 0.5
    assert auc([0.1, 0.2, 0.9], [True, True, False]) == 0.0
    assert auc([0.1, 0.2], [True, True]) is None


def test_only_trials_of_both_runs_are_compared() -> None:
    """Unpaired trials say nothing about agreement."""
    physics = [digest(trial_row(trial=n, goals=YES if n else NO)) for n in range(4)]
    model = [digest(trial_row(trial=n, goals=YES, evaluator="analytic")) for n in range(3)]
    (row, _) = table(physics, model).rows
    assert [str(item) for item in row[:8]] == ["all", "2/3 (66.7 %)", "3/3 (100.0 %)", "2", "0", "1", "0", "0.667"]


def test_runs_without_a_common_trial_are_refused() -> None:
    """There is nothing to compare."""
    with pytest.raises(BadInputError, match="share no trial"):
        table([digest(trial_row())], [digest(trial_row(trial=1))])


def test_command_line_writes_the_table(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Two run folders in, one Markdown table out; a missing folder is one line and exit code 2."""
    for name, goals in (("a", YES), ("b", NO)):
        (tmp_path / name).mkdir()
        (tmp_path / name / "trials.jsonl").write_text(json.dumps(trial_row(goals=goals)) + "\n", encoding="utf-8")
    assert main([str(tmp_path / "a"), str(tmp_path / "b")]) == 0
    assert "| **all** | **1/1 (100.0 %)** | **0/1 (0.0 %)** |" in capsys.readouterr().out
    with pytest.raises(SystemExit) as stopped:
        main([str(tmp_path / "a"), str(tmp_path / "nowhere")])
    assert stopped.value.code == 2
    assert "no such file" in capsys.readouterr().err
