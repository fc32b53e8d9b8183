"""Statistics against numbers that can be looked up or computed another way."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import binomtest, t

from bench.statistics import (
    binomial_two_sided,
    bootstrap_difference,
    holm,
    macro,
    mcnemar,
    minimum_detectable_difference,
    over_repetitions,
    risk_difference,
    trial_weighted,
    wilson,
)


@pytest.mark.parametrize(("k", "n"), [(0, 30), (1, 30), (11, 12), (30, 30), (282, 360), (1795, 1800)])
def test_wilson_is_scipys(k: int, n: int) -> None:
    """The Wilson interval agrees with scipy's to twelve digits."""
    expected = binomtest(k, n).proportion_ci(method="wilson")
    found = wilson(k, n)
    assert (found.low, found.high) == pytest.approx((expected.low, expected.high), abs=1e-12)


def test_wilson_of_the_papers_retrieval() -> None:
    """11 of 12 queries leave [64.6, 98.5] % open (ledger G31)."""
    found = wilson(11, 12)
    assert (round(100 * found.low, 1), round(100 * found.high, 1)) == (64.6, 98.5)


def test_wilson_refuses_more_successes_than_trials() -> None:
    """A share above one is a bug of the caller."""
    with pytest.raises(ValueError, match="31 of 30"):
        wilson(31, 30)


def test_t_interval_of_the_paper() -> None:
    """Five values of mean 78.7 and SD 1.8 give the paper's interval [76.4, 81.0] to its rounding (ledger G28)."""
    spread = np.array([-2.0, -1.0, 0.0, 1.0, 2.0])
    values = 78.7 + 1.8 * spread / spread.std(ddof=1)
    found = over_repetitions(list(values))
    assert found.sd == pytest.approx(1.8)
    assert found.low == pytest.approx(78.7 - t.ppf(0.975, 4) * 1.8 / 5**0.5)
    assert (found.low, found.high) == pytest.approx((76.4, 81.0), abs=0.1)


def test_one_repetition_has_no_interval() -> None:
    """Spread cannot be estimated from one value, and is not invented."""
    found = over_repetitions([0.9])
    assert (found.mean, found.sd, found.low, found.high) == (0.9, None, None, None)


def test_means_weigh_as_they_say() -> None:
    """The paper's row of Full: trial-weighted 78.3 %, macro over categories 74.2 % (ledger G23)."""
    counts = [(165, 180), (77, 120), (40, 60)]
    assert round(100 * trial_weighted(counts), 1) == 78.3
    assert round(100 * macro(counts), 1) == 74.2


@pytest.mark.parametrize(("k", "n"), [(0, 3), (3, 3), (5, 20), (10, 20), (61, 100), (450, 1000)])
def test_exact_test_is_scipys(k: int, n: int) -> None:
    """The two-sided exact p of a fair coin agrees with scipy's."""
    assert binomial_two_sided(k, n) == pytest.approx(binomtest(k, n, 0.5).pvalue, rel=1e-9)


def test_mcnemar_uses_discordant_pairs_only() -> None:
    """Three discordant pairs on one side give p = 0.25 whatever the concordant ones are (ledger G31)."""
    pairs = {"a": [(True, False)] * 3 + [(True, True)] * 50, "b": [(False, False)] * 7}
    found = mcnemar(pairs)
    assert (found.only_first, found.only_second, found.p) == (3, 0, 0.25)


def test_holm_by_hand() -> None:
    """Holm's adjustment of a worked example: 0.01, 0.04, 0.03 become 0.03, 0.06, 0.06."""
    assert holm({"a": 0.01, "b": 0.04, "c": 0.03}) == pytest.approx({"a": 0.03, "b": 0.06, "c": 0.06})


def test_contrasts_that_were_not_run_still_cost() -> None:
    """In a registered family of ten, the smallest p of two is multiplied by ten."""
    assert holm({"a": 0.004, "b": 0.5}, 10)["a"] == pytest.approx(0.04)


def test_family_cannot_be_smaller_than_its_contrasts() -> None:
    """A family that leaves out a contrast that was run would be too mild."""
    with pytest.raises(ValueError, match="2 contrasts in a family of 1"):
        holm({"a": 0.1, "b": 0.2}, 1)


@pytest.mark.parametrize(
    ("n", "discordance", "points"), [(1800, 0.2, 3.0), (1800, 0.1, 2.1), (360, 0.2, 6.6), (360, 0.1, 4.7)]
)
def test_detectable_differences_of_the_protocol(n: int, discordance: float, points: float) -> None:
    """The four values that the protocol states."""
    assert round(100 * minimum_detectable_difference(n, discordance), 1) == points


def test_detectable_difference_has_the_power_it_claims() -> None:
    """Simulated McNemar tests at the smallest detectable difference reject about 80 % of the time."""
    n, discordance, rng = 360, 0.2, np.random.default_rng(5)
    difference = minimum_detectable_difference(n, discordance)
    chances = [(discordance + difference) / 2, (discordance - difference) / 2, 1 - discordance]
    draws = rng.multinomial(n, chances, 800)
    # The normal test of the approximation; the exact one is a little more conservative.
    rejected = np.abs(draws[:, 0] - draws[:, 1]) > 1.959964 * np.sqrt(draws[:, 0] + draws[:, 1])
    assert 0.75 < rejected.mean() < 0.85


def test_few_pairs_detect_nothing() -> None:
    """Five pairs of which one differs cannot show any difference."""
    assert minimum_detectable_difference(5, 0.2) == 1.0


def test_bootstrap_covers_the_true_difference() -> None:
    """Over 200 drawn data sets, the 95 % interval holds the true difference in 90 to 99 % of them."""
    rng = np.random.default_rng(11)
    hits = 0
    for _ in range(200):
        pairs = {
            task: [(bool(a < 0.9), bool(b < 0.8)) for a, b in rng.random((40, 2))] for task in ("x", "y", "z")
        }  # fmt: skip
        found = bootstrap_difference(pairs, rng, resamples=1000)
        hits += found.low <= 0.1 <= found.high
    assert 0.90 <= hits / 200 <= 0.99


def test_drawing_tasks_anew_widens_the_interval() -> None:
    """Where tasks differ more than trials within them, the interval over tasks is the wider one."""
    pairs = {
        "easy": [(True, True)] * 30,
        "hard": [(True, False)] * 30,
        "odd": [(True, True)] * 15 + [(True, False)] * 15,
    }
    trials = bootstrap_difference(pairs, np.random.default_rng(0))
    tasks = bootstrap_difference(pairs, np.random.default_rng(0), resample_tasks=True)
    assert trials.value == tasks.value == risk_difference(pairs) == 0.5
    assert tasks.high - tasks.low > 2 * (trials.high - trials.low)
