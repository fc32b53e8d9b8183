"""The statistics of the benchmark: intervals, paired differences, exact tests (benchmark definition, section 4).

Everything is deterministic: what resamples takes a generator. scipy is loaded only where a quantile of Student's t is
needed; nothing here is on the path of a trial.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import NormalDist, fmean, stdev

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

CONFIDENCE = 0.95
"""Level of every interval in the report."""
POWER = 0.80
"""Power at which the minimum detectable difference is stated."""
RESAMPLES = 10_000
"""Bootstrap resamples: the 2.5 % point then has a standard error below 1 % of the interval's width."""


@dataclass(frozen=True)
class Interval:
    """An estimate with its confidence interval."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class Repeated:
    """A quantity measured in several repetitions."""

    mean: float
    sd: float | None
    """Sample standard deviation (n - 1); None for a single repetition."""
    low: float | None
    high: float | None
    """t-interval of the mean; None for a single repetition."""
    count: int


@dataclass(frozen=True)
class McNemar:
    """Exact McNemar test of two paired binary outcomes."""

    only_first: int
    """Pairs that only the first one solved."""
    only_second: int
    p: float


def normal_quantile(probability: float) -> float:
    """Quantile of the standard normal distribution."""
    return NormalDist().inv_cdf(probability)


def wilson(successes: int, count: int, confidence: float = CONFIDENCE) -> Interval:
    """Wilson's score interval of a proportion; (0, 1) around 0 where nothing was counted.

    Raises:
        ValueError: not 0 <= successes <= count.
    """
    if not 0 <= successes <= count:
        raise ValueError(f"{successes} of {count} is no share")
    if count == 0:
        return Interval(0.0, 0.0, 1.0)
    z2 = normal_quantile(0.5 + confidence / 2) ** 2
    share = successes / count
    middle = (share + z2 / (2 * count)) / (1 + z2 / count)
    half = math.sqrt(z2 * (share * (1 - share) / count + z2 / (4 * count**2))) / (1 + z2 / count)
    # At the ends the score interval touches 0 and 1 exactly; rounding must not move it inside.
    low = 0.0 if successes == 0 else max(0.0, middle - half)
    high = 1.0 if successes == count else min(1.0, middle + half)
    return Interval(share, low, high)


def over_repetitions(values: Sequence[float], confidence: float = CONFIDENCE) -> Repeated:
    """Mean, sample SD and t-interval over repetitions (the paper's style: 78.7 +- 1.8, t_4).

    Raises:
        ValueError: no value.
    """
    if not values:
        raise ValueError("no repetition to average over")
    mean = fmean(values)
    if len(values) == 1:
        return Repeated(mean, None, None, None, 1)
    from scipy.special import stdtrit

    spread = stdev(values)
    half = float(stdtrit(len(values) - 1, 0.5 + confidence / 2)) * spread / math.sqrt(len(values))
    return Repeated(mean, spread, mean - half, mean + half, len(values))


def trial_weighted(counts: Sequence[tuple[int, int]]) -> float:
    """Share of all trials that succeeded; each task weighs as many trials as it has (the paper's overall)."""
    total = sum(n for _, n in counts)
    return sum(k for k, _ in counts) / total if total else 0.0


def macro(counts: Sequence[tuple[int, int]]) -> float:
    """Mean of the groups' shares; each group weighs the same. Groups without a trial are left out."""
    shares = [k / n for k, n in counts if n]
    return fmean(shares) if shares else 0.0


Pairs = Mapping[str, Sequence[tuple[bool, bool]]]
"""Task -> outcomes of (first, second) on the same trials."""


def risk_difference(pairs: Pairs) -> float:
    """Success of the first minus success of the second, over all paired trials."""
    outcomes = [pair for task in pairs.values() for pair in task]
    return fmean(int(a) - int(b) for a, b in outcomes) if outcomes else 0.0


def bootstrap_difference(
    pairs: Pairs,
    rng: np.random.Generator,
    *,
    resample_tasks: bool = False,
    resamples: int = RESAMPLES,
    confidence: float = CONFIDENCE,
) -> Interval:
    """Paired risk difference with a percentile interval of a stratified bootstrap.

    Trials are drawn anew within each task; with `resample_tasks` the tasks are drawn first, which asks what another
    choice of tasks would have shown. A task's pairs take only the values -1, 0 and 1, so a redraw of its trials is a
    multinomial draw of their counts.

    Args:
        pairs: Outcomes per task. Their order does not matter.
        rng: Source of the resamples.
        resample_tasks: Draw tasks with replacement as well.
        resamples: Number of resamples.
        confidence: Level of the interval.
    """
    tables = [_signs(pairs[name]) for name in sorted(pairs) if pairs[name]]
    if not tables:
        return Interval(0.0, 0.0, 0.0)
    sizes = np.array([table.sum() for table in tables])
    if resample_tasks:
        sums, counts = _with_tasks_redrawn(tables, sizes, rng, resamples)
    else:
        drawn = [rng.multinomial(n, table / n, resamples) for table, n in zip(tables, sizes, strict=True)]
        sums = np.sum([draw[:, 2] - draw[:, 0] for draw in drawn], axis=0)
        counts = np.full(resamples, sizes.sum())
    tail = (1 - confidence) / 2
    low, high = np.quantile(sums / counts, [tail, 1 - tail])
    return Interval(risk_difference(pairs), float(low), float(high))


def _signs(outcomes: Sequence[tuple[bool, bool]]) -> NDArray[np.int64]:
    """How often the first was worse, equal, better; shape (3,)."""
    return np.bincount([1 + int(a) - int(b) for a, b in outcomes], minlength=3)


def _with_tasks_redrawn(
    tables: Sequence[NDArray[np.int64]], sizes: NDArray[np.int64], rng: np.random.Generator, resamples: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Sums of differences and numbers of trials, (resamples,) each, when tasks are drawn and then their trials."""
    times = rng.multinomial(len(tables), np.full(len(tables), 1 / len(tables)), resamples)  # (resamples, tasks)
    sums = np.zeros(resamples, np.int64)
    for column, (table, n) in enumerate(zip(tables, sizes, strict=True)):
        draw = rng.multinomial(n * times[:, column], table / n)
        sums += draw[:, 2] - draw[:, 0]
    return sums, times @ sizes


def mcnemar(pairs: Pairs) -> McNemar:
    """Exact two-sided McNemar test: the discordant pairs against a fair coin."""
    first = sum(a and not b for task in pairs.values() for a, b in task)
    second = sum(b and not a for task in pairs.values() for a, b in task)
    return McNemar(first, second, binomial_two_sided(first, first + second))


def binomial_two_sided(successes: int, count: int) -> float:
    """Exact two-sided p of a fair coin, in integer arithmetic; 1 where nothing was thrown."""
    fewer = min(successes, count - successes)
    tail = sum(math.comb(count, k) for k in range(fewer + 1))
    return min(1.0, 2 * tail / 2**count)


def holm(p_values: Mapping[str, float], family: int | None = None) -> dict[str, float]:
    """Holm's step-down adjustment.

    Args:
        p_values: Raw p per contrast.
        family: Size of the family that was registered; contrasts that were not run count as p = 1, which makes the
            others' adjustment stricter, never milder.

    Raises:
        ValueError: more contrasts than the family holds.
    """
    size = len(p_values) if family is None else family
    if size < len(p_values):
        raise ValueError(f"{len(p_values)} contrasts in a family of {size}")
    adjusted: dict[str, float] = {}
    largest = 0.0
    for rank, name in enumerate(sorted(p_values, key=lambda name: (p_values[name], name))):
        largest = max(largest, min(1.0, (size - rank) * p_values[name]))
        adjusted[name] = largest
    return {name: adjusted[name] for name in p_values}


def minimum_detectable_difference(
    count: int, discordance: float, *, power: float = POWER, alpha: float = 1 - CONFIDENCE
) -> float:
    """Smallest paired difference that `count` pairs show with the given power (Connor's approximation for McNemar).

    Solves z_(1-alpha/2) sqrt(psi) + z_power sqrt(psi - d^2) = d sqrt(n) for d.

    Args:
        count: Number of pairs n.
        discordance: Share psi of pairs whose outcomes differ.
        power: Wanted power.
        alpha: Two-sided level of the test.

    Returns:
        The difference as a share; 1.0 where `count` pairs cannot show any difference at this discordance.

    Raises:
        ValueError: the discordance is not in (0, 1].
    """
    if not 0.0 < discordance <= 1.0:
        raise ValueError(f"a discordance of {discordance} is not in (0, 1]")
    z_alpha, z_power = normal_quantile(1 - alpha / 2), normal_quantile(power)

    def shown(difference: float) -> bool:
        spread = math.sqrt(max(discordance - difference**2, 0.0))
        return difference * math.sqrt(count) >= z_alpha * math.sqrt(discordance) + z_power * spread

    if not shown(discordance):
        return 1.0
    low, high = 0.0, discordance
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (low, middle) if shown(middle) else (middle, high)
    return high
