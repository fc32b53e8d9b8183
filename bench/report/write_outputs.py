"""All that a run leaves beside its trials: summary.json and the report."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

from bench.cells import Summary, summarise, write_summary
from bench.report.write_report import Extras, write_report
from bench.trial import read_trials

TRIALS, RUN = "trials.jsonl", "run.json"


def write_outputs(folder: Path, extras: Extras | None = None) -> Summary:
    """Writes summary.json, report.html, tables.md, tables.tex and csv/ from the folder's trials.

    Args:
        folder: Output folder of `ragvlm bench`; its run.json tells command, workers and wall time.
        extras: Further input of the report.

    Returns:
        What is in summary.json.

    Raises:
        BadInputError: the folder holds no usable trials.
    """
    extras = extras or Extras()
    trials = read_trials(folder / TRIALS)
    sittings = _sittings(folder / RUN)
    summary = summarise(
        trials,
        wall_s=sum(float(sitting["wall_s"]) for sitting in sittings) if sittings else None,
        workers=int(sittings[-1]["workers"]) if sittings else 1,
    )
    write_summary(summary, folder)
    write_report(
        trials, folder, replace(extras, facts={**_facts(sittings, summary), **extras.facts}, folders=(folder,))
    )
    return summary


def _sittings(path: Path) -> list[dict[str, Any]]:
    if not path.is_file():
        return []
    found: list[dict[str, Any]] = json.loads(path.read_text(encoding="utf-8")).get("sessions", [])
    return found


def _facts(sittings: list[dict[str, Any]], summary: Summary) -> dict[str, str]:
    if not sittings:
        return {}
    known = {"wall time": f"{summary.wall_s / 60:.1f} min on {summary.workers} workers"}
    if sittings[-1].get("commit"):
        known["commit"] = str(sittings[-1]["commit"])[:8]
    if sittings[-1].get("command"):
        known["command"] = str(sittings[-1]["command"])
    if sittings[-1].get("finished"):
        known["finished"] = str(sittings[-1]["finished"])
    return known
