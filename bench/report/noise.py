"""Success against noise: perception, calibration, friction and mass uncertainty scaled together."""

from __future__ import annotations

from bench.report.results import Results, solved
from bench.report.table import Table
from bench.report.value import Content, Count, Number, Span
from bench.statistics import Interval, wilson


def curve(results: Results, configuration: str) -> dict[float, tuple[Count, Interval]]:
    """Noise level -> successes and their Wilson interval."""
    found: dict[float, tuple[Count, Interval]] = {}
    for level in results.noises:
        k, n = solved(results.of(configuration, noise=level))
        if n:
            found[level] = Count(k, n), wilson(k, n)
    return found


def tables(results: Results) -> list[Table]:
    """One row per configuration and noise level, where there are several levels."""
    if len(results.noises) < 2:
        return []
    rows: list[tuple[Content, ...]] = []
    for configuration in results.configurations:
        points = curve(results, configuration)
        if len(points) > 1:
            for level, (count, interval) in points.items():
                rows.append((configuration, Number(level, 1), count, Span(interval.low, interval.high)))
    return [
        Table(
            "noise",
            "Success against noise",
            ("configuration", "noise", "success", "95 % Wilson"),
            tuple(rows),
            "Noise 1 is the benchmark's; the factor scales the uncertainty of depth, calibration, friction and mass "
            f"together. All other tables are at noise {results.noise:g}.",
        )
    ]
