"""What the report says in words, and the tables beside it: nothing that a sceptic would have to look for himself."""

from __future__ import annotations

from typing import Any

from bench.report.diagnosis import tables as failure_tables
from bench.report.findings import findings
from bench.report.paper import components
from bench.report.predictions import habits
from bench.report.recovery import tables as recovery_tables
from bench.report.results import Results
from bench.report.success import legend
from bench.report.value import Count, Points
from bench.report.write_report import facts
from bench.trial import digest
from tests.report_fixtures import attempt_row, goal_row, trial_row

Row = dict[str, Any]
FAILED = [goal_row([attempt_row(0, False)])]


def _rows(configuration: str, task: str, good: int, count: int = 30, **more: Any) -> list[Row]:
    """So many trials, the first ones of which succeed."""
    won = [trial_row(configuration, task, trial=n, **more) for n in range(good)]
    return won + [trial_row(configuration, task, trial=n, goals=FAILED, **more) for n in range(good, count)]


def _results(*rows: list[Row]) -> Results:
    return Results(digest(row) for part in rows for row in part)


def test_a_lead_of_one_task_is_said_to_be_one() -> None:
    """The words name where full lags, what is left without the task that makes the lead, and the interval over tasks."""
    found = findings(
        _results(
            _rows("full", "single_cup", 30),
            _rows("full", "clear_table", 28),
            _rows("heuristic_scene_graph", "single_cup", 0),
            _rows("heuristic_scene_graph", "clear_table", 30),
        )
    )[0]
    assert found.mark == "shown"
    assert "ahead on single_cup (30 against 0 of 30); behind on clear_table (28 against 30 of 30)." in found.words
    assert found.words.endswith(
        " Without single_cup it is 28 against 30 of 30. With the tasks drawn anew as well, the interval includes zero."
    )


def test_variants_that_do_as_well_are_named() -> None:
    """A configuration outside the registered family that full is not ahead of stands among the findings."""
    said = findings(
        _results(
            _rows("full", "single_cup", 29),
            _rows("geometry_only", "single_cup", 30),
            _rows("oracle_phi", "single_cup", 29),
            _rows("random_in_category", "single_cup", 20),
        )
    )
    assert said[0].mark == "not shown"
    assert said[0].words == (
        "Not registered, and full is not ahead of them either: geometry_only (29 against 30 of 30) and oracle_phi (29 "
        "against 29 of 30)."
    )


def test_changes_of_table_two_are_of_the_same_worlds() -> None:
    """More repetitions of full than of the rest do not move the change against full; the row without a model says so."""
    results = _results(
        _rows("full", "single_cup", 30),
        _rows("full", "single_cup", 0, repetition=1),
        _rows("vlm_only", "single_cup", 15),
    )
    table = components(results)
    rows = {str(row[0]): row for row in table.rows}
    assert rows["VLM-Only"][-2:] == (Count(15, 30), Points(-0.5))
    assert "No vision-language model took part" in table.note
    assert "No vision-language model took part" in legend(results).note
    assert facts(results)["repetitions"] == "1 to 2"


def test_without_a_memory_there_are_no_hits_to_count() -> None:
    """Memory hits stay empty where the configuration has no memory."""
    rows = {
        row[0]: row
        for row in habits(_results(_rows("full", "single_cup", 1), _rows("no_memory", "single_cup", 1))).rows
    }
    assert (rows["full"][2], rows["no_memory"][2]) == (Count(0, 0), None)


def test_corrections_and_diagnoses_are_also_pooled() -> None:
    """Where full seldom fails, its other noises and the other configurations fill the tables; those told the truth stay out."""
    goals = [goal_row([attempt_row(0, False), attempt_row(1, True)])]
    rows = [trial_row(name, "single_cup", goals=goals) for name in ("full", "heuristic", "oracle_phi")]
    rows.append(trial_row("full", "single_cup", noise=2.0, goals=goals))
    results = _results(rows)
    efficacy = {table.name: table for table in recovery_tables(results)}
    assert [efficacy[f"efficacy{suffix}"].rows[-1][-1] for suffix in ("", "_noises", "_all")] == [
        Count(1, 1), Count(2, 2), Count(2, 2),
    ]  # fmt: skip
    assert [row[3] for row in efficacy["recovery_by_noise"].rows if row[0] == "full"] == [Count(1, 1), Count(1, 1)]
    pooled = {table.name: table.rows[-1][-1] for table in failure_tables(results) if table.name.startswith("confusion")}
    assert [count.n for count in pooled.values() if isinstance(count, Count)] == [1, 2, 2]
