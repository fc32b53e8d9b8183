"""The first anomalous event of an attempt, in the order of time (ledger G17, from observables only)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from kb.constraint import Constraints
from kb.percept import PerceivedObject, Percept
from kb.sensing import Evidence, Plan
from kb.vocabulary import FailureType
from sim.quality import COMPLIANT, FIT_ALLOWANCE, maximum_force
from tools.diagnosis.claim import CLOSED_EMPTY, LEAST_LOAD, PARTIAL, SUNK, WIDTH_SURPRISE, gone
from tools.diagnosis.misfit import first_contact, meets, misfit, table_contact, width_at
from tools.planning.surroundings import own_points, surroundings

NEAR = 0.008
"""A sweep that passes a neighbour this closely may have met it [m]: perception's error."""
PUSHED = 0.5
"""Wrist force while closing above which the fingers met something [N]."""
EARLY = 0.6
"""A load lost this soon after the test lift was never far off the ground [s]; measured: slips 0 to 0.6, drops from 0.6."""
WHOLE = 0.8
"""Share of the lightest expected mass from which the test lift bore it all."""
NUDGED = 0.06
"""A target seen this near to where it stood, on the table, was at most nudged [m]."""
TIGHT = 0.004
"""An opening that exceeds the local width by less than this lets the fingers land on the object [m]."""


@dataclass(frozen=True)
class Anomaly:
    """A failure type with the readings that decided."""

    failure: FailureType
    confidence: float
    reasons: tuple[str, ...]


@dataclass(frozen=True)
class Case:
    """All that the tests below may look at."""

    plan: Plan
    evidence: Evidence
    constraints: Constraints
    target: PerceivedObject
    percept: Percept


def first_anomaly(
    plan: Plan, evidence: Evidence, constraints: Constraints, target: PerceivedObject, percept: Percept
) -> Anomaly:
    """Walks the phases in their order and returns the first event that explains the failure."""
    case = Case(plan, evidence, constraints, target, percept)
    tests: tuple[Callable[[Case], Anomaly | None], ...] = (
        _before_moving,
        _on_the_way,
        _while_closing,
        _wrong_object,
        _while_lifting,
        _while_holding,
        _afterwards,
    )
    for test in tests:
        anomaly = test(case)
        if anomaly is not None:
            return anomaly
    return Anomaly("UNKNOWN", 0.3, ("no reading explains it",))


def _before_moving(case: Case) -> Anomaly | None:
    sensed = case.evidence.sensing
    if not sensed.reachable or sensed.stopped_by in ("unreachable", "path"):
        reason = f"nearest arm posture misses the pose by {1000 * sensed.ik_residual:.0f} mm"
        return Anomaly("UNREACHABLE_POSE", 0.98, (reason,))
    if sensed.stopped_by == "timeout":
        return Anomaly("TIMEOUT", 0.98, (f"{sensed.sim_time:.0f} s were not enough",))
    if sensed.stopped_by == "stop":
        return Anomaly("UNKNOWN", 0.9, ("a person stopped the motion",))
    return None


def _on_the_way(case: Case) -> Anomaly | None:
    """The reflex fired before the fingers closed: what was met?"""
    sensed = case.evidence.sensing
    if sensed.stopped_by != "force" or sensed.phase not in ("transit", "approach"):
        return None
    said = f"{sensed.abort_force:.0f} N stopped the {sensed.phase}"
    if sensed.phase == "transit":
        return Anomaly("COLLISION", 0.8, (said, "nothing should be on the free way"))
    grasp = case.plan.grasp
    neighbours = surroundings(case.percept, case.target.id)
    met: list[tuple[float, int, Anomaly]] = []
    on_target = first_contact(grasp, own_points(case.target))
    if on_target is not None:
        kind = misfit(grasp, case.target)
        reason = f"the opening of {1000 * grasp.aperture:.0f} mm led onto the object"
        met.append((on_target, 1, Anomaly(kind, 0.7, (said, reason))))
    on_table = table_contact(grasp)
    if on_table is not None:
        met.append((on_table, 2, Anomaly("APPROACH_ANGLE", 0.8, (said, "the fingertips aimed below the table"))))
    on_other = first_contact(grasp, neighbours, NEAR)
    if on_other is not None:
        # Its unseen sides make a neighbour larger than it looks, so it counts a little earlier.
        met.append((on_other, 0, Anomaly("COLLISION", 0.8, (said, "the hand's way passes close by a neighbour"))))
    if met:
        return max(met, key=lambda item: (item[0], -item[1]))[2]
    if grasp.aperture < case.plan.local_width + TIGHT:
        return Anomaly("WIDTH_MISMATCH", 0.6, (said, "the fingers were hardly wider apart than the object"))
    return Anomaly("POSITION_ERROR", 0.6, (said, "nothing but the target was near"))


