"""Measures of one ranking and their means over queries with bootstrap intervals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Rows = NDArray[np.intp]

RESAMPLES = 2000


@dataclass(frozen=True)
class Mean:
    """A mean over queries and its 95 % bootstrap intervals."""

    value: float
    low: float
    high: float
    low_by_object: float
    high_by_object: float
    """Objects are drawn again instead of queries: five views of one object are no five objects."""


def precision(order: Rows, relevant: NDArray[np.bool_], k: int) -> float:
    """P@k: share of the first k that are relevant."""
    return float(relevant[order[:k]].mean()) if len(order) else 0.0


def reciprocal_rank(order: Rows, relevant: NDArray[np.bool_]) -> float:
    """1 over the place of the first relevant entry in the full ranking; 0 if none is relevant."""
    places = np.flatnonzero(relevant[order])
    return 0.0 if len(places) == 0 else 1.0 / (1.0 + float(places[0]))


def ndcg(order: Rows, gain: Array, k: int = 10) -> float:
    """Normalised discounted cumulative gain of the first k (Järvelin and Kekäläinen 2002); 0 if nothing gains."""
    discount = 1.0 / np.log2(np.arange(2, k + 2))
    got = gain[order[:k]]
    best = np.sort(gain)[::-1][:k]
    ideal = float((best * discount[: len(best)]).sum())
    return 0.0 if ideal == 0.0 else float((got * discount[: len(got)]).sum()) / ideal


def means(
    values: Mapping[str, Sequence[float]], objects: Sequence[str], rng: np.random.Generator, resamples: int = RESAMPLES
) -> dict[str, Mean]:
    """Mean of every measure over the queries, with percentile intervals over queries and over objects.

    Args:
        values: Measure -> one value per query; NaN where it was not measured.
        objects: The object of every query.
        rng: Draws the resamples.
        resamples: How many.
    """
    count = len(objects)
    names = sorted(set(objects))
    members = [np.flatnonzero(np.array(objects) == name) for name in names]
    picks = [rng.integers(0, count, count) for _ in range(resamples)]
    clusters = [np.concatenate([members[i] for i in rng.integers(0, len(names), len(names))]) for _ in range(resamples)]
    found: dict[str, Mean] = {}
    for name, column in values.items():
        array = np.array(column, np.float64)
        low, high = _interval(array, picks)
        low_by_object, high_by_object = _interval(array, clusters)
        found[name] = Mean(float(array.mean()), low, high, low_by_object, high_by_object)
    return found


def _interval(values: Array, picks: Sequence[NDArray[np.integer]]) -> tuple[float, float]:
    drawn = np.array([values[pick].mean() for pick in picks])
    if np.isnan(drawn).any():
        return float("nan"), float("nan")
    low, high = np.quantile(drawn, (0.025, 0.975))
    return float(low), float(high)
