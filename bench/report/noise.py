"""Success against noise: perception, calibration, friction and mass uncertainty scaled together."""

from __future__ import annotations

from bench.report.results import Results, solved
from bench.report.table import Table
from bench.report.value import Content, Count, Number, Span
from bench.statistics import Interval, wilson
from bench.trial import Trial

Curve = dict[float, tuple[Count, Interval]]
"""Noise level -> successes and their Wilson interval."""


def curves(results: Results) -> dict[str, Curve]:
    """The curves of the configurations that ran at every noise level, over the worlds that all of them saw at all levels.

    Points of other worlds or other tasks would compare the easy with the hard.
    """
    levels = results.noises
    if len(levels) < 2:
        return {}
    own = {name: [results.of(name, noise=level) for level in levels] for name in results.configurations}
    names = [name for name, trials in own.items() if all(trials)]
    seen = [{_world(trial) for trial in trials} for name in names for trials in own[name]]
    shared = set.intersection(*seen) if seen else set()
    if not shared:
        return {}
    return {
        name: {
            level: _point([trial for trial in trials if _world(trial) in shared])
            for level, trials in zip(levels, own[name], strict=True)
        }
        for name in names
    }


def _world(trial: Trial) -> tuple[str, int, int]:
    return trial.task, trial.repetition, trial.trial


def _point(trials: list[Trial]) -> tuple[Count, Interval]:
    k, n = solved(trials)
    return Count(k, n), wilson(k, n)


def tables(results: Results) -> list[Table]:
    """One row per configuration and noise level, where there are several levels."""
    found = curves(results)
    if not found:
        return []
    rows: list[tuple[Content, ...]] = [
        (name, Number(level, 1), count, Span(interval.low, interval.high))
        for name, points in found.items()
        for level, (count, interval) in points.items()
    ]
    return [
        Table(
            "noise",
            "Success against noise",
            ("configuration", "noise", "success", "95 % Wilson"),
            tuple(rows),
            "Noise 1 is the benchmark's; the factor scales the uncertainty of depth, calibration, friction and mass "
            f"together. The same worlds at every point, and only those: {next(iter(next(iter(found.values())).values()))[0].n} "
            f"trials each. All other tables are at noise {results.noise:g}.",
        )
    ]
