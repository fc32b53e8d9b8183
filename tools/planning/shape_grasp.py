"""From a candidate to a full grasp: opening, force, stand-off and speed, each with its source."""

from __future__ import annotations

import numpy as np

from kb.constraint import Constraints
from kb.grasp import MAX_APERTURE, Grasp
from kb.percept import PerceivedObject
from kb.sensing import Correction
from tools.planning.body_candidates import tip_floor
from tools.planning.candidate import Candidate, vec3
from tools.planning.constrain_candidates import Constrained
from tools.planning.force_choice import ForceTerms
from tools.planning.grasp_prior import GraspPrior
from tools.planning.provenance import Ledger

OPENING_MARGIN = 0.030
"""The hand opens this much wider than the local width [m]: 15 mm a side cover the errors of position and size
(perception.md), and the quality model still accepts the opening (phi_2, ledger G15)."""
NARROW_MARGIN = 0.010
"""Where neighbours leave no room, this much must do [m] (phi_2 is best there)."""


def wide_opening(candidate: Candidate) -> float:
    """The opening used unless something stands in the way [m]."""
    return min(MAX_APERTURE, candidate.room, candidate.width + OPENING_MARGIN)


def narrow_opening(candidate: Candidate) -> float:
    """The smallest opening that still covers the errors of perception [m]."""
    return min(MAX_APERTURE, candidate.room, candidate.width + NARROW_MARGIN)


def first_opening(candidate: Candidate, correction: Correction | None) -> float:
    """The opening [m] that is tried first: the wide one, or what a correction demands beyond it."""
    aperture = wide_opening(candidate)
    if correction and "aperture" in correction.changes:
        aperture = min(MAX_APERTURE, candidate.room, max(float(str(correction.changes["aperture"])), aperture))
    return aperture


def shape_grasp(
    item: Constrained,
    subject: PerceivedObject,
    prior: GraspPrior,
    force: ForceTerms,
    constraints: Constraints,
    correction: Correction | None,
    *,
    opening: float | None = None,
) -> Grasp:
    """The grasp of a candidate; `explain` gives the sources of its numbers.

    Args:
        item: The candidate after the constraints acted on it.
        subject: The target.
        prior: What gave region, type and so on.
        force: The chosen force.
        constraints: Active constraints: stand-off and speed.
        correction: The change demanded by the reflection, if any.
        opening: Opening before closing [m]; the wide one if None.
    """
    candidate = item.candidate
    position = np.asarray(candidate.position) + np.asarray(correction.offset if correction else (0.0, 0.0, 0.0))
    # Never into the table, whatever was added.
    position[2] = max(position[2], min(candidate.position[2], tip_floor(subject, candidate.tilt)))
    return Grasp(
        position=vec3(position),
        approach=candidate.approach,
        yaw=candidate.yaw,
        aperture=first_opening(candidate, correction) if opening is None else opening,
        force=force.force(candidate),
        type=candidate.type,
        standoff=chosen_standoff(prior, constraints, correction),
        speed=chosen_speed(prior, constraints, correction),
    )


def chosen_standoff(prior: GraspPrior, constraints: Constraints, correction: Correction | None) -> float:
    """Stand-off h [m]: the prior's, raised by constraints, replaced by a correction."""
    standoff = prior.standoff + constraints.adjustment.standoff
    if correction and "standoff" in correction.changes:
        standoff = float(str(correction.changes["standoff"]))
    return min(0.20, max(0.02, standoff))


def chosen_speed(prior: GraspPrior, constraints: Constraints, correction: Correction | None) -> float:
    """Velocity scale v: the prior's or the correction's, capped by constraints."""
    speed = prior.speed
    if correction and "speed" in correction.changes:
        speed = float(str(correction.changes["speed"]))
    return min(1.0, max(0.1, min(speed, constraints.adjustment.speed)))


def explain(
    item: Constrained,
    grasp: Grasp,
    prior: GraspPrior,
    force: ForceTerms,
    constraints: Constraints,
    correction: Correction | None,
    clearance: float,
) -> Ledger:
    """The sources of all numbers of `grasp` (built by `shape_grasp` from the same arguments)."""
    candidate, ledger = item.candidate, Ledger()
    kinds = ",".join(f"{active.kind}:{active.target}" for active in constraints.active) or "constraints"
    rule = correction.rule if correction else ""
    agreed = prior.region == candidate.region
    if prior.region is not None and agreed:
        ledger.add("position", prior.source, prior.id, f"region {candidate.region}")
    ledger.add("position", "geometry", candidate.name, candidate.position)
    if correction and any(correction.offset):
        ledger.add("position", "correction", rule, correction.offset)
    if prior.approach == candidate.approach_class:
        ledger.add("approach", prior.source, prior.id, prior.approach)
    ledger.add("approach", "geometry", candidate.name, candidate.approach)
    for name, id_, what in item.changes:
        ledger.add("approach" if name == "approach" else "yaw", "constraint", id_, what)
    if constraints.adjustment.avoid_yaw:
        ledger.add("yaw", "constraint", kinds, "hand's width turned away from neighbours")
    ledger.add("yaw", "geometry", f"clearance {1000 * min(clearance, 1.0):.0f} mm", candidate.yaw)
    if correction and "aperture" in correction.changes:
        ledger.add("aperture", "correction", rule, float(str(correction.changes["aperture"])))
    ledger.add("aperture", "geometry", f"local width {1000 * candidate.width:.0f} mm", grasp.aperture)
    ledger.extend("force", force.provenance(candidate))
    if correction and correction.changes.get("type") == candidate.type:
        ledger.add("type", "correction", rule, candidate.type)
    elif prior.type == candidate.type:
        ledger.add("type", prior.source, prior.id, candidate.type)
    else:
        ledger.add("type", "geometry", candidate.name, candidate.type)
    for name, used in (("standoff", prior.standoff), ("speed", prior.speed)):
        source = prior.source if prior.source in ("experience", "memory") else "default"
        ledger.add("standoff" if name == "standoff" else "speed", source, prior.id, used)
    if constraints.adjustment.standoff:
        ledger.add("standoff", "constraint", kinds, constraints.adjustment.standoff)
    if constraints.adjustment.speed < 1.0:
        ledger.add("speed", "constraint", kinds, constraints.adjustment.speed)
    if correction and "standoff" in correction.changes:
        ledger.add("standoff", "correction", rule, grasp.standoff)
    if correction and "speed" in correction.changes:
        ledger.add("speed", "correction", rule, grasp.speed)
    return ledger
