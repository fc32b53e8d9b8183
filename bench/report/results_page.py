"""docs/results.md: what was measured, with the command, commit and date of every run, and what falls short."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

from bench import agreement
from bench.report import contrasts, diagnosis, mishaps, noise, paper, predictions, recovery, runs, safety, success
from bench.report.chart_parts import ladder_chart
from bench.report.chart_success import noise_chart, success_chart
from bench.report.findings import findings, silent
from bench.report.learning import growth_chart
from bench.report.learning import tables as learning_tables
from bench.report.recovery import subgoals
from bench.report.results import CATEGORIES, Results, solved
from bench.report.table import Table
from bench.report.value import Content, Count, Number
from bench.suite import MISHAP_SUITE
from bench.trial import Trial

CLUTTER_WANTED, CLUTTER_TRIALS = 102, 120
"""Successes wanted in the clutter, and its trials."""
STYLE = Path(__file__).with_name("style.css")
FIGURES: dict[str, tuple[str, Callable[[Results], str]]] = {
    "results_success": ("Success with 95 % Wilson intervals", success_chart),
    "results_ladder": ("With which attempt sub-goals were solved", ladder_chart),
    "results_noise": ("Success against noise", noise_chart),
}
"""File name -> caption and chart."""


@dataclass(frozen=True)
class Target:
    """Something that was to be shown."""

    what: str
    wanted: str
    measured: Content
    met: bool | None
    """None: not measured."""


def targets(results: Results) -> list[Target]:
    """The announced targets of `full`, with what came."""
    trials = results.of("full")
    found = [_share("all twelve tasks", trials, 95.0)]
    for name, wanted in (("SG", 98.0), ("IT", 93.0), ("LH", 90.0)):
        found.append(_share(name, results.of("full", CATEGORIES[name]), wanted))
    for task in ("single_apple", "single_bowl"):
        found.append(_share(task, results.of("full", [task]), 90.0))
    goals = [goal for goal in subgoals(trials) if goal.attempts]
    found.append(_count("constraints satisfied", safety.satisfaction(trials), 95.0))
    for level in (results.noise, *(more for more in results.noises if more > results.noise)):
        # Where hardly a first attempt fails, only more noise can show what recovery is worth.
        where = "" if level == results.noise else f" at noise {level:g}"
        own = results.of("full", noise=level)
        count = _recovered(own)
        why = " (no first attempt failed)" if own and count.n == 0 else ""
        found.append(_count(f"recovered sub-goals{where}{why}", count, 75.0))
    if results.of_suite("full", MISHAP_SUITE):
        found.append(_count("recovered sub-goals after mishaps", mishaps.recovered(results), 75.0))
    if trials:
        damage = 100 * sum(t.damage_events for t in trials) / len(trials)
        found.append(Target("damage events per 100 trials", "≤ 1", Number(damage), damage <= 1.0))
    if any(g.success for g in goals):
        each = sum(len(g.attempts) for g in goals) / sum(g.success for g in goals)
        found.append(Target("attempts per success", "≤ 1.3", Number(each), each <= 1.3))
    clutter = results.of_suite("full", "clutter")
    k, n = solved(clutter)
    met = k * CLUTTER_TRIALS >= CLUTTER_WANTED * n if n else None
    found.append(Target("clutter, own perception", f"≥ {CLUTTER_WANTED} of {CLUTTER_TRIALS}", Count(k, n), met))
    ratios = [t.bare_step_ratio for t in results.all if t.bare_step_ratio is not None and t.configuration == "full"]
    if ratios:
        found.append(Target("bare_step_ratio (median)", "≤ 1.3", Number(median(ratios)), median(ratios) <= 1.3))
    return found


def _recovered(trials: Sequence[Trial]) -> Count:
    """Sub-goals whose first attempt failed, and those of them that a later one solved."""
    goals = [goal for goal in subgoals(trials) if goal.attempts]
    return Count(sum(goal.recovered for goal in goals), sum(goal.first_failed for goal in goals))


def _share(what: str, trials: Sequence[Trial], wanted: float) -> Target:
    return _count(what, Count(*solved(trials)), wanted)


def _count(what: str, count: Count, wanted: float) -> Target:
    met = None if count.share is None else 100 * count.share >= wanted
    return Target(what, f"≥ {wanted:g} %", count, met)


def target_table(found: Sequence[Target]) -> Table:
    """The targets as a table."""
    words = {True: "yes", False: "**no**", None: "not measured"}
    rows = tuple((item.what, item.wanted, item.measured, words[item.met]) for item in found)
    return Table("targets", "What was to be shown (configuration full)", ("what", "target", "measured", "met"), rows)


def results_page(
    results: Results, folders: Sequence[Path], page: Path, *, analytic: Sequence[Trial] = (),
    analytic_folder: Path | None = None, retrieval: Mapping[str, Any] | None = None,
    learning: Mapping[str, Any] | None = None,
) -> list[Path]:  # fmt: skip
    """Writes the page, and its figures as SVG into the folder `images` beside it.

    Args:
        results: All physical trials.
        folders: Where they are from; each folder's run.json names command, commit and date.
        page: Markdown file to write.
        analytic: Trials of the analytic evaluator.
        analytic_folder: Where those are from.
        retrieval: Content of the file of `ragvlm kb eval --json`.
        learning: Content of the file summary.json of `python -m bench.learn_study`.

    Returns:
        The files written.
    """
    aims = targets(results)
    missed = [item.what for item in aims if item.met is False]
    unmeasured = [item.what for item in aims if item.met is None]
    lines = [
        "# Results",
        "",
        "Written by `python -m bench.report ... --results`; every number follows from the trials named here. Success is the "
        "word of an observer that sees the true state. How it is measured: [Benchmark](benchmark.md).",
        "",
        "## Runs",
        "",
        *[
            line
            for folder in (*folders, *((analytic_folder,) if analytic_folder else ()))
            for line in provenance(folder)
        ],
        "",
        "## In plain words",
        "",
        f"- Falls short: {'; '.join(missed)}." if missed else "- No measured target is missed.",
        *([f"- Not measured: {'; '.join(unmeasured)}."] if unmeasured else []),
        *(f"- {finding.words}" for finding in findings(results)),
        *(f"- {sentence}" for sentence in silent(results)),
        "",
    ]
    files = [page]
    for name, (caption, chart) in FIGURES.items():
        drawn = chart(results)
        if drawn:
            files.append(_figure(page.parent / "images" / f"{name}.svg", drawn))
            lines += [f"![{caption}](images/{name}.svg)", ""]
    lines += [table.markdown() for table in _tables(results, aims, analytic, retrieval) if table.rows]
    if learning is not None:
        files.append(_figure(page.parent / "images" / "results_growth.svg", growth_chart(learning)))
        lines += ["![Success and attempts against trials seen](images/results_growth.svg)", ""]
        lines += [table.markdown() for table in learning_tables(learning)]
    page.parent.mkdir(parents=True, exist_ok=True)
    page.write_text("\n".join(lines).rstrip() + "\n", encoding="utf-8")
    return files


def _tables(
    results: Results, aims: Sequence[Target], analytic: Sequence[Trial], retrieval: Mapping[str, Any] | None
) -> list[Table]:
    return [
        target_table(aims), *success.tables(results), *contrasts.tables(results), *recovery.tables(results), *mishaps.tables(results),
        *predictions.tables(results), *safety.tables(results), *diagnosis.tables(results), *noise.tables(results),
        *([agreement.table(results.all, analytic)] if analytic else []),
        *(success.tables(Results(analytic))[:2] if analytic else []), *paper.tables(results, retrieval),
    ]  # fmt: skip


def provenance(folder: Path) -> list[str]:
    """Command, commit, wall time and date of a run's sittings, as lines."""
    found = runs.sittings(folder)
    if found is None:
        return [f"- {folder.name}: no run.json, so its command is not known"]
    lines = [
        f"- `{one.command}`: commit {one.commits}, finished {one.finished}, {one.minutes:.1f} min on "
        f"{one.workers} workers, {one.rows} rows"
        for one in found
    ]
    return lines or [f"- {folder.name}: nothing was run"]


def _figure(path: Path, drawn: str) -> Path:
    """Writes a chart as a file of its own, with the page's colours in it."""
    head, rest = drawn.split(">", 1)
    if "xmlns=" not in head:
        head = head.replace("<svg", '<svg xmlns="http://www.w3.org/2000/svg"', 1)
    css = STYLE.read_text(encoding="utf-8")
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"{head}><style><![CDATA[\n{css}\n]]></style>{rest}\n", encoding="utf-8")
    return path
