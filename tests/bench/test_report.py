"""The report: its numbers, its files, and that it stands alone."""

from __future__ import annotations

import csv
import io
import json
import re
from html.parser import HTMLParser
from pathlib import Path

import pytest

from agent.configuration import CONFIGURATIONS
from bench.paper_tables import FIVE_RUNS, PER_TASK, RECOVERED, TABLE_II, TABLE_III, TABLE_V
from bench.report import Extras, write_report
from bench.report.__main__ import main
from bench.report.contrasts import REGISTERED, adjusted, contrasts
from bench.report.findings import findings
from bench.report.noise import curves
from bench.report.page import html_table
from bench.report.recovery import endings, tables
from bench.report.results import Results
from bench.report.safety import satisfaction
from bench.report.success import headline, legend, other_suites, repetitions
from bench.report.table import Table
from bench.report.value import Count, Number, PValue, Span
from bench.trial import Trial, digest
from tests.report_fixtures import attempt_row, drawn_rows, error_row, goal_row, required_row, trial_row

SKILLS = {"full": 0.85, "no_recovery": 0.8, "heuristic_scene_graph": 0.6, "blind_retry": 0.7, "vlm_only": 0.3}


@pytest.fixture(scope="module")
def trials() -> list[Trial]:
    """A drawn run at two noise levels, with one harness error and a few trials of another suite."""
    rows = drawn_rows(SKILLS, trials=5, repetitions={"full": 2})
    rows += drawn_rows({"full": 0.6, "blind_retry": 0.4}, trials=5, noise=2.0)
    rows += [
        row | {"suite": "supplementary", "task": "filled_cup"} for row in drawn_rows(SKILLS, tasks=("single_cup",))
    ]
    rows[0] = error_row("full", rows[0]["task"])
    return [digest(row) for row in rows]


class Outline(HTMLParser):
    """Checks that tags close in order, and notes what a browser would fetch."""

    VOID = ("meta", "wbr", "br", "line", "rect", "circle", "polygon", "path", "link", "img")

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.fetched: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Opens a tag."""
        self.fetched += [str(value) for name, value in attrs if name in ("src", "srcset") or (tag == "link" and value)]
        if tag not in ("meta", "wbr", "br"):
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """A tag without content."""

    def handle_endtag(self, tag: str) -> None:
        """Closes the innermost tag."""
        assert self.open.pop() == tag


def test_page_is_one_file_that_fetches_nothing(trials: list[Trial], tmp_path: Path) -> None:
    """Well-formed, no address on the network, no script, no image file; every link of the menu has its chapter."""
    write_report(trials, tmp_path)
    html = (tmp_path / "report.html").read_text(encoding="utf-8")
    outline = Outline()
    outline.feed(html)
    assert outline.open == []
    assert outline.fetched == []
    assert re.findall(r"https?://(?!www\.w3\.org/2000/svg)", html) == []
    assert "<script" not in html
    assert "@import" not in html
    for anchor in re.findall(r'href="#([a-z]+)"', html):
        assert f'<section id="{anchor}">' in html


def test_report_is_the_same_for_any_order_of_trials(trials: list[Trial], tmp_path: Path) -> None:
    """Bytes of every file, whatever worker finished first."""
    first = write_report(trials, tmp_path / "a")
    second = write_report(list(reversed(trials)), tmp_path / "b")
    assert [path.read_bytes() for path in first] == [path.read_bytes() for path in second]


def test_all_promised_files_are_written(trials: list[Trial], tmp_path: Path) -> None:
    """report.html, tables.md, tables.tex and a CSV per table."""
    write_report(trials, tmp_path, Extras(facts={"command": "ragvlm bench"}))
    assert {"report.html", "tables.md", "tables.tex"} <= {path.name for path in tmp_path.iterdir()}
    assert {"cells.csv", "success.csv", "per_task.csv", "contrasts.csv"} <= {
        p.name for p in (tmp_path / "csv").iterdir()
    }
    assert "- command: ragvlm bench" in (tmp_path / "tables.md").read_text(encoding="utf-8")


def test_latex_is_balanced_and_escaped(trials: list[Trial], tmp_path: Path) -> None:
    """Every environment ends, and no bare underscore or percent sign is left."""
    write_report(trials, tmp_path)
    body = (tmp_path / "tables.tex").read_text(encoding="utf-8")
    assert body.count(r"\begin{table}") == body.count(r"\end{table}") > 10
    lines = [line for line in body.splitlines() if not line.startswith(("%", r"\label"))]
    assert [line for line in lines if re.search(r"(?<!\\)[_%#]", line)] == []


def test_every_configuration_of_the_report_is_explained(trials: list[Trial]) -> None:
    """The report says in words what each row is; vlm_only names the fixed default grasp that it uses."""
    results = Results(trials)
    said = {str(row[0]): row[1] for row in legend(results).rows}
    assert list(said) == list(results.configurations)
    assert "default grasp" in CONFIGURATIONS["vlm_only"].says
    assert all(said[name] == CONFIGURATIONS[name].says for name in said if name in CONFIGURATIONS)


def test_supplementary_tables_have_no_empty_columns() -> None:
    """A configuration that ran none of the tasks outside the twelve has no column there."""
    rows = [trial_row("full"), trial_row("heuristic"), trial_row("full", "filled_cup", suite="supplementary")]
    table = other_suites(Results([digest(row) for row in rows]))
    assert table.columns == ("suite", "task", "full")


def test_wide_tables_are_set_to_fit() -> None:
    """A table with more than twelve columns is marked wide, so that a page of 1300 pixels shows all of it; others are not."""
    assert '<table class="wide">' in html_table(Table("t", "T", tuple("abcdefghijklmn"), ()))
    assert "<table>" in html_table(Table("t", "T", ("a", "b"), (("x", "words"),)))
    assert '<th scope="col" class="words">' in html_table(Table("t", "T", ("a", "b"), (("x", "words"),)))


def test_headline_counts_every_trial_of_the_twelve_tasks(trials: list[Trial]) -> None:
    """Another noise level and another suite stay out; the harness error stays in, as a failure."""
    own = [t for t in trials if t.configuration == "full" and t.noise == 1.0 and t.suite == "tasks"]
    row = headline(Results(trials)).rows[0]
    assert row[4] == Count(sum(t.success for t in own), 120)
    assert row[-1] == 1


def test_repetitions_give_a_t_interval(trials: list[Trial]) -> None:
    """Two repetitions of full have an interval; the single ones of the others have none."""
    rows = {str(row[0]): row for row in repetitions(Results(trials)).rows}
    assert isinstance(rows["full"][-2], Span)
    assert rows["vlm_only"][-2] is None
    assert (rows["full"][-1], rows["vlm_only"][-1]) == (2, 1)


def test_contrasts_pair_the_same_worlds(trials: list[Trial]) -> None:
    """A rival with one repetition is compared on that one; blind_retry only where full's first attempt failed."""
    found = {item.name: item for item in contrasts(Results(trials))}
    assert found["vlm_only"].count == 60
    first_failed = [t for t in trials if t.configuration == "full" and t.noise == 2.0 and t.first_failed]
    assert found["blind_retry at noise 2"].count == len(first_failed)
    assert set(adjusted(list(found.values()))) == set(found) & set(REGISTERED)


