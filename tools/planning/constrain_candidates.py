"""Constraints act on candidates: some are ruled out, others are leaned away from what must not be touched."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from kb.base import Vec3
from kb.by_identity import ByIdentity
from kb.constraint import Adjustment, Constraints
from kb.grasp import closing_axis
from kb.percept import PerceivedObject
from tools.planning.body_candidates import palm_floor, tip_floor
from tools.planning.candidate import Array, Candidate, vec3

CONTENT_TILT = math.radians(15.0)
"""Largest tilt off vertical while contents must stay in, if the constraint names none [rad] (ledger G11)."""
MOST_UPRIGHT = math.radians(16.0)
"""Only approaches at most this tilted are leaned further [rad]."""
FULL_BIAS = 0.6
"""Share of the wanted lean that a candidate must take to count as leaning away."""
YAW_SECTOR = math.radians(50.0)
"""Closing axes nearer than this to a neighbour's bearing are worse [rad]: the hand is widest along them."""
LATERAL_BIAS = 0.3
"""Lean towards the free side of an occluder (as the bias of ledger G11)."""


@dataclass(frozen=True)
class Constrained:
    """A candidate with what the constraints did to it."""

    candidate: Candidate
    malus: float
    """Non-negative: how badly it fits the soft constraints."""
    changes: tuple[tuple[str, str, str], ...] = ()
    """(field of the grasp, id of the constraint, what it changed)."""


def constrain(
    candidates: list[Candidate], subject: PerceivedObject, constraints: Constraints, rejected: dict[str, int]
) -> list[Constrained]:
    """Applies hard and soft constraints to all candidates.

    Args:
        candidates: From geometry.
        subject: The target.
        constraints: Active constraints with their adjustment.
        rejected: Counter by reason, added to.
    """

    def fresh() -> tuple[tuple[Constrained, ...], dict[str, int]]:
        counts: dict[str, int] = {}
        return tuple(_constrain(candidates, subject, constraints, counts)), counts

    kept, counts = _pools.get((subject, *candidates), constraints.model_dump_json(), fresh)
    for reason, count in counts.items():
        rejected[reason] = rejected.get(reason, 0) + count
    return list(kept)


_pools: ByIdentity[tuple[tuple[Constrained, ...], dict[str, int]]] = ByIdentity(32)
"""Subject, candidates and constraints -> what is left and why others are not: configurations of a trial ask for the same."""


def _constrain(
    candidates: list[Candidate], subject: PerceivedObject, constraints: Constraints, rejected: dict[str, int]
) -> list[Constrained]:
    adjustment = constraints.adjustment
    limit = _tilt_limit(adjustment)
    bias = np.asarray(adjustment.away, float)
    if adjustment.lateral is not None:
        # The hand arrives from the free side, so it moves against it.
        bias = bias - LATERAL_BIAS * np.asarray(adjustment.lateral)
    kept: list[Constrained] = []
    wanted = float(np.linalg.norm(bias))
    bends = _Bends(bias, limit)
    for candidate in candidates:
        if limit is not None and candidate.tilt > limit + 1e-6:
            rejected["content: approach too tilted"] = rejected.get("content: approach too tilted", 0) + 1
            continue
        leans = wanted >= 1e-6
        kept.append(_lean(candidate, subject, bends, constraints) if leans else Constrained(candidate, 0.0))
    if not adjustment.avoid_yaw:
        return kept
    return [
        Constrained(item.candidate, item.malus + _yaw_malus(item.candidate, adjustment), item.changes) for item in kept
    ]


def _tilt_limit(adjustment: Adjustment) -> float | None:
    if adjustment.max_tilt is not None:
        return adjustment.max_tilt
    return CONTENT_TILT if adjustment.direction is not None else None


