"""What was predicted and what came: calibration of the quality, forces against damage limits, success by attempts."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from agent.configuration import CONFIGURATIONS
from bench.report.recovery import MAX_ATTEMPTS, subgoals
from bench.report.results import Results
from bench.report.table import Table
from bench.report.value import Content, Count, Number
from bench.trial import Trial

BINS = 10
"""Bins of equal width of the expected calibration error."""
SCALES = (0.5, 1.0, 2.0)
"""Factors on the damage limits of the sensitivity rows (benchmark section 1)."""


def tables(results: Results) -> list[Table]:
    """Calibration, success within k attempts, forces, what the agent made of memory and doubt."""
    return [calibration(results), within(results), forces(results), habits(results)]


def brier(predicted: Sequence[float], outcomes: Sequence[bool]) -> float:
    """Mean squared error of predicted probabilities."""
    return float(np.mean((np.asarray(predicted, float) - np.asarray(outcomes, float)) ** 2))


def calibration_error(predicted: Sequence[float], outcomes: Sequence[bool]) -> float:
    """Expected calibration error: |mean prediction - share of successes| per bin of equal width, weighted by its size."""
    chance, good = np.asarray(predicted, float), np.asarray(outcomes, float)
    bins = np.minimum((np.clip(chance, 0.0, 1.0) * BINS).astype(int), BINS - 1)
    gaps = [(bins == b).sum() * abs(chance[bins == b].mean() - good[bins == b].mean()) for b in np.unique(bins)]
    return float(sum(gaps) / len(chance))


def calibration(results: Results) -> Table:
    """How far the quality Q is a probability of success."""
    rows: list[tuple[Content, ...]] = []
    for name in results.configurations:
        rated = [(a.q, a.success) for goal in subgoals(results.of(name)) for a in goal.attempts if a.q is not None]
        if rated:
            predicted, outcomes = [q for q, _ in rated], [good for _, good in rated]
            rows.append(
                (
                    name,
                    len(rated),
                    Number(float(np.mean(predicted)), 3),
                    Count(sum(outcomes), len(outcomes)),
                    Number(brier(predicted, outcomes), 3),
                    Number(calibration_error(predicted, outcomes), 3),
                )
            )
    return Table(
        "calibration",
        "Predicted quality as a probability",
        ("configuration", "attempts", "mean Q", "success", "Brier", "ECE"),
        tuple(rows),
        "Q of Eq. (2), taken as the chance that the attempt succeeds. Brier: mean squared error (0.25: a coin). "
        f"ECE: expected calibration error over {BINS} bins. Q was not fitted to be a probability.",
        frozenset({"full"}),
    )


def within(results: Results) -> Table:
    """Share of sub-goals solved within k attempts."""
    rows: list[tuple[Content, ...]] = []
    for name in results.configurations:
        goals = subgoals(results.of(name))
        if goals:
            counts = [sum(g.success and 0 < len(g.attempts) <= k for g in goals) for k in range(1, MAX_ATTEMPTS + 1)]
            rows.append((name, *(Count(count, len(goals)) for count in counts)))
    return Table(
        "within",
        "Success within so many attempts",
        ("configuration", *(f"success@{k}" for k in range(1, MAX_ATTEMPTS + 1))),
        tuple(rows),
        "Of all sub-goals, also those that were never attempted.",
        frozenset({"full"}),
    )


def shares_of_limit(trials: Sequence[Trial]) -> list[float]:
    """Peak force on each target over its damage limit, one per attempt where both are known."""
    return [
        attempt.peak_n / trial.damage_limit_n[goal.object]
        for trial in trials
        for goal in trial.subgoals
        for attempt in goal.attempts
        if attempt.peak_n is not None and goal.object is not None and goal.object in trial.damage_limit_n
    ]


def overloaded(trial: Trial, scale: float) -> bool:
    """Some target was pressed beyond `scale` times its damage limit."""
    return any(share > scale for share in shares_of_limit([trial]))


def forces(results: Results) -> Table:
    """Peak force over the damage limit, and how many trials would have done damage with other limits."""
    rows: list[tuple[Content, ...]] = []
    for name in results.configurations:
        trials = [t for t in results.of(name) if t.damage_limit_n]
        shares = shares_of_limit(trials)
        if not shares:
            continue
        counts: list[Count] = []
        successes: list[Count] = []
        for scale in SCALES:
            hurt = sum(overloaded(t, scale) for t in trials)
            counts.append(Count(hurt, len(trials)))
            # With higher limits a trial that failed may have gone on; that cannot be known afterwards.
            if scale < 1.0:
                successes.append(Count(sum(t.success and not overloaded(t, scale) for t in trials), len(trials)))
        rows.append(
            (
                name,
                Number(float(np.median(shares)), 2),
                Number(float(np.quantile(shares, 0.95)), 2),
                *counts,
                *successes,
            )
        )
    return Table(
        "forces",
        "Forces against damage limits",
        ("configuration", "peak / limit, median", "95th percentile", *(f"pressed beyond limit ×{s:g}" for s in SCALES),
         "success at limits ×0.5"),
        tuple(rows),
        "Limits are our proxies: max(5, 70 (1 - fragility)) N times U(0.8, 1.25) per object. The rows ×0.5 and ×2 say how "
        "many trials would have pressed their target too hard with other limits; drops and topples do not depend on them.",
        frozenset({"full"}),
    )  # fmt: skip


def _has_memory(name: str) -> bool:
    """Whether the configuration has an episodic memory; names of other versions may have had one."""
    known = CONFIGURATIONS.get(name)
    return known is None or known.switches.memory


def habits(results: Results) -> Table:
    """Strict success, use of the memory, abstentions."""
    rows: list[tuple[Content, ...]] = []
    for name in results.configurations:
        trials = results.of(name)
        if not trials:
            continue
        judged = [t for t in trials if t.strict is not None]
        later = [g for t in trials for g in t.subgoals[1:] if g.attempts]
        still = [t for t in trials if not t.executed and t.harness_error is None]
        rows.append(
            (
                name,
                Count(sum(bool(t.strict) for t in judged), len(judged)),
                Count(sum(g.attempts[0].remembered for g in later), len(later)) if _has_memory(name) else None,
                Count(len(still), len(trials)),
                Count(sum(t.claimed and not t.success for t in trials), sum(t.claimed for t in trials)),
                Count(sum(t.success and not t.claimed for t in trials), sum(t.success for t in trials)),
            )
        )
    return Table(
        "habits",
        "Strict success, memory, abstention, claims",
        ("configuration", "strict success", "memory hits", "abstained", "false claims of claims",
         "missed of successes"),
        tuple(rows),
        "Strict: every grasp on the annotated region and no required constraint violated. Memory hits: later sub-goals of "
        "a trial whose first grasp took a number from the episodic memory, where there is one. Abstained: nothing was moved.",
        frozenset({"full"}),
    )  # fmt: skip