def _while_closing(case: Case) -> Anomaly | None:
    sensed, grasp = case.evidence.sensing, case.plan.grasp
    bearable = maximum_force(case.target.affordance.fragility)
    if sensed.closing_force_peak > bearable:
        kind: FailureType = "DEFORMATION" if case.target.affordance.material in COMPLIANT else "FORCE_DAMAGE"
        return Anomaly(kind, 0.7, (f"{sensed.closing_force_peak:.0f} N while closing, {bearable:.0f} N is bearable",))
    if sensed.aperture_closed >= CLOSED_EMPTY:
        return None
    if sensed.closing_wrench > PUSHED and _askew(case):
        return Anomaly("ORIENTATION", 0.7, ("the fingers met the object askew, turned it and closed on nothing",))
    if width_at(grasp, case.target, 0.0) + FIT_ALLOWANCE > grasp.aperture and meets(grasp, case.target):
        return Anomaly(misfit(grasp, case.target), 0.6, ("the fingers couldn't get around the object",))
    return Anomaly("POSITION_ERROR", 0.8, ("the fingers closed on nothing",))


def _askew(case: Case) -> bool:
    """Whether the closing axis is far off the narrow side of a long object."""
    long, short, _ = case.target.size
    if long < 1.3 * short or case.target.shape in ("sphere", "cylinder", "bowl"):
        return False
    off = abs(math.remainder(case.plan.grasp.yaw - case.target.yaw - math.pi / 2, math.pi))
    return off > math.radians(25.0)


def _wrong_object(case: Case) -> Anomaly | None:
    sensed, camera, places = case.evidence.sensing, case.evidence.camera, case.evidence.places
    if sensed.load_end <= LEAST_LOAD or sensed.aperture_end <= CLOSED_EMPTY:
        return None
    held = f"{sensed.load_end:.3f} kg are held"
    # A nudged target that is still there while something else vanished is not what is held either.
    other = camera is not None and camera.target_visible and bool(camera.missing) and camera.target_moved < NUDGED
    if places is not None:
        if places.is_other:
            what = (
                f"{', '.join(places.emptied)} left its place" if places.emptied else "the target is still in its place"
            )
            return Anomaly("WRONG_OBJECT", 0.95, (f"{held}, and {what}",))
        # What was held has been put back since: that the target stands there now says nothing any more.
        unclear = other and not places.is_target
        return Anomaly("WRONG_OBJECT", 0.6, (f"{held}, the target is not it",)) if unclear else None
    stays = camera is not None and (not gone(camera) or other)
    off = abs(sensed.aperture_closed - case.plan.local_width)
    if stays or (camera is None and off > WIDTH_SURPRISE):
        return Anomaly("WRONG_OBJECT", 0.8, (f"{held}, the target is not it",))
    return None


def _while_lifting(case: Case) -> Anomaly | None:
    """Lost before it was well off the ground: the fingers slid off it, unless they held it askew."""
    sensed = case.evidence.sensing
    lost = sensed.load_end < max(LEAST_LOAD, 0.4 * case.target.mass[0])
    if not lost or sensed.held_s >= EARLY:
        return None
    whole = sensed.load_lifted >= WHOLE * case.target.mass[0]
    if whole and sensed.load_lifted > LEAST_LOAD:
        return None
    if _askew(case):
        return Anomaly("ORIENTATION", 0.6, ("held across its length, it turned out of the fingers",))
    if sensed.load_lifted <= LEAST_LOAD:
        return Anomaly("SLIP", 0.8, ("the fingers closed on it, but after 2 cm nothing weighed on the hand",))
    return Anomaly("SLIP", 0.8, (f"{sensed.load_lifted:.3f} kg after 2 cm, lost {sensed.held_s:.1f} s later",))


def _while_holding(case: Case) -> Anomaly | None:
    sensed = case.evidence.sensing
    lost = sensed.aperture_end < CLOSED_EMPTY or sensed.load_end < 0.3 * max(sensed.load_lifted, case.target.mass[0])
    if lost:
        return Anomaly("DROP", 0.8, (f"{sensed.load_lifted:.3f} kg were lifted and lost after {sensed.held_s:.1f} s",))
    moved = abs(sensed.aperture_end - sensed.aperture_closed) > SUNK
    if moved or sensed.load_lifted < PARTIAL * sensed.load_end:
        return Anomaly("SLIP", 0.7, ("the object moved between the fingers",))
    return None


def _afterwards(case: Case) -> Anomaly | None:
    camera = case.evidence.camera
    protected = {item.target for item in case.constraints.active}
    if camera is not None:
        touched = [name for name in (*camera.others_moved, *camera.missing) if name in protected]
        if touched or (camera.missing and case.constraints.active):
            return Anomaly("CONSTRAINT_VIOLATION", 0.8, (f"{', '.join(touched or camera.missing)} moved",))
        if camera.missing:
            return Anomaly("COLLISION", 0.6, (f"{', '.join(camera.missing)} vanished",))
        if camera.deformed:
            return Anomaly("DEFORMATION", 0.7, ("the object changed its shape",))
    return None
