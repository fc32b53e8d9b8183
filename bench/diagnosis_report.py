"""Measures the robot's own diagnosis: provoked failures, what it says from its sensing, what the observer saw.

    python -m bench.diagnosis_report --seeds 20 --markdown docs/diagnosis.md

Rows of the confusion matrix are the observer's labels of failed attempts, columns the robot's own words.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from bench.attempt_once import attempt_once
from bench.provocations import PROVOCATIONS
from kb.base import Noun
from kb.errors import EnvironmentFaultError
from kb.vocabulary import FAILURE_TYPES, PerceptionName

ENOUGH = 15
"""Failed attempts of a type from which its accuracy counts."""


class Case(Noun):
    """One provoked attempt."""

    provocation: str
    scene: str
    seed: int
    observed_success: bool
    observed: str | None
    claimed: bool
    diagnosed: str | None
    reasons: tuple[str, ...] = ()


class DiagnosisReport(Noun):
    """All cases and what follows from them."""

    cases: tuple[Case, ...]

    def confusion(self) -> dict[str, Counter[str]]:
        """Observer's label -> counts of the robot's labels ("success" where it claimed it)."""
        table: dict[str, Counter[str]] = {}
        for case in self.cases:
            if not case.observed_success and case.observed is not None:
                said = "success" if case.claimed else str(case.diagnosed)
                table.setdefault(case.observed, Counter())[said] += 1
        return table

    def accuracies(self) -> dict[str, tuple[int, int]]:
        """Right answers and failed attempts of each type with enough of them."""
        table = self.confusion()
        return {
            kind: (table[kind][kind], sum(table[kind].values()))
            for kind in FAILURE_TYPES
            if kind in table and sum(table[kind].values()) >= ENOUGH
        }

    def macro_accuracy(self) -> float:
        """Mean accuracy over the types with enough attempts."""
        shares = [right / count for right, count in self.accuracies().values()]
        return sum(shares) / len(shares) if shares else 0.0

    def false_claims(self) -> tuple[int, int]:
        """Claims of success that the observer denies, and all claims."""
        claims = [case for case in self.cases if case.claimed]
        return sum(not case.observed_success for case in claims), len(claims)

    def missed_successes(self) -> tuple[int, int]:
        """Successes that the robot did not claim, and all successes."""
        good = [case for case in self.cases if case.observed_success]
        return sum(not case.claimed for case in good), len(good)


def gather(seeds: int, first_seed: int, perception: PerceptionName, workers: int) -> DiagnosisReport:
    """Carries out every provocation on `seeds` worlds, and undisturbed attempts beside."""
    jobs: list[tuple[int | None, str, int, PerceptionName]] = []
    for number, provocation in enumerate(PROVOCATIONS):
        for k in range(seeds):
            jobs.append((number, provocation.scenes[k % len(provocation.scenes)], first_seed + k, perception))
    scenes = sorted({scene for provocation in PROVOCATIONS for scene in provocation.scenes})
    jobs.extend((None, scene, first_seed + k, perception) for scene in scenes for k in range(seeds))
    if workers <= 1:
        found = [_case(job) for job in jobs]
    else:
        with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
            found = list(pool.map(_case, jobs, chunksize=4))
    return DiagnosisReport(cases=tuple(case for case in found if case is not None))


def _case(job: tuple[int | None, str, int, PerceptionName]) -> Case | None:
    number, scene, seed, perception = job
    provocation = PROVOCATIONS[number] if number is not None else None
    bend = provocation.bend if provocation is not None else None
    once = attempt_once(scene, seed, perception=perception, store=_store(), bend=bend)
    if once is None or once.observed is None or once.diagnosis is None:
        return None
    return Case(
        provocation=provocation.name if provocation is not None else "undisturbed",
        scene=scene,
        seed=seed,
        observed_success=once.observed.success,
        observed=once.observed.failure,
        claimed=once.diagnosis.claimed,
        diagnosed=once.diagnosis.failure,
        reasons=once.diagnosis.reasons,
    )


def _store() -> Any:
    from kb.store import ExperienceStore

    try:
        return ExperienceStore.open()
    except EnvironmentFaultError:
        return None


def markdown(report: DiagnosisReport) -> str:
    """The report as a page."""
    table, (false, claims), (missed, good) = report.confusion(), report.false_claims(), report.missed_successes()
    said = [kind for kind in FAILURE_TYPES if any(row[kind] for row in table.values())]
    said += ["success"] if any(row["success"] for row in table.values()) else []
    lines = [
        "# The robot's own diagnosis",
        "",
        f"{len(report.cases)} attempts, provoked and undisturbed. Macro accuracy over the "
        f"{len(report.accuracies())} types with at least {ENOUGH} failed attempts: "
        f"{100 * report.macro_accuracy():.1f} %.",
        f"False claims of success: {false} of {claims}. Successes not claimed: {missed} of {good}.",
        "",
        "Rows: the observer's label. Columns: what the robot says from its own sensing.",
        "",
        "| observed | " + " | ".join(said) + " | n | right |",
        "|---|" + "---|" * (len(said) + 2),
    ]
    for kind in FAILURE_TYPES:
        if kind in table:
            row, count = table[kind], sum(table[kind].values())
            numbers = " | ".join(str(row[word]) if row[word] else "" for word in said)
            lines.append(f"| {kind} | {numbers} | {count} | {100 * row[kind] / count:.0f} % |")
    return "\n".join(lines) + "\n"


def main(argv: Sequence[str] | None = None) -> int:
    """Command line; exit code 0 if the diagnosis is as good as demanded."""
    parser = argparse.ArgumentParser(prog="python -m bench.diagnosis_report", description="Measures the diagnosis.")
    parser.add_argument("--seeds", type=int, default=40, help="worlds per provocation")
    parser.add_argument("--first-seed", type=int, default=10000)
    parser.add_argument("--perception", choices=("rgbd", "oracle"), default="rgbd")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--jsonl", type=Path, help="write one line an attempt")
    parser.add_argument("--markdown", type=Path, help="write the report there (default: standard output)")
    given = parser.parse_args(argv)
    report = gather(given.seeds, given.first_seed, given.perception, given.workers)
    if given.jsonl is not None:
        rows = "".join(json.dumps(case.model_dump(mode="json")) + "\n" for case in report.cases)
        given.jsonl.write_text(rows, encoding="utf-8")
    if given.markdown is not None:
        given.markdown.write_text(markdown(report), encoding="utf-8")
    else:
        sys.stdout.write(markdown(report))
    false, claims = report.false_claims()
    good = report.macro_accuracy() >= 0.70 and len(report.accuracies()) >= 10 and false <= 0.01 * max(1, claims)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
