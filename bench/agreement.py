"""Agreement of the two evaluators: does the analytical model say what the physics shows?

    python -m bench.agreement RUN_IN_PHYSICS RUN_IN_THE_ANALYTICAL_MODEL [--markdown FILE]

Both runs hold the same trials (tasks, configurations, seeds). Agreement is that of their outcomes; the AUC asks whether
the predicted quality Q ranks the attempts that succeed physically above those that fail.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.report.table import Table
from bench.report.value import Content, Count, Number
from bench.trial import Trial, read_trials
from kb.errors import BadInputError


@dataclass(frozen=True)
class Agreement:
    """A two-by-two table of outcomes."""

    both: int
    only_first: int
    only_second: int
    neither: int

    @property
    def count(self) -> int:
        """Paired outcomes."""
        return self.both + self.only_first + self.only_second + self.neither

    @property
    def accuracy(self) -> float | None:
        """Share of equal outcomes."""
        return (self.both + self.neither) / self.count if self.count else None

    @property
    def kappa(self) -> float | None:
        """Cohen's kappa; None where chance alone would agree always (both evaluators say the same of every trial)."""
        if not self.count:
            return None
        first = (self.both + self.only_first) / self.count
        second = (self.both + self.only_second) / self.count
        chance = first * second + (1 - first) * (1 - second)
        if chance >= 1.0:
            return None
        return ((self.both + self.neither) / self.count - chance) / (1 - chance)


def agreement(outcomes: Iterable[tuple[bool, bool]]) -> Agreement:
    """The table of paired outcomes."""
    pairs = list(outcomes)
    return Agreement(
        pairs.count((True, True)), pairs.count((True, False)), pairs.count((False, True)), pairs.count((False, False))
    )


def auc(scores: Sequence[float], outcomes: Sequence[bool]) -> float | None:
    """Area under the ROC curve: the chance that a success has the higher score, ties counting half.

    Returns:
        None where all outcomes are the same.
    """
    values, good = np.asarray(scores, float), np.asarray(outcomes, bool)
    positives, negatives = int(good.sum()), int((~good).sum())
    if not positives or not negatives:
        return None
    _, place, times = np.unique(values, return_inverse=True, return_counts=True)
    ranks = (np.cumsum(times) - (times - 1) / 2)[place]  # mid-ranks, 1-based
    return float((ranks[good].sum() - positives * (positives + 1) / 2) / (positives * negatives))


def q_auc(trials: Iterable[Trial]) -> tuple[float | None, int]:
    """AUC of the predicted Q against the outcome of each attempt, and the number of attempts."""
    rated = [(a.q, a.success) for t in trials for goal in t.subgoals for a in goal.attempts if a.q is not None]
    return auc([q for q, _ in rated], [good for _, good in rated]), len(rated)


def paired(first: Iterable[Trial], second: Iterable[Trial]) -> list[tuple[Trial, Trial]]:
    """The trials that both runs hold."""
    other = {t.key: t for t in second}
    return [(t, other[t.key]) for t in first if t.key in other]


def table(physics: Sequence[Trial], analytic: Sequence[Trial]) -> Table:
    """Agreement per configuration and over all.

    Raises:
        BadInputError: the runs share no trial.
    """
    pairs = paired(physics, analytic)
    if not pairs:
        raise BadInputError("the two runs share no trial (task, configuration, repetition, trial, noise)")
    rows = [_row("all", pairs)]
    for name in dict.fromkeys(t.configuration for t, _ in pairs):
        rows.append(_row(name, [pair for pair in pairs if pair[0].configuration == name]))
    return Table(
        "agreement",
        "Agreement of the two evaluators",
        ("configuration", "success in physics", "success in the model", "both", "only physics", "only model", "neither",
         "accuracy", "Cohen κ", "AUC of Q", "attempts"),
        tuple(rows),
        "Outcomes of the same trials. κ is agreement beyond chance (0: none). AUC of Q: chance that an attempt that "
        "succeeds in physics was predicted a higher quality than one that fails (0.5: Q says nothing); none where all attempts "
        f"ended alike. Perception: {_perceptions(a for a, _ in pairs)} in physics, {_perceptions(b for _, b in pairs)} in "
        "the model.",
        frozenset({"all"}),
    )  # fmt: skip


def _perceptions(trials: Iterable[Trial]) -> str:
    return " and ".join(sorted({t.perception for t in trials}))


def _row(name: str, pairs: Sequence[tuple[Trial, Trial]]) -> tuple[Content, ...]:
    found = agreement((a.success, b.success) for a, b in pairs)
    area, rated = q_auc(a for a, _ in pairs)
    n = found.count
    return (
        name, Count(found.both + found.only_first, n), Count(found.both + found.only_second, n), found.both,
        found.only_first, found.only_second, found.neither, _number(found.accuracy), _number(found.kappa), _number(area),
        rated,
    )  # fmt: skip


def _number(value: float | None) -> Number | None:
    return None if value is None else Number(value, 3)


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line: compares two run folders."""
    parser = argparse.ArgumentParser(prog="python -m bench.agreement", description="Agreement of the two evaluators.")
    parser.add_argument("physics", type=Path, help="folder of a run with --evaluator mujoco")
    parser.add_argument("analytic", type=Path, help="folder of a run with --evaluator analytic")
    parser.add_argument("--markdown", type=Path, help="write the table there (default: standard output)")
    given = parser.parse_args(arguments)
    try:
        found = table(read_trials(given.physics / "trials.jsonl"), read_trials(given.analytic / "trials.jsonl"))
    except BadInputError as error:
        parser.error(str(error))
    if given.markdown is not None:
        given.markdown.write_text(found.markdown(), encoding="utf-8")
    else:
        sys.stdout.write(found.markdown())
    return 0


if __name__ == "__main__":
    sys.exit(main())
