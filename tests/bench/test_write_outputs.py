"""All that a finished run leaves behind."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from bench.report import write_outputs
from bench.trial import digest
from kb.errors import BadInputError
from tests.report_fixtures import attempt_row, drawn_rows, error_row, goal_row, trial_row


def filled(folder: Path, rows: list[dict[str, object]], sessions: list[dict[str, object]] | None = None) -> Path:
    """A run folder."""
    folder.mkdir(exist_ok=True)
    (folder / "trials.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows), encoding="utf-8")
    if sessions is not None:
        (folder / "run.json").write_text(json.dumps({"schema_version": 1, "sessions": sessions}), encoding="utf-8")
    return folder


def test_summary_and_report_of_a_folder(tmp_path: Path) -> None:
    """The wall time of all sittings is added up; command and workers are those of the last; all files are there."""
    sittings = [{"command": "ragvlm bench", "workers": 1, "wall_s": 10.0, "commit": "0123abcdef+", "rows": 9}, {"command": "ragvlm bench --resume",
                "workers": 2, "wall_s": 5.5, "finished": "2026-01-01T00:00:00Z"}]  # fmt: skip
    filled(tmp_path, drawn_rows({"full": 0.9}, trials=2), sittings)
    summary = write_outputs(tmp_path)
    assert (summary.wall_s, summary.workers, summary.trials) == (15.5, 2, 24)
    assert json.loads((tmp_path / "summary.json").read_text())["trials"] == 24
    assert "- command: ragvlm bench --resume" in (tmp_path / "tables.md").read_text()
    said = (tmp_path / "csv" / "runs.csv").read_text().splitlines()[1:]
    assert said == ["ragvlm bench,0123abcd with uncommitted changes,None,0.166667,1,9",
                    "ragvlm bench --resume,unknown,2026-01-01T00:00:00Z,0.091667,2,0"]  # fmt: skip
    assert {"report.html", "tables.tex", "csv"} <= {path.name for path in tmp_path.iterdir()}


def test_an_empty_folder_is_bad_input(tmp_path: Path) -> None:
    """Nothing is written where nothing was run."""
    with pytest.raises(BadInputError, match="no such file"):
        write_outputs(tmp_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "rows",
    [
        [trial_row()],
        [trial_row(goals=[])],
        [error_row("full", "single_cup")],
        [trial_row("vlm_only", goals=[goal_row([attempt_row(0, False)])])],
        [trial_row("own_idea", "my_task")],
        [trial_row(suite="clutter", task="clutter_cup")],
        [trial_row(noise=0.0), trial_row(noise=3.0)],
        [trial_row(evaluator="analytic", perception="oracle")],
    ],
    ids=["one", "nothing tried", "harness error", "only failure", "unknown names", "clutter", "noise", "analytic"],
)
def test_small_and_odd_runs_have_a_report(tmp_path: Path, rows: list[dict[str, object]]) -> None:
    """A run of one trial, without success, without the twelve tasks or without `full` is reported all the same."""
    summary = write_outputs(filled(tmp_path, rows))
    assert summary.trials == len(rows)
    html = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "nan" not in html.lower().replace("banana", "")
    assert "None</" not in html
    assert all(digest(row).configuration in html for row in rows)
