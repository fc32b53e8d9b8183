"""What the retries achieve: attempts per sub-goal, recovery as a count pair, efficacy of each correction."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from statistics import fmean

from bench.report.results import Results
from bench.report.table import Table
from bench.report.value import Content, Count, Number
from bench.trial import SubGoal, Trial
from kb.vocabulary import FAILURE_TYPES

MAX_ATTEMPTS = 4
"""One attempt and three retries per sub-goal (ledger G19)."""
ENDS = ("first try", "retry 1", "retry 2", "retry 3", "not solved", "never attempted")
"""How a sub-goal may end."""


def subgoals(trials: Sequence[Trial]) -> list[SubGoal]:
    """The sub-goals of all trials."""
    return [goal for trial in trials for goal in trial.subgoals]


def endings(trials: Sequence[Trial]) -> Counter[str]:
    """How many sub-goals ended in which way."""
    return Counter(ending(goal) for goal in subgoals(trials))


def ending(goal: SubGoal) -> str:
    """One of `ENDS`."""
    if not goal.attempts:
        return "never attempted"
    if not goal.success:
        return "not solved"
    return ENDS[min(len(goal.attempts), MAX_ATTEMPTS) - 1]


def tables(results: Results) -> list[Table]:
    """Attempts, recovery, endings, corrections."""
    return [attempts(results), ladder(results), *efficacies(results), *by_noise(results)]


def attempts(results: Results) -> Table:
    """Attempts per sub-goal three ways, and recovery as counts."""
    rows: list[tuple[Content, ...]] = []
    for configuration in results.configurations:
        trials = results.of(configuration)
        goals = [goal for goal in subgoals(trials) if goal.attempts]
        if not goals:
            continue
        recovered = [goal for goal in goals if goal.recovered]
        solved = [goal for goal in goals if goal.success]
        failed_first = [t for t in trials if t.first_failed]
        total = sum(len(goal.attempts) for goal in goals)
        rows.append(
            (
                configuration,
                Count(sum(goal.attempts[0].success for goal in goals), len(goals)),
                _mean([len(goal.attempts) for goal in goals]),
                _mean([len(goal.attempts) for goal in recovered]),
                Number(total / len(solved)) if solved else None,
                Count(len(recovered), sum(goal.first_failed for goal in goals)),
                Count(sum(t.success for t in failed_first), len(failed_first)),
            )
        )
    return Table(
        "attempts",
        "Attempts and recovery",
        ("configuration", "first attempt", "attempts per sub-goal", "… per recovered", "… per success",
         "recovered sub-goals", "recovered trials"),
        tuple(rows),
        "A sub-goal is one object to grasp and perhaps to put somewhere. Per success: all attempts over solved sub-goals. "
        "Recovered: solved after a failed first attempt, of all whose first attempt failed; a trial also counts where "
        "one of its sub-goals failed at first and the whole trial succeeded. First attempt: that grasp held; a solved "
        "sub-goal has also ended up where it was to be put, so fewer may be solved than were held.",
        frozenset({"full"}),
    )  # fmt: skip


def _mean(values: Sequence[int]) -> Number | None:
    return Number(fmean(values)) if values else None


def ladder(results: Results) -> Table:
    """With which attempt the sub-goals were solved."""
    rows: list[tuple[Content, ...]] = []
    for configuration in results.configurations:
        found = endings(results.of(configuration))
        if total := sum(found.values()):
            rows.append((configuration, *(Count(found[name], total) for name in ENDS)))
    return Table(
        "ladder",
        "With which attempt sub-goals were solved",
        ("configuration", *ENDS),
        tuple(rows),
        "Retry 1 tunes parameters, retry 2 switches the grasp type, retry 3 plans anew.",
        frozenset({"full"}),
    )


def by_noise(results: Results) -> list[Table]:
    """Recovery at every noise, where there are several: at little noise hardly a first attempt fails."""
    rows: list[tuple[Content, ...]] = []
    for configuration in results.configurations:
        for level in results.noises if len(results.noises) > 1 else ():
            goals = [goal for goal in subgoals(results.of(configuration, noise=level)) if goal.attempts]
            failed = [goal for goal in goals if goal.first_failed]
            if not failed:
                continue
            spent, good = sum(len(goal.attempts) for goal in goals), sum(goal.success for goal in goals)
            recovered = Count(sum(goal.recovered for goal in failed), len(failed))
            rows.append(
                (configuration, Number(level, 1), len(goals), recovered, Number(spent / good) if good else None)
            )
    if not rows:
        return []
    return [
        Table(
            "recovery_by_noise",
            "Recovery at every noise",
            ("configuration", "noise", "sub-goals", "recovered of first failures", "attempts per success"),
            tuple(rows),
            "All trials at that noise, which need not be the same tasks at each: only rows of one noise whose sub-goals "
            "are as many can be compared.",
        )
    ]


def correction_counts(trials: Sequence[Trial]) -> dict[tuple[str, int], Count]:
    """(Failure type, level) of a correction -> successes of the attempt that it led to."""
    tried: Counter[tuple[str, int]] = Counter()
    good: Counter[tuple[str, int]] = Counter()
    for goal in subgoals(trials):
        for attempt in goal.attempts:
            if attempt.corrected is not None:
                tried[attempt.corrected] += 1
                good[attempt.corrected] += attempt.success
    return {name: Count(good[name], tried[name]) for name in sorted(tried)}


def efficacies(results: Results) -> list[Table]:
    """Success of the next attempt by diagnosed type and level, for `full`, or the first configuration that corrected.

    Where that one corrected seldom, the same at every noise, with mishaps, and of all configurations, says more.
    """
    samples = results.telling(lambda trials: bool(correction_counts(trials)))
    return [_efficacy(sample.suffix, sample.words, correction_counts(sample.trials)) for sample in samples]


def _efficacy(suffix: str, words: str, counts: dict[tuple[str, int], Count]) -> Table:
    kinds = [name for name in FAILURE_TYPES if any(name == kind for kind, _ in counts)]
    rows = [(kind, *(counts.get((kind, level)) for level in (1, 2, 3)), _total(counts, kind)) for kind in kinds]
    rows.append(("all", *(_total(counts, None, level) for level in (1, 2, 3)), _total(counts, None)))
    return Table(
        f"efficacy{suffix}",
        f"Did the correction help? ({words})",
        ("diagnosed", "level 1", "level 2", "level 3", "all levels"),
        tuple(rows),
        "Successes of the very next attempt, by what the robot diagnosed and the level of its correction.",
        shaded=True,
    )


def _total(counts: dict[tuple[str, int], Count], kind: str | None, level: int | None = None) -> Count | None:
    own = [c for (k, rung), c in counts.items() if kind in (None, k) and level in (None, rung)]
    return Count(sum(c.k for c in own), sum(c.n for c in own)) if own else None