def test_words_follow_the_test() -> None:
    """A clear lead is "shown"; no lead is "not shown", and where it lags is named."""
    rows = [trial_row("full", "single_cup", trial=n) for n in range(30)]
    rows += [trial_row("vlm_only", "single_cup", trial=n, goals=[goal_row([attempt_row(0, False)])]) for n in range(30)]
    rows += [trial_row("no_memory", "single_cup", trial=n) for n in range(30)]
    unclear, beaten, harness = findings(Results(map(digest, rows)))
    assert beaten.mark == "shown"
    assert beaten.words.startswith("full beats vlm_only: +100.0 pp on 30 paired trials, p < 0.001 after Holm")
    assert unclear.mark == "not shown"
    assert "does not show that full beats no_memory: 0.0 pp" in unclear.words
    assert harness.words == "None of the 90 trials ended in a harness error."


def test_a_worse_system_is_called_worse() -> None:
    """The report does not spare its own side."""
    rows = [trial_row("full", "single_cup", trial=n, goals=[goal_row([attempt_row(0, False)])]) for n in range(30)]
    rows += [trial_row("heuristic", "single_cup", trial=n) for n in range(30)]
    first = findings(Results(map(digest, rows)))[0]
    assert first.mark == "worse"
    assert "behind on single_cup (0 against 30 of 30)" in first.words


def test_recovery_by_hand() -> None:
    """Three sub-goals: first try, recovered with the third attempt, never solved: 2.67 attempts, 1 of 2 recovered."""
    goals = [[attempt_row(0, True)], [attempt_row(0, False), attempt_row(1, False), attempt_row(2, True)]]
    goals.append([attempt_row(level, False) for level in range(4)])
    own = [digest(trial_row(trial=n, goals=[goal_row(item)])) for n, item in enumerate(goals)]
    found = tables(Results(own))
    assert found[0].rows[0][1:] == (Count(1, 3), Number(8 / 3), Number(3.0), Number(4.0), Count(1, 2), Count(1, 2))
    assert endings(own) == {"first try": 1, "retry 2": 1, "not solved": 1}
    efficacy = {str(row[0]): row for row in found[2].rows}
    assert efficacy["SLIP"][1:] == (Count(0, 2), Count(1, 2), Count(0, 1), Count(1, 5))


