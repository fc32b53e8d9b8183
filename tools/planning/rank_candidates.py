"""The score of a candidate: the grasp quality of Eq. (2) on estimates, bent by experience, constraints and clearance."""

from __future__ import annotations

from dataclasses import dataclass

from kb.experience import Retrieval, Strategy
from kb.grasp import Grasp, Quality
from kb.percept import PerceivedObject
from kb.vocabulary import FailureType
from sim.quality import Subject, grade
from tools.planning.candidate import Candidate
from tools.planning.constrain_candidates import Constrained
from tools.planning.grasp_prior import GraspPrior

REGION_WEIGHT, TYPE_WEIGHT, APPROACH_WEIGHT, TILT_WEIGHT, DEPTH_WEIGHT = 0.50, 0.15, 0.15, 0.10, 0.10
"""How much of the agreement with the experience each of its words carries; they sum to 1."""
PRIOR_WEIGHT = 0.5
"""Weight of the agreement with the experience beside Q, which lies in [0, 1]."""
MERIT_WEIGHT = 0.25
"""Weight of the geometric preference among alike candidates."""
AVOID_MALUS = 0.2
"""Malus of what failed in the same category's trials (ledger G14f: contrast)."""
SAME_DEPTH = 0.12
"""Tool points nearer than this share of the object's height are the same place."""
FORCE_FAILURES: frozenset[FailureType] = frozenset({"SLIP", "DROP", "FORCE_DAMAGE", "DEFORMATION", "TIMEOUT"})
"""Failures that a change of force or speed may cure, at the same place."""
ROOMY = 0.02
"""Clearance beyond which more is no better [m] (phi_5)."""
TIGHT_WEIGHT = 0.35
"""Malus of a hand that sweeps just past something; falls to 0 at `ROOMY`."""


@dataclass(frozen=True)
class Ranked:
    """A scored candidate."""

    item: Constrained
    grasp: Grasp
    quality: Quality
    score: float
    clearance: float


def agreement(candidate: Candidate, prior: GraspPrior) -> float:
    """How well a candidate does what the prior says, in [0, 1]; what the prior leaves open counts as agreed."""
    total = REGION_WEIGHT * (prior.region is None or candidate.region == prior.region)
    total += TYPE_WEIGHT * (prior.type is None or candidate.type == prior.type)
    total += APPROACH_WEIGHT * (prior.approach is None or candidate.approach_class == prior.approach)
    tilt_off = 0.0 if prior.tilt is None else min(1.0, abs(candidate.tilt - prior.tilt) / 0.5)
    depth_off = 0.0 if prior.depth is None else min(1.0, abs(candidate.depth - prior.depth) / 0.4)
    return total + TILT_WEIGHT * (1.0 - tilt_off) + DEPTH_WEIGHT * (1.0 - depth_off)


def lessons(retrieval: Retrieval | None) -> tuple[Strategy, ...]:
    """Strategies of the same category that failed for where or how the hand closed (ledger G14f: contrast).

    What failed for its force alone says nothing about the place, and a place where others succeeded is not bad.
    """
    if retrieval is None:
        return ()
    worked = [item.experience.strategy for item in retrieval.top if item.experience.success]
    found: list[Strategy] = []
    for item in retrieval.avoid:
        entry = item.experience
        main = max(entry.failures, key=lambda kind: entry.failures[kind], default="UNKNOWN")
        misplaced = main not in FORCE_FAILURES
        if item.s_cat >= 1.0 and misplaced and not any(same_way(entry.strategy, other) for other in worked):
            found.append(entry.strategy)
    return tuple(found)


def same_way(one: Strategy, other: Strategy) -> bool:
    """Whether two strategies hold the object alike, force aside."""
    alike = (one.region, one.type, one.approach) == (other.region, other.type, other.approach)
    return alike and abs(one.depth - other.depth) < SAME_DEPTH


def avoided(candidate: Candidate, avoid: tuple[Strategy, ...]) -> float:
    """Malus of a candidate that repeats what failed for this very category."""
    for strategy in avoid:
        alike = (strategy.region, strategy.type, strategy.approach) == (
            candidate.region,
            candidate.type,
            candidate.approach_class,
        )
        if alike and abs(strategy.depth - candidate.depth) < SAME_DEPTH:
            return AVOID_MALUS
    return 0.0


def estimate(
    subject: PerceivedObject, candidate: Candidate, grasp: Grasp, clearance: float, mass: float, friction: float
) -> Quality:
    """Q of Eq. (2) with the robot's own estimates."""
    return grade(grasp, graded_as(subject, candidate, clearance, mass, friction))


def graded_as(
    subject: PerceivedObject, candidate: Candidate, clearance: float, mass: float, friction: float
) -> Subject:
    """What Eq. (2) is told of the object and of a candidate's place on it."""
    return Subject(
        region_distance=candidate.miss,
        width=candidate.width,
        mass=mass,
        friction=friction,
        fragility=subject.affordance.fragility,
        affordance=subject.affordance.type,
        clearance=clearance,
    )


def total_score(
    q: float,
    item: Constrained,
    prior: GraspPrior,
    avoid: tuple[Strategy, ...],
    clearance: float,
) -> float:
    """Q + agreement with experience + geometric preference - constraints' maluses - tightness."""
    tight = 1.0 - min(1.0, max(0.0, clearance) / ROOMY)
    return (
        q
        + PRIOR_WEIGHT * agreement(item.candidate, prior)
        + MERIT_WEIGHT * item.candidate.merit
        - item.malus
        - avoided(item.candidate, avoid)
        - TIGHT_WEIGHT * tight
    )
