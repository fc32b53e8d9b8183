"""How often each configuration succeeded: by category, by task, over repetitions, and outside the twelve tasks."""

from __future__ import annotations

from collections.abc import Sequence

from agent.configuration import CONFIGURATIONS
from bench.report.results import CATEGORIES, Results, solved
from bench.report.table import Table
from bench.report.value import Content, Count, MeanSd, Share, Span
from bench.statistics import Repeated, macro, over_repetitions, trial_weighted, wilson
from bench.suite import MISHAP_SUITE
from bench.trial import Trial


def tables(results: Results) -> list[Table]:
    """Headline, all cells, repetitions, other suites, and what the rows are."""
    found = [headline(results), per_task(results), repetitions(results)]
    return found + ([table] if (table := other_suites(results)).rows else []) + [legend(results)]


def legend(results: Results) -> Table:
    """What each configuration is, in the words of its definition; names of other versions stand alone."""
    known = [(name, CONFIGURATIONS.get(name)) for name in results.configurations]
    return Table(
        "configurations",
        "What the configurations are",
        ("configuration", "is"),
        tuple((name, row.says if row else None) for name, row in known),
        "Perception (but oracle_perception's) and kinematics are shared by all; candidate generator and recovery ladder by all "
        "but vlm_only and paper_literal (no_recovery has no ladder); clearance scoring by all that have the scene graph but "
        f"paper_literal.{_brain(results)}",
        frozenset({"full"}),
    )


def _brain(results: Results) -> str:
    """A reader of vlm_only must know whether there was a model."""
    rules = all(t.brain == "rules" for t in results.all)
    return " No vision-language model took part in this run." if rules else ""


def headline(results: Results) -> Table:
    """Success by category and overall, counts first, with Wilson intervals."""
    rows: list[tuple[Content, ...]] = []
    for configuration in results.configurations:
        trials = results.of(configuration)
        if not trials:
            continue
        by_category = [Count(*solved(results.of(configuration, CATEGORIES[name]))) for name in results.categories]
        per_task = [solved(results.of(configuration, [task])) for task in results.twelve]
        k, n = solved(trials)
        interval = wilson(k, n)
        rows.append(
            (
                configuration,
                *by_category,
                Count(k, n),
                Span(interval.low, interval.high),
                Share(macro(per_task or [(k, n)])),
                sum(t.harness_error is not None for t in trials),
            )
        )
    return Table(
        "success",
        "Success by configuration",
        ("configuration", *results.categories, "all", "95 % Wilson", "macro mean", "harness errors"),
        tuple(rows),
        "Counts of trials (share). “All” weighs every trial the same, the macro mean every task. A trial that ended in "
        "a harness error counts as a failure and is listed apart.",
        frozenset({"full"}),
    )


def per_task(results: Results) -> Table:
    """Every cell of task by configuration."""
    rows = [
        (task, *(Count(*solved(results.of(configuration, [task]))) for configuration in results.configurations))
        for task in results.twelve
    ]
    return Table(
        "per_task",
        "Every task under every configuration",
        ("task", *results.configurations),
        tuple(rows),
        "Successes of trials. The shade is the success rate.",
        shaded=True,
    )


def share_per_repetition(trials: Sequence[Trial]) -> list[float]:
    """Trial-weighted success of each repetition."""
    numbers = sorted({t.repetition for t in trials})
    return [trial_weighted([solved([t for t in trials if t.repetition == number])]) for number in numbers]


def over(trials: Sequence[Trial]) -> Repeated | None:
    """Success over repetitions; None without trials."""
    shares = share_per_repetition(trials)
    return over_repetitions(shares) if shares else None


def repetitions(results: Results) -> Table:
    """Mean and SD over repetitions with t-intervals, in the paper's style."""
    rows: list[tuple[Content, ...]] = []
    for configuration in results.configurations:
        row: list[Content] = [configuration]
        whole = over(results.of(configuration))
        if whole is None:
            continue
        for name in results.categories:
            found = over(results.of(configuration, CATEGORIES[name]))
            row.append(MeanSd(found.mean, found.sd) if found else None)
        row.append(MeanSd(whole.mean, whole.sd))
        row.append(Span(whole.low, whole.high) if whole.low is not None and whole.high is not None else None)
        row.append(whole.count)
        rows.append(tuple(row))
    return Table(
        "repetitions",
        "Mean ± SD over repetitions [%]",
        ("configuration", *results.categories, "all", "95 % t-interval", "repetitions"),
        tuple(rows),
        "Each repetition draws new worlds. The t-interval is that of the mean; a single repetition has none.",
        frozenset({"full"}),
    )


def other_suites(results: Results) -> Table:
    """Tasks outside the twelve: never part of their mean. Configurations that ran none of them have no column.

    Mishaps have a table of their own.
    """
    suites = dict.fromkeys(suite for suite, _ in results.others if suite != MISHAP_SUITE)
    names = [
        name for name in results.configurations if any(solved(results.of_suite(name, own, None))[1] for own in suites)
    ]
    rows: list[tuple[Content, ...]] = []
    for suite in suites:
        tasks = [task for own, task in results.others if own == suite]
        for task in tasks:
            rows.append((suite, task, *_counts(results, names, suite, task)))
        if len(tasks) > 1:
            rows.append((suite, "all", *_counts(results, names, suite, None)))
    return Table(
        "other_suites",
        "Supplementary tasks and clutter",
        ("suite", "task", *names),
        tuple(rows),
        "Outside the twelve tasks and never part of their mean.",
        shaded=True,
    )


def _counts(results: Results, names: Sequence[str], suite: str, task: str | None) -> list[Content]:
    return [Count(*solved(results.of_suite(name, suite, task))) for name in names]
