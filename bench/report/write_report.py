"""Writes the report of a run: report.html, tables.md, tables.tex, csv/*.csv.

    python -m bench.report DIR [DIR ...] [--analytic DIR] [--retrieval FILE] [--learning DIR] [--out DIR]

The same trials give the same bytes: the report holds no date of its own and every resample is seeded.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from bench import agreement
from bench.cells import cells
from bench.report import (
    contrasts,
    diagnosis,
    learning,
    mishaps,
    noise,
    paper,
    predictions,
    recovery,
    runs,
    safety,
    success,
    times,
)
from bench.report.chart_parts import failure_chart, flow_chart, ladder_chart, time_chart
from bench.report.chart_success import contrast_chart, noise_chart, success_chart
from bench.report.findings import Finding, cards, findings
from bench.report.page import Section, page
from bench.report.results import Results
from bench.report.table import Table
from bench.trial import Trial

TITLE = "Benchmark of Agentic RAG-VLM"
CELL_COLUMNS = (
    "configuration", "task", "suite", "noise", "n", "successes", "harness_errors", "damage_events", "attempts",
    "constraints_required", "constraints_satisfied", "claimed", "false_claims", "subgoals", "first_successes",
    "recovered", "first_failures",
)  # fmt: skip


@dataclass(frozen=True)
class Extras:
    """What a report may also hold."""

    facts: Mapping[str, str] = field(default_factory=dict)
    """Facts about the run that its trials do not tell: command, commit, date."""
    analytic: Sequence[Trial] = ()
    """The same trials under the analytic evaluator."""
    retrieval: Mapping[str, Any] | None = None
    """Content of the file of `ragvlm kb eval --json`."""
    learning: Mapping[str, Any] | None = None
    """Content of the file summary.json of `python -m bench.learn_study`."""
    folders: Sequence[Path] = ()
    """Where the trials are from; their run.json tells commands, commits and dates."""


def write_report(trials: Sequence[Trial], folder: Path, extras: Extras | None = None) -> list[Path]:
    """Writes all files of the report.

    Args:
        trials: The run's trials, in any order.
        folder: Where to write; made if it does not exist.
        extras: Further input.

    Returns:
        The files written.
    """
    extras = extras or Extras()
    results = Results(trials)
    sections = chapters(results, extras)
    tables = [table for section in sections for table in section.tables]
    known = {**facts(results), **extras.facts}
    found = findings(results)
    (folder / "csv").mkdir(parents=True, exist_ok=True)
    files = {
        "report.html": page(TITLE, subtitle(results), known, cards(results), found, sections),
        "tables.md": markdown(known, found, sections),
        "tables.tex": "\n".join(["% Needs \\usepackage{booktabs}.", *(table.tex() for table in tables)]),
        "csv/cells.csv": cell_table(results).csv(),
        **{f"csv/{table.name}.csv": table.csv() for table in tables},
    }
    for name, content in files.items():
        (folder / name).write_text(content, encoding="utf-8")
    return [folder / name for name in files]


def facts(results: Results) -> dict[str, str]:
    """What the trials themselves say about the run."""
    first = results.all[0]
    seeds = [t.seed for t in results.all if t.seed is not None]
    return {
        "trials": f"{len(results.all):,}",
        "tasks": str(len(results.tasks)),
        "configurations": str(len(results.configurations)),
        "repetitions": _repetitions(results),
        "evaluator": first.evaluator,
        "perception": ", ".join(dict.fromkeys(t.perception for t in results.all)),
        "brain": first.brain,
        "seeds": f"{min(seeds)} to {max(seeds)}" if seeds else "–",
        "noise": ", ".join(f"{level:g}" for level in results.noises),
    }


def _repetitions(results: Results) -> str:
    """How often the configurations were repeated; a range where some were repeated oftener than others."""
    counts = [len({t.repetition for t in results.all if t.configuration == name}) for name in results.configurations]
    return str(counts[0]) if min(counts) == max(counts) else f"{min(counts)} to {max(counts)}"


def subtitle(results: Results) -> str:
    """One line below the title."""
    judge = "contact physics (MuJoCo)" if results.all[0].evaluator == "mujoco" else "the analytic quality model"
    return (
        f"Success is the word of an independent observer of {judge}. Every configuration sees the same worlds; counts "
        "stand before percentages; every failure counts."
    )


def chapters(results: Results, extras: Extras) -> list[Section]:
    """The chapters of the report, in order."""
    agreed = [agreement.table(results.all, extras.analytic)] if extras.analytic else []
    study = extras.learning
    grown = (
        [(learning.growth_chart(study), "Each dot is a block of trials, in the order they were seen.")] if study else []
    )
    return [
        Section("success", "Success", "", [(success_chart(results), "Dots: success; lines: 95 % Wilson intervals.")],
                success.tables(results)),
        Section("contrasts", "Contrasts", "Differences on the same worlds.",
                [(contrast_chart(results), "Full minus the other, percentage points, with 95 % bootstrap intervals; "
                  "registered contrasts in bold, blue where the interval excludes zero.")], contrasts.tables(results)),
        Section("recovery", "Recovery", "", [(ladder_chart(results), "With which attempt sub-goals were solved."),
                (flow_chart(results), "The sub-goals of full on the ladder: blue flows were solved, orange went on to "
                 "the next level, red ended unsolved.")], [*recovery.tables(results), *mishaps.tables(results)]),
        Section("safety", "Safety and constraints", "", [], safety.tables(results)),
        Section("predictions", "Predictions, forces and habits", "", [], predictions.tables(results)),
        Section("failures", "Failures and diagnosis", "",
                [(failure_chart(results), "Failed attempts by the observer's label.")], diagnosis.tables(results)),
        Section("noise", "Noise", "", [(noise_chart(results), "Bands: 95 % Wilson intervals.")], noise.tables(results)),
        Section("time", "Time", "", [(time_chart(results), "Mean wall time per trial by part.")], times.tables(results)),
        Section("learning", "Learning", "", grown, learning.tables(study) if study else []),
        Section("agreement", "Two evaluators", "", [], agreed),
        Section("paper", "Beside the paper", "", [], paper.tables(results, extras.retrieval)),
        Section("runs", "Runs", "", [], [listed] if (listed := runs.table(extras.folders)) else []),
    ]  # fmt: skip


def markdown(known: Mapping[str, str], found: Sequence[Finding], sections: Sequence[Section]) -> str:
    """tables.md."""
    lines = [
        f"# {TITLE}",
        "",
        *(f"- {name}: {value}" for name, value in known.items()),
        "",
        "## What this run shows",
        "",
    ]
    lines += [f"- **{finding.mark}** {finding.words}" for finding in found]
    for section in sections:
        if section.tables:
            lines += ["", f"## {section.title}", "", "\n".join(table.markdown() for table in section.tables).rstrip()]
    return "\n".join(lines) + "\n"


def cell_table(results: Results) -> Table:
    """All cells as integers, also those at other noise levels."""
    rows = tuple(
        tuple(f"{cell.noise:g}" if name == "noise" else getattr(cell, name) for name in CELL_COLUMNS)
        for cell in cells(results.all)
    )
    return Table("cells", "All cells", CELL_COLUMNS, rows)


def read_retrieval(path: Path) -> Mapping[str, Any]:
    """The measured retrieval quality."""
    found: Mapping[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return found
