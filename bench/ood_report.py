"""The table of single grasps in and outside the distribution, from the folders of benchmark runs.

    python -m bench.ood_report runs/ood_in runs/ood_near runs/ood_far
    python -m bench.ood_report DIR [DIR ...] --out table.md

Beside each number stands the ablation without retrieval on the same worlds, with Wilson intervals, the paired difference
and its exact test. Then every object, and how retrieval across categories fared (benchmark definition, section 6).
"""

from __future__ import annotations

import argparse
import sys
import zlib
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from bench.report.__main__ import together
from bench.report.results import solved
from bench.report.table import Table
from bench.report.value import Content, Count, Number, Points, PValue, Span
from bench.statistics import bootstrap_difference, mcnemar, wilson
from bench.trial import Trial
from kb.errors import BadInputError

ABLATION = "no_haarag"
GROUPS: tuple[tuple[str, str, str, float | None, str], ...] = (
    ("ood_in_dist", "full", "in distribution", 0.95, "84.4"),
    ("ood_near", "full", "near", 0.90, "–"),
    ("ood_far", "full_blind", "far, `blind`", 0.80, "54.4"),
    ("ood_far", "full", "far, `known`", None, "–"),
)
"""Suite, configuration, words, share that is wanted, and the paper's number (analytical, percent)."""
BOOTSTRAP_SEED = 20000
LIKE = 0.9
"""Affordance scores from here on are called a good fit."""

Group = tuple[str, list[Trial], list[Trial]]
"""Words, trials of the configuration, trials of the ablation."""


def groups(trials: Sequence[Trial]) -> list[Group]:
    """The rows of the table for which there are trials at noise 1.

    Raises:
        BadInputError: no trial is of the suite `ood`.
    """

    def own(suite: str, configuration: str) -> list[Trial]:
        return [t for t in trials if (t.suite, t.configuration, t.noise) == (suite, configuration, 1.0)]

    found = [(words, own(suite, name), own(suite, ABLATION)) for suite, name, words, _, _ in GROUPS]
    kept = [group for group in found if group[1]]
    if not kept:
        raise BadInputError("none of these trials is of `ragvlm bench --suite ood` with full or full_blind")
    return kept


def headline(found: Sequence[Group]) -> Table:
    """Success by group with the ablation beside it."""
    rows: list[tuple[Content, ...]] = []
    for words, mine, other in found:
        name, wanted, paper = next((c, w, p) for _, c, text, w, p in GROUPS if text == words)
        k, n = solved(mine)
        met = "–" if wanted is None else f"≥ {100 * wanted:.0f}: {'yes' if k >= wanted * n else '**no**'}"
        first = sum(all(goal.attempts and goal.attempts[0].success for goal in t.subgoals) for t in mine if t.subgoals)
        rows.append(
            (words, f"`{name}`", Count(k, n), _span(k, n), met, paper, Count(first, n), *_beside(words, mine, other))
        )
    return Table(
        "ood",
        "One object alone, picked up",
        (
            "objects", "configuration", "success", "95 % Wilson", "target, %", "paper, %", "first attempt",
            f"`{ABLATION}`", "95 % Wilson, ablation", "difference, points", "95 % bootstrap", "McNemar p",
        ),
        tuple(rows),
        "Success by the observer; a trial that ended in an error of the harness is a failure. The difference is over the "
        "trials that both have (trials drawn anew within each object).",
    )  # fmt: skip


def _beside(words: str, mine: Sequence[Trial], other: Sequence[Trial]) -> tuple[Content, ...]:
    """The ablation's success and interval, and the paired difference with its interval and test."""
    k, n = solved(other)
    pairs: dict[str, list[tuple[bool, bool]]] = {}
    theirs = {t.pair: t.success for t in other}
    for trial in mine:
        if trial.pair in theirs:
            pairs.setdefault(trial.task, []).append((trial.success, theirs[trial.pair]))
    if not pairs:
        return "not run", None, None, None, None
    gap = bootstrap_difference(pairs, np.random.default_rng((BOOTSTRAP_SEED, zlib.crc32(words.encode()))))
    return Count(k, n), _span(k, n), Points(gap.value), Span(gap.low, gap.high, signed=True), PValue(mcnemar(pairs).p)


def _span(k: int, n: int) -> Span:
    interval = wilson(k, n)
    return Span(interval.low, interval.high)


def per_object(found: Sequence[Group]) -> Table:
    """Every object: successes with retrieval and without."""
    rows: list[tuple[Content, ...]] = []
    for words, mine, other in found:
        for task in sorted({t.task for t in mine}):
            pair = (Count(*solved([t for t in arm if t.task == task])) for arm in (mine, other))
            rows.append((words, task.removeprefix("ood_"), *pair))
    return Table("ood_objects", "Every object", ("objects", "object", "success", f"`{ABLATION}`"), tuple(rows))


def fallback(found: Sequence[Group]) -> Table:
    """How often no category fitted, and success by how well the best experience fitted."""
    cases: tuple[tuple[str, Callable[[Trial], bool]], ...] = (
        ("no category fits, all entries admitted", lambda t: t.fallback is True),
        ("a category fits", lambda t: t.fallback is False),
        ("nothing retrieved (not seen, or ended before)", lambda t: t.fallback is None),
        (f"best experience s_aff ≥ {LIKE:g}", lambda t: t.s_aff is not None and t.s_aff >= LIKE),
        (f"best experience s_aff < {LIKE:g}", lambda t: t.s_aff is not None and t.s_aff < LIKE),
    )
    rows: list[tuple[Content, ...]] = []
    for words, mine, _ in found:
        for case, of in cases:
            trials = [t for t in mine if of(t)]
            scores = [t.s_aff for t in trials if t.s_aff is not None]
            mean = Number(float(np.mean(scores))) if scores else None
            rows.append((words, case, Count(len(trials), len(mine)), Count(*solved(trials)), mean))
    return Table(
        "ood_fallback",
        "Retrieval across categories",
        ("objects", "case", "trials", "success", "mean s_aff of the best experience"),
        tuple(rows),
    )


def report(trials: Sequence[Trial]) -> str:
    """All three tables as Markdown.

    Raises:
        BadInputError: no trial is of the suite `ood`.
    """
    found = groups(trials)
    return "\n".join(table.markdown() for table in (headline(found), per_object(found), fallback(found)))


def main(arguments: Sequence[str] | None = None) -> int:
    """Entry point of `python -m bench.ood_report`."""
    parser = argparse.ArgumentParser(prog="python -m bench.ood_report", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", type=Path, nargs="+", help="folder with trials.jsonl; several are put together")
    parser.add_argument("--out", type=Path, help="write the tables there as well")
    given = parser.parse_args(arguments)
    try:
        text = report(together(given.folder))
        if given.out is not None:
            given.out.write_text(text, encoding="utf-8")
    except (BadInputError, OSError) as error:
        parser.error(str(error))
    sys.stdout.write(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