def test_unmoved_trials_are_not_vacuously_satisfied() -> None:
    """A harness error in a task with a constraint costs the satisfaction."""
    kept = trial_row("full", "cup_near_vase", constraints=[required_row()])
    assert satisfaction([digest(kept), digest(error_row("full", "cup_near_vase", trial=1))]) == Count(1, 2)


def test_paper_data_reproduce_the_printed_figures() -> None:
    """Counts of Table II give every printed share; Table III repeats them; recovered trials follow from them."""
    printed = {"full": 78.3, "no_recovery": 46.7, "no_memory": 76.4, "no_scene_graph": 65.3, "heuristic": 74.7,
               "no_haarag": 25.0, "vlm_only": 25.0}  # fmt: skip
    assert {row.configuration: round(100 * row.total / 360, 1) for row in TABLE_II} == printed
    full, without = TABLE_II[0], TABLE_II[1]
    assert (full.total - without.total, 360 - without.total) == RECOVERED
    sizes = {"SG": 180, "IT": 120, "LH": 60}
    for row in TABLE_III:
        source = full if row.configuration == "full" else without
        assert row.success == pytest.approx(source.counts[row.category] / sizes[row.category], abs=6e-4)
    assert (PER_TASK["single_apple"], FIVE_RUNS["mean"], TABLE_V[-1].satisfied) == (18, 0.787, 0.75)


def test_paper_tables_stand_beside_ours(trials: list[Trial], tmp_path: Path) -> None:
    """All four tables, IV from the evaluation of the retrieval."""
    systems = {"haarag": {"p_at_1": 0.95, "p_at_3": 0.9, "mrr": 0.96, "affordance_match": 0.9, "r_func_p_at_1": 0.93}}
    write_report(trials, tmp_path, Extras(retrieval={"systems": systems, "queries": 60}))
    body = (tmp_path / "tables.md").read_text(encoding="utf-8")
    for number in ("II", "III", "IV", "V"):
        assert f"### Table {number}:" in body
    assert "| HAA-RAG | 0.917 | 0.917 | 0.917 | 0.917 | 0.950 | 0.900 | 0.960 | 0.900 | 0.930 |" in body
    assert "| VLM-Only | 50.0 % | 0.0 % | 0.0 % | 25.0 % | −53.3 |" in body


def test_csv_splits_values_into_numbers() -> None:
    """A count fills two columns, an interval two, an empty cell stays empty."""
    table = Table(
        "t", "T", ("a", "b", "c", "d"), (("x", Count(1, 3), Span(0.1, 0.2), None), ("y", None, None, PValue(0.5)))
    )
    rows = list(csv.reader(io.StringIO(table.csv())))
    assert rows == [
        ["a", "b k", "b n", "c low", "c high", "d p"],
        ["x", "1", "3", "0.1", "0.2", ""],
        ["y", "", "", "", "", "0.5"],
    ]


def test_command_line(trials: list[Trial], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A folder in, its report out; mixed evaluators are refused in one line."""
    rows = [trial_row(trial=n) for n in range(2)]
    (tmp_path / "trials.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows), encoding="utf-8")
    assert main([str(tmp_path)]) == 0
    assert capsys.readouterr().out.strip() == str(tmp_path / "report.html")
    rows[1]["evaluator"] = "analytic"
    (tmp_path / "trials.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows), encoding="utf-8")
    with pytest.raises(SystemExit):
        main([str(tmp_path)])
    assert "different evaluators" in capsys.readouterr().err


def test_noise_curves_compare_the_same_worlds() -> None:
    """A curve counts only worlds that every configuration of it saw at every noise, whatever else ran at one of them."""
    rows = [row for level in (1.0, 2.0) for row in drawn_rows({"full": 0.7, "vlm_only": 0.3}, trials=5, noise=level)]
    plain = Results([digest(row) for row in rows])
    more = drawn_rows({"full": 1.0, "blind_retry": 1.0}, trials=9, noise=2.0, tasks=("single_cup",))
    wider = Results([digest(row) for row in [*rows, *(row for row in more if row["trial"] >= 5)]])
    assert curves(wider) == curves(plain)
    assert set(curves(plain)) == {"full", "vlm_only"}
    assert curves(Results([trial for trial in plain.all if trial.noise == 1.0])) == {}
