"""Laws of the statistics, over drawn counts and outcomes."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from bench.agreement import agreement, auc
from bench.statistics import (
    bootstrap_difference,
    holm,
    mcnemar,
    minimum_detectable_difference,
    over_repetitions,
    risk_difference,
    wilson,
)

fewer = settings(max_examples=80, deadline=None)
shares = st.integers(1, 400).flatmap(lambda n: st.tuples(st.integers(0, n), st.just(n)))
outcomes = st.lists(st.tuples(st.booleans(), st.booleans()), min_size=1, max_size=40)
tables = st.dictionaries(st.sampled_from("abcdef"), outcomes, min_size=1)
p_values = st.dictionaries(st.text("abcdefgh", min_size=1, max_size=3), st.floats(0, 1), min_size=1, max_size=8)


@fewer
@given(shares)
def test_wilson_holds_the_share_inside_zero_and_one(share: tuple[int, int]) -> None:
    """0 <= low <= k/n <= high <= 1."""
    found = wilson(*share)
    assert 0.0 <= found.low <= found.value <= found.high <= 1.0


@fewer
@given(shares)
def test_wilson_is_symmetric(share: tuple[int, int]) -> None:
    """The interval of the failures is the mirrored interval of the successes."""
    k, n = share
    good, bad = wilson(k, n), wilson(n - k, n)
    assert abs(good.low - (1 - bad.high)) < 1e-12
    assert abs(good.high - (1 - bad.low)) < 1e-12


@fewer
@given(shares)
def test_more_trials_narrow_the_interval(share: tuple[int, int]) -> None:
    """Four times the trials at the same share: a narrower interval."""
    k, n = share
    few, many = wilson(k, n), wilson(4 * k, 4 * n)
    assert many.high - many.low < few.high - few.low


@fewer
@given(st.lists(st.floats(0, 1), min_size=2, max_size=8), st.floats(-1, 1))
def test_t_interval_moves_with_its_values(values: list[float], by: float) -> None:
    """Adding a constant moves mean and interval by it, and leaves the SD alone."""
    here, there = over_repetitions(values), over_repetitions([value + by for value in values])
    assert here.sd is not None
    assert there.sd is not None
    assert abs(there.mean - here.mean - by) < 1e-9
    assert abs(there.sd - here.sd) < 1e-9


@fewer
@given(p_values, st.integers(0, 5))
def test_holm_never_makes_a_p_smaller_and_keeps_the_order(raw: dict[str, float], unrun: int) -> None:
    """Raw <= adjusted <= 1, in the same order; a larger family is never milder."""
    found, larger = holm(raw), holm(raw, len(raw) + unrun)
    for name, value in raw.items():
        assert value <= found[name] <= larger[name] <= 1.0 or value == found[name] == 1.0
    ordered = sorted(raw, key=lambda name: (raw[name], name))
    assert [found[name] for name in ordered] == sorted(found.values())


@fewer
@given(tables)
def test_swapping_the_two_turns_the_difference_round(pairs: dict[str, list[tuple[bool, bool]]]) -> None:
    """difference(b, a) = -difference(a, b); p stays; the interval is mirrored up to resampling."""
    turned = {task: [(b, a) for a, b in own] for task, own in pairs.items()}
    assert risk_difference(turned) == -risk_difference(pairs)
    assert mcnemar(turned).p == mcnemar(pairs).p


@fewer
@given(tables, st.booleans())
def test_bootstrap_ignores_the_order_and_holds_still(pairs: dict[str, list[tuple[bool, bool]]], tasks: bool) -> None:
    """Same generator, other order of tasks and trials: the same interval; it lies within -1 and 1."""
    turned = {task: list(reversed(pairs[task])) for task in reversed(list(pairs))}
    first, second = (
        bootstrap_difference(own, np.random.default_rng(3), resample_tasks=tasks, resamples=200)
        for own in (pairs, turned)
    )
    assert (first.low, first.high) == (second.low, second.high)
    assert -1.0 <= first.low <= first.high <= 1.0


@fewer
@given(tables)
def test_identical_outcomes_show_nothing(pairs: dict[str, list[tuple[bool, bool]]]) -> None:
    """A configuration against itself: difference 0, interval [0, 0], p = 1."""
    same = {task: [(a, a) for a, _ in own] for task, own in pairs.items()}
    found = bootstrap_difference(same, np.random.default_rng(0), resamples=50)
    assert (found.value, found.low, found.high, mcnemar(same).p) == (0.0, 0.0, 0.0, 1.0)


@fewer
@given(st.integers(30, 5000), st.floats(0.05, 0.5))
def test_more_pairs_detect_smaller_differences(n: int, discordance: float) -> None:
    """The detectable difference falls with the number of pairs and never exceeds the discordance unless hopeless."""
    here, there = minimum_detectable_difference(n, discordance), minimum_detectable_difference(4 * n, discordance)
    assert there <= here
    assert here == 1.0 or here <= discordance


@fewer
@given(outcomes)
def test_kappa_is_at_most_the_accuracy(pairs: list[tuple[bool, bool]]) -> None:
    """Chance only takes away: kappa <= accuracy, and 1 only if both agree everywhere."""
    found = agreement(pairs)
    assert found.count == len(pairs)
    if found.kappa is not None and found.accuracy is not None:
        assert found.kappa <= found.accuracy + 1e-12
        assert (found.kappa == 1.0) == all(a == b for a, b in pairs)


@fewer
@given(st.lists(st.tuples(st.sampled_from([0.1, 0.4, 0.4, 0.7, 0.9]), st.booleans()), min_size=2, max_size=40))
def test_auc_counts_the_pairs(rated: list[tuple[float, bool]]) -> None:
    """AUC is the share of (success, failure) pairs that the score orders rightly, ties counting half."""
    good = [q for q, ok in rated if ok]
    bad = [q for q, ok in rated if not ok]
    found = auc([q for q, _ in rated], [ok for _, ok in rated])
    if not good or not bad:
        assert found is None
        return
    wins = sum((g > b) + 0.5 * (g == b) for g in good for b in bad)
    assert found is not None
    assert abs(found - wins / (len(good) * len(bad))) < 1e-12