@dataclass(frozen=True)
class _Bend:
    """What the bias does to an approach."""

    already: float
    """Share of the bias that the approach has of itself."""
    approach: Vec3
    """The approach leaned."""
    tilt: float
    """Its tilt off vertical [rad]."""
    share: float
    """Share of the bias that it could take."""
    turned: int
    """By how much it was leaned [whole degrees]."""


class _Bends:
    """The part of the bias that lies in the plane of the fingers' width, for each approach and closing axis once.

    Along the closing axis a lean would turn the pads off the surfaces they are to meet, so that part is left out.
    """

    def __init__(self, bias: Array, limit: float | None) -> None:
        self._bias, self._limit = bias, limit
        self._known: dict[tuple[Vec3, float], _Bend] = {}

    def of(self, approach: Vec3, yaw: float) -> _Bend:
        """The bend of an approach with this azimuth of the closing axis [rad]."""
        known = self._known.get((approach, yaw))
        if known is None:
            known = self._known[approach, yaw] = self._bend(approach, yaw)
        return known

    def _bend(self, approach: Vec3, yaw: float) -> _Bend:
        bias = self._bias
        wanted = _length(bias)
        closing = closing_axis(approach, yaw)
        before = np.asarray(approach)
        usable = bias - closing * float(bias @ closing)
        after = before + usable
        after /= _length(after)
        if self._limit is not None:
            after = _limited(after, self._limit)
        return _Bend(
            already=max(0.0, float(before @ bias) / wanted),
            approach=vec3(after),
            tilt=math.acos(max(-1.0, min(1.0, -float(after[2])))),
            share=_length(usable) / wanted,
            turned=round(math.degrees(math.acos(max(-1.0, min(1.0, float(before @ after)))))),
        )


def _lean(candidate: Candidate, subject: PerceivedObject, bends: _Bends, constraints: Constraints) -> Constrained:
    """Leans the approach by the part of the bias that it can take; the rest counts as a malus, so that other closing axes
    will be preferred."""
    bend = bends.of(candidate.approach, candidate.yaw)
    # A side approach that already moves the wanted way, or can't be bent without losing its height, stays as it is.
    if candidate.tilt > MOST_UPRIGHT:
        return Constrained(candidate, 0.3 * (1.0 - bend.already) if bend.already < FULL_BIAS else 0.0)
    tilt = bend.tilt
    x, y, z = candidate.position
    floor = max(tip_floor(subject, tilt), palm_floor(subject.top_z, tilt) - 0.003 if candidate.region != "rim" else 0.0)
    leaned = replace(
        candidate,
        name=f"{candidate.name}/lean{round(math.degrees(tilt))}",
        approach=bend.approach,
        position=(x, y, max(z, floor) if candidate.region != "rim" else z),
    )
    ids = ",".join(
        f"{item.kind}:{item.target}" for item in constraints.active if item.kind in ("collision", "occlusion")
    )
    change = (
        "approach",
        ids or "bias",
        f"leaned {bend.turned} deg",
    )
    return Constrained(leaned, 0.3 * max(0.0, FULL_BIAS - bend.share), (change,))


def _length(vector: Array) -> float:
    """Length of a vector (3,); `numpy.linalg.norm` takes three times as long for the same number."""
    return math.sqrt(float(vector.dot(vector)))


def _limited(direction: Array, limit: float) -> Array:
    """The direction with its tilt off vertical cut to `limit` [rad]."""
    flat = np.array([direction[0], direction[1], 0.0])
    length = float(np.linalg.norm(flat))
    if length < 1e-9 or math.atan2(length, -direction[2]) <= limit:
        return direction
    return flat / length * math.sin(limit) + np.array([0.0, 0.0, -math.cos(limit)])


def _yaw_malus(candidate: Candidate, adjustment: Adjustment) -> float:
    worst = 0.0
    for bearing in adjustment.avoid_yaw:
        off = abs(math.remainder(candidate.yaw - bearing, math.pi))
        worst = max(worst, 1.0 - off / YAW_SECTOR)
    return 0.2 * worst
