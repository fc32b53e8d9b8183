"""Puts measurements together to the verdict on one motion (benchmark.md section 3)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from kb.verdict import ObservedAttempt, Verdict
from kb.vocabulary import FailureType
from sim.local_width import region_distance
from sim.verdict_constraints import Trial, measure, required_targets, task_conditions
from sim.verdict_damage import Damage, damages, disturbed, peak_force, toppled
from sim.verdict_events import SLIP_LIMIT, TIME_LIMIT, Event, WidthAt, abort_limit, events
from sim.verdict_grip import HOLD_TIME, LIFT_HEIGHT, ROW, Grip, object_in_hand
from sim.verdict_place import placed_well

ON_REGION = 0.015
"""A grip lies on the annotated region within this distance of the pads' middle [m]."""

WidthOf = Callable[[Grip], WidthAt]


@dataclass(frozen=True)
class Finding:
    """All that one motion showed about the object that was meant."""

    grip: Grip
    in_hand: str | None
    harm: list[Damage]
    fell: tuple[str, ...]
    """Other objects that toppled."""
    conditions: dict[str, bool]
    trial: Trial


def unmoved() -> ObservedAttempt:
    """The verdict on an attempt without motion: no way to the grasp was found."""
    verdict = Verdict(lifted_m=0, held_s=0, slip_m=0, contact=False, aperture_m=0, peak_force_n=0, correct_object=True)
    return ObservedAttempt(verdict=verdict, success=False, failure="UNREACHABLE_POSE")


def judge(
    trial: Trial, meant: str | None, width_of: WidthOf, placement: Any = None, other: str | None = None
) -> ObservedAttempt:
    """Judges the last motion of `trial`.

    Args:
        trial: All motions up to and with the one to be judged.
        meant: Scene id of the object that was to be grasped or placed; None where nothing in the scene fits.
        width_of: Gives the true width of an object between the fingers.
        placement: For a placing motion: where to; anything with `kind`, `side`, `relation`, `lane`.
        other: Scene id of the placement's reference.
    """
    grips = trial.motions[-1]
    harm = damages(grips, trial.uprights, meant)
    in_hand = object_in_hand(grips)
    if meant not in grips:
        return _judge_none(trial, in_hand, harm)
    grip = grips[meant]
    fell = tuple(name for name, g in grips.items() if name != meant and toppled(g, trial.uprights[name]) >= 0)
    conditions = task_conditions(trial.placed.task, meant, trial)
    finding = Finding(grip, in_hand, harm, fell, conditions, trial)
    placing = grip.closed < 0 and len(grip.track.rows("set_down", "release", "carry")) > 0
    placed = None
    if placing:
        reference = grips.get(other) if other is not None else None
        placed = placed_well(grip, trial.uprights[meant], trial.start[meant], trial.placed, placement, reference)
    success = _placing_succeeded(finding, bool(placed)) if placing else _grasp_succeeded(finding)
    failure = None if success else _label(finding, width_of(grip))
    return ObservedAttempt(
        verdict=_verdict(finding, placed),
        success=success,
        failure=failure,
        lift_success=_lifted(finding),
        affordance_correct=_on_region(grip),
        strict=success and _on_region(grip) and _constraints_kept(trial),
    )


def _verdict(finding: Finding, placed: bool | None) -> Verdict:
    grip = finding.grip
    during, after = grip.slip_apart
    opening = grip.track.opening
    return Verdict(
        lifted_m=round(grip.lifted, 5),
        held_s=round(grip.held, 3),
        slip_m=round(grip.slip, 5),
        contact=bool(grip.gripped),
        aperture_m=round(float(opening[grip.closed] if grip.closed >= 0 else opening[-1]), 5),
        peak_force_n=round(float(peak_force(grip)[0].max()), 3),
        damage=tuple(dict.fromkeys(damage.object for damage in finding.harm)),
        disturbed=disturbed(finding.trial.motions[-1], (grip.thing.id, finding.in_hand)),
        correct_object=finding.in_hand in (None, grip.thing.id),
        placed=placed,
        slip_lift_m=round(during, 5),
        slip_hold_m=round(after, 5),
    )


def _judge_none(trial: Trial, in_hand: str | None, harm: list[Damage]) -> ObservedAttempt:
    """Nothing in the scene was meant: whatever was gripped is wrong."""
    track = next(iter(trial.motions[-1].values())).track
    verdict = Verdict(
        lifted_m=0.0,
        held_s=0.0,
        slip_m=0.0,
        contact=in_hand is not None,
        aperture_m=round(float(track.opening[-1]), 5),
        peak_force_n=0.0,
        damage=tuple(dict.fromkeys(damage.object for damage in harm)),
        disturbed=disturbed(trial.motions[-1], (in_hand,)),
        correct_object=False,
    )
    return ObservedAttempt(verdict=verdict, success=False, failure="WRONG_OBJECT" if in_hand else "UNKNOWN")


def _grasp_succeeded(finding: Finding) -> bool:
    """The definition of grasp success."""
    grip, track = finding.grip, finding.grip.track
    before = track.rows("transit", "approach")
    touched = float(grip.pressed[before].max()) if len(before) else 0.0
    return bool(
        finding.in_hand == grip.thing.id
        and grip.lifted >= LIFT_HEIGHT
        and grip.held_before_shake >= HOLD_TIME - 2 * ROW
        and grip.survived_shake
        and grip.slip <= SLIP_LIMIT
        and not finding.trial.damaged
        and not finding.fell
        and track.time[-1] - track.time[0] <= TIME_LIMIT
        and touched <= abort_limit(grip.thing.damage_force)
        and all(finding.conditions.values())
    )


def _placing_succeeded(finding: Finding, placed: bool) -> bool:
    return placed and not finding.trial.damaged and not finding.fell


def _lifted(finding: Finding) -> bool:
    """The weaker definition that others report: the right object left the ground and stayed in the hand."""
    grip = finding.grip
    return finding.in_hand == grip.thing.id and grip.lifted >= LIFT_HEIGHT and grip.lost < 0


def _on_region(grip: Grip) -> bool:
    """The pads' middle lies on the annotated affordance region."""
    point = grip.grasp_point
    return bool(grip.gripped and point is not None and region_distance(grip.thing, point) <= ON_REGION)


def _constraints_kept(trial: Trial) -> bool:
    return all(measure(kind, target, trial)[0] for kind, target in required_targets(trial.placed.task))


def _label(finding: Finding, width_at: WidthAt) -> FailureType:
    """Type of the first anomalous event."""
    grips = finding.trial.motions[-1]
    found = events(grips, finding.grip.thing.id, finding.in_hand, finding.harm, width_at)
    last = len(finding.grip.track) - 1
    found += [Event(last, "COLLISION", f"{name} toppled") for name in finding.fell]
    found += [Event(last, "CONSTRAINT_VIOLATION", name) for name, kept in finding.conditions.items() if not kept]
    if not found:
        return "UNKNOWN"
    rows = np.array([event.row for event in found])
    return found[int(np.argmin(rows))].type
