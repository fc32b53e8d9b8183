"""The scores that many candidates would have with full clearance and their first opening, reckoned all at once.

The same formulas as `sim.quality.Load.grade`, `ForceTerms.force` and `rank_candidates.total_score`, term by term in the
same order, on arrays: a search bounds a hundred candidates for each one that it shapes into a grasp. A test holds both
ways against each other, bit for bit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kb.by_identity import ByIdentity
from kb.experience import ApproachClass, Strategy
from kb.grasp import MAX_APERTURE, MAX_FORCE, MIN_FORCE
from kb.sensing import Correction
from kb.vocabulary import GraspType, Region
from sim.quality import BEST_ALLOWANCE, FIT_ALLOWANCE, GRAVITY, REACH_ERROR, WEIGHTS, WIDEST_OBJECT, WIDTH_SCALE, Load
from tools.planning.candidate import TIP_REACH, Array
from tools.planning.constrain_candidates import Constrained
from tools.planning.force_choice import PAD_ARM, PAD_LENGTH, TWIST_RADIUS, TWIST_RESERVE, ForceTerms
from tools.planning.grasp_prior import GraspPrior
from tools.planning.rank_candidates import (
    APPROACH_WEIGHT,
    DEPTH_WEIGHT,
    MERIT_WEIGHT,
    PRIOR_WEIGHT,
    REGION_WEIGHT,
    TILT_WEIGHT,
    TYPE_WEIGHT,
    avoided,
)
from tools.planning.shape_grasp import OPENING_MARGIN


def score_bounds(
    pool: Sequence[Constrained],
    prior: GraspPrior,
    force: ForceTerms,
    load: Load,
    avoid: tuple[Strategy, ...],
    correction: Correction | None,
) -> Array:
    """Scores (N,) of candidates with full clearance and their first opening.

    Args:
        pool: The candidates, at least one.
        prior: What they should agree with.
        force: The force to grade them with.
        load: What the object is to a hand.
        avoid: What failed before.
        correction: What the reflection changes.
    """
    table = _tables.get(tuple(pool), None, lambda: _Table.of(pool))
    numbers = table.numbers
    match = np.array([load.match[type_] for _, type_, _ in table.ways])[table.way]
    score = _qualities(numbers, _openings(numbers, correction), _forces(numbers, force), load, match)
    score += PRIOR_WEIGHT * _agreements(table, prior)
    score += MERIT_WEIGHT * numbers[4]
    score -= table.malus
    if avoid:
        score -= np.array([avoided(item.candidate, avoid) for item in pool])
    return score


@dataclass(frozen=True)
class _Table:
    """What is asked of the candidates of a pool, as arrays."""

    numbers: Array
    """`Candidate.numbers` (12, N)."""
    malus: Array
    """`Constrained.malus` (N,)."""
    ways: tuple[tuple[Region, GraspType, ApproachClass], ...]
    """Region, type and approach, each combination once."""
    way: NDArray[np.intp]
    """Which of `ways` each candidate is of (N,)."""

    @classmethod
    def of(cls, pool: Sequence[Constrained]) -> _Table:
        """The table of a pool."""
        candidates = [item.candidate for item in pool]
        ways: dict[tuple[Region, GraspType, ApproachClass], int] = {}
        way = [ways.setdefault((c.region, c.type, c.approach_class), len(ways)) for c in candidates]
        numbers = np.ascontiguousarray(np.array([candidate.numbers for candidate in candidates]).T)
        return cls(numbers, np.array([item.malus for item in pool]), tuple(ways), np.array(way))


_tables: ByIdentity[_Table] = ByIdentity(16)
"""Pools -> their tables: stages of a search and configurations of a trial score the same pools."""


def _openings(numbers: Array, correction: Correction | None) -> Array:
    """As `shape_grasp.first_opening` (N,) [m]."""
    width, room = numbers[:2]
    most = np.minimum(MAX_APERTURE, room)
    opening = np.minimum(most, width + OPENING_MARGIN)
    if correction and "aperture" in correction.changes:
        opening = np.minimum(most, np.maximum(float(str(correction.changes["aperture"])), opening))
    return opening


def _forces(numbers: Array, force: ForceTerms) -> Array:
    """As `ForceTerms.force` (N,) [N]."""
    if force.literal:
        return np.full_like(numbers[0], min(MAX_FORCE, max(MIN_FORCE, force.base)))
    z, cosine, sine, downward = numbers[8:]
    x, y = numbers[6] - force.centre[0], numbers[7] - force.centre[1]
    along, across = np.abs(x * cosine + y * sine), np.abs(y * cosine - x * sine)
    above = np.minimum(PAD_LENGTH, np.maximum(0.004, force.top - (z - TIP_REACH)))
    radius = TWIST_RADIUS * np.where(downward > 0.0, above, PAD_LENGTH) / PAD_LENGTH
    turning = TWIST_RESERVE * across / (2.0 * force.friction * radius)
    tipping = force.mass * GRAVITY * np.maximum(turning, along / PAD_ARM)
    cap = force.cap if force.gentle is None else min(force.cap, force.gentle)
    wanted = np.minimum(np.maximum(max(force.base, force.floor), tipping), cap)
    return np.minimum(MAX_FORCE, np.maximum(MIN_FORCE, wanted))


def _qualities(numbers: Array, opening: Array, force: Array, load: Load, match: Array) -> Array:
    """Q (N,) as `Load.grade` gives it with full clearance."""
    width, _, miss = numbers[:3]
    fits = (width <= WIDEST_OBJECT) & (opening >= width + FIT_ALLOWANCE)
    low = (force - 0.5 * load.least) / (0.5 * load.least)
    high = (1.5 * load.most - force) / (0.5 * load.most)
    a, b, c, d, e, f, g = WEIGHTS
    total = a * _clip(1.0 - miss / REACH_ERROR)
    total += b * np.where(fits, _clip(1.0 - np.abs(opening - (width + BEST_ALLOWANCE)) / WIDTH_SCALE), 0.0)
    total += c * _clip(np.minimum(low, high))
    total += d * match
    total += e
    total += f * _clip(1.0 - (load.fragile + 0.3 * np.minimum(1.0, width / 0.08) + load.heavy))
    total += g * _clip(force / load.holding - 1.0)
    return _clip(total)


def _agreements(table: _Table, prior: GraspPrior) -> Array:
    """As `rank_candidates.agreement` (N,)."""
    words: list[float] = []
    for region, type_, approach in table.ways:
        total = REGION_WEIGHT * (prior.region is None or region == prior.region)
        total += TYPE_WEIGHT * (prior.type is None or type_ == prior.type)
        words.append(total + APPROACH_WEIGHT * (prior.approach is None or approach == prior.approach))
    depth, tilt = table.numbers[3], table.numbers[5]
    tilt_off = 0.0 if prior.tilt is None else np.minimum(1.0, np.abs(tilt - prior.tilt) / 0.5)
    depth_off = 0.0 if prior.depth is None else np.minimum(1.0, np.abs(depth - prior.depth) / 0.4)
    return np.array(words)[table.way] + TILT_WEIGHT * (1.0 - tilt_off) + DEPTH_WEIGHT * (1.0 - depth_off)


def _clip(values: Array) -> Array:
    return np.minimum(np.maximum(values, 0.0), 1.0)
