"""What comes after a first attempt that went wrong by no fault of the plan: the suite of mishaps, counted apart."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import fmean

from bench.mishaps import MISHAPS
from bench.report.results import Results, solved
from bench.report.table import Table
from bench.report.value import Content, Count, Number, Points, PValue
from bench.statistics import mcnemar
from bench.suite import BETWEEN, MISHAP_SUITE
from bench.trial import SubGoal, Trial

ALL = "all"


def tables(results: Results) -> list[Table]:
    """Recovery by mishap and configuration, and `full` against `blind_retry` where a first attempt failed."""
    if not any(suite == MISHAP_SUITE for suite, _ in results.others):
        return []
    return [by_mishap(results), *after_failure(results)]


def recovered(results: Results, configuration: str = "full") -> Count:
    """Sub-goals whose first attempt failed in trials with a mishap, and those of them that a later one solved."""
    return _recovered(_goals(results.of_suite(configuration, MISHAP_SUITE)))


def by_mishap(results: Results) -> Table:
    """Every mishap under every configuration."""
    rows: list[tuple[Content, ...]] = []
    for mishap in (*MISHAPS, ALL):
        for configuration in results.configurations:
            trials = _with(results.of_suite(configuration, MISHAP_SUITE), mishap)
            if trials:
                rows.append((mishap, configuration, *_counts(trials)))
    return Table(
        "mishaps",
        "Recovery after mishaps",
        ("mishap", "configuration", "solved", "first attempts that failed", "recovered sub-goals", "attempts per success",
         "claimed, not solved", "damage events"),
        tuple(rows),
        "The twelve tasks again, at the tables' noise, each with something that the robot is not told of. slippery, heavy: half "
        "the friction, twice the mass, for the whole trial. nudged: the thing is moved by 3 to 6 cm between the look and the "
        "first grasp. arm_off: the hand goes 1.5 to 3.5 cm beside where it was sent, once. weak_grip: it closes with 15 to 40 % "
        "of the force, once. A sub-goal counts as in the table of attempts.",
    )  # fmt: skip


def after_failure(results: Results) -> list[Table]:
    """`full` against `blind_retry` on the trials with a mishap whose first attempt failed; they share that attempt."""
    rows: list[tuple[Content, ...]] = []
    other = {trial.pair: trial for trial in results.of_suite("blind_retry", MISHAP_SUITE)}
    own = [t for t in results.of_suite("full", MISHAP_SUITE) if t.first_failed and t.pair in other]
    for mishap in (*MISHAPS, ALL):
        pairs: dict[str, list[tuple[bool, bool]]] = {}
        for trial in _with(own, mishap):
            pairs.setdefault(trial.task, []).append((trial.success, other[trial.pair].success))
        if not pairs:
            continue
        both, test = [pair for found in pairs.values() for pair in found], mcnemar(pairs)
        rows.append((
            mishap, Count(sum(a for a, _ in both), len(both)), Count(sum(b for _, b in both), len(both)),
            Points(fmean(a - b for a, b in both)), test.only_first, test.only_second, PValue(test.p),
        ))  # fmt: skip
    if not rows:
        return []
    return [
        Table(
            "mishap_contrast",
            "After a mishap: structured recovery against blind retries",
            ("mishap", "full", "blind_retry", "difference [pp]", "only full", "only blind_retry", "p"),
            tuple(rows),
            "Trials with a mishap whose first attempt failed. Exact McNemar; exploratory, not adjusted.",
        )
    ]


def _with(trials: Sequence[Trial], mishap: str) -> list[Trial]:
    """The trials with that mishap, or all."""
    return [trial for trial in trials if mishap == ALL or trial.task.startswith(f"{mishap}{BETWEEN}")]


def _goals(trials: Sequence[Trial]) -> list[SubGoal]:
    return [goal for trial in trials for goal in trial.subgoals if goal.attempts]


def _recovered(goals: Sequence[SubGoal]) -> Count:
    return Count(sum(goal.recovered for goal in goals), sum(goal.first_failed for goal in goals))


def _counts(trials: Sequence[Trial]) -> tuple[Content, ...]:
    goals = _goals(trials)
    good = sum(goal.success for goal in goals)
    failed = Count(sum(goal.first_failed for goal in goals), len(goals))
    each = Number(sum(len(goal.attempts) for goal in goals) / good) if good else None
    claimed = sum(trial.claimed and not trial.success for trial in trials)
    return Count(*solved(trials)), failed, _recovered(goals), each, claimed, sum(t.damage_events for t in trials)
