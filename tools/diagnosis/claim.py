"""Every reason to doubt that a grasp succeeded; the robot claims success only where none is left.

Hard doubts contradict a success. Soft ones say that something other than expected may be in the hand: a look while it is
still held (`tools.diagnosis.held_look`) that shows the target's place empty clears them, and one that shows it occupied
is a hard doubt.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from kb.constraint import Constraints
from kb.percept import PerceivedObject
from kb.sensing import CameraEvidence, Evidence, PlaceEvidence, Plan, Sensing
from kb.vocabulary import UNKNOWN_CATEGORY
from sim.quality import maximum_force

CLOSED_EMPTY = 0.0010
"""Opening below which nothing is between the fingers [m]."""
HELD = 1.9
"""A load must be sensed this long after the lift [s] (benchmark.md section 3: 2 s and the shake)."""
RAISED = 0.10
"""Demanded height of the lift [m]."""
LEAST_LOAD = 0.005
"""Below this the wrist can't tell a load from none [kg]."""
TOO_LIGHT = 0.20
"""Share of the lightest expected mass below which nothing of the target is carried."""
SUNK = 0.008
"""Change of the opening after closing that says the object moved between the fingers [m]; measured on 140 successes: at
most 3 mm."""
WIDTH_SURPRISE = 0.008
"""Opening at rest that differs this much from the perceived width: another thing or place may be held [m]; perceived
widths are within 5 mm (perception.md)."""
PARTIAL = 0.7
"""A mass after the test lift below this share of the final one: the object was still standing on something, it sank or
tilted in the hand. Loops let a cup tilt harmlessly, others don't."""
FAR_END = 0.16
"""Taken by its edge, a thing that reaches this far [m] tilts so much that its far end leaves the table after the test lift."""
LIGHT, HEAVY = 0.7, 1.4
"""Shares of the lightest and heaviest expected mass beyond which it's perhaps another object."""
STILL_THERE = 0.02
"""A target seen this near to where it stood has not been taken [m]."""


@dataclass(frozen=True)
class Doubts:
    """Reasons, in words with numbers."""

    hard: tuple[str, ...] = ()
    soft: tuple[str, ...] = ()

    @property
    def all(self) -> tuple[str, ...]:
        """Hard ones first."""
        return (*self.hard, *self.soft)


def doubts(plan: Plan, evidence: Evidence, constraints: Constraints, target: PerceivedObject) -> Doubts:
    """All reasons against a success, from readings alone."""
    sensed, camera = evidence.sensing, evidence.camera
    if not sensed.reachable:
        return Doubts(hard=("the pose can't be reached",))
    if sensed.stopped_by is not None:
        return Doubts(hard=(f"the motion was stopped by {sensed.stopped_by} in phase {sensed.phase}",))
    hard = [*_not_held(sensed, target), *_moved_in_hand(plan, sensed, target)]
    bearable = maximum_force(target.affordance.fragility)
    if sensed.closing_force_peak > bearable:
        hard.append(f"closing peaked at {sensed.closing_force_peak:.0f} N, {bearable:.0f} N is bearable")
    if any(item.kind == "content" for item in constraints.active) and sensed.load_end < 0.9 * sensed.load_lifted:
        hard.append(f"the load fell from {sensed.load_lifted:.3f} to {sensed.load_end:.3f} kg: contents were lost")
    soft = _surprises(plan, sensed, target)
    if evidence.places is not None:
        hard += _places(evidence.places)
        if evidence.places.is_target or _only_the_guess_is_off(plan, evidence.places, sensed, target):
            soft = []
    if camera is not None:
        hard += _seen(camera, put_back=evidence.places is not None)
        if evidence.places is None and gone(camera):
            soft = []
    return Doubts(tuple(hard), tuple(soft))


def gone(camera: CameraEvidence) -> bool:
    """Whether the target is no longer where it stood."""
    return not camera.target_visible or camera.target_moved >= STILL_THERE


def _not_held(sensed: Sensing, target: PerceivedObject) -> list[str]:
    found: list[str] = []
    if sensed.lift_height < RAISED:
        found.append(f"raised only {100 * sensed.lift_height:.1f} cm")
    if sensed.aperture_end < CLOSED_EMPTY:
        found.append(f"fingers closed to {1000 * sensed.aperture_end:.1f} mm at the end")
    if sensed.held_s < HELD:
        found.append(f"a load was sensed for {sensed.held_s:.1f} s only")
    if sensed.load_end < max(LEAST_LOAD, TOO_LIGHT * target.mass[0]):
        found.append(
            f"{max(0.0, sensed.load_end):.3f} kg on the wrist at the end, {target.mass[0]:.3f} expected at least"
        )
    return found


def _moved_in_hand(plan: Plan, sensed: Sensing, target: PerceivedObject) -> list[str]:
    found: list[str] = []
    if sensed.aperture_end >= CLOSED_EMPTY and abs(sensed.aperture_end - sensed.aperture_closed) > SUNK:
        change = 1000 * (sensed.aperture_end - sensed.aperture_closed)
        found.append(f"opening changed by {change:+.1f} mm while carrying")
    tilts = plan.region == "handle" or (plan.region == "rim" and _far_end(plan, target) > FAR_END)
    if not tilts and LEAST_LOAD < sensed.load_end and sensed.load_lifted < PARTIAL * sensed.load_end:
        found.append(f"the test lift bore only {sensed.load_lifted:.3f} of {sensed.load_end:.3f} kg")
    return found


def _far_end(plan: Plan, target: PerceivedObject) -> float:
    """Horizontal distance from the grip to the farthest end of the thing [m]."""
    return math.dist(plan.grasp.position[:2], target.position[:2]) + max(target.size[:2]) / 2


def _surprises(plan: Plan, sensed: Sensing, target: PerceivedObject) -> list[str]:
    found: list[str] = []
    if abs(sensed.aperture_closed - plan.local_width) > WIDTH_SURPRISE:
        found.append(
            f"fingers rest at {1000 * sensed.aperture_closed:.0f} mm where {1000 * plan.local_width:.0f} mm were expected"
        )
    low, high = target.mass
    if not LIGHT * low <= sensed.load_end <= HEAVY * high:
        found.append(f"{sensed.load_end:.3f} kg are carried where {low:.3f} to {high:.3f} were expected")
    return found


def _only_the_guess_is_off(plan: Plan, places: PlaceEvidence, sensed: Sensing, target: PerceivedObject) -> bool:
    """Whether the weight alone surprises, of a thing whose weight was but guessed from its size.

    The fingers rest where its width said, and a look found no other thing gone: no evidence for another one is no doubt.
    """
    as_wide = abs(sensed.aperture_closed - plan.local_width) <= WIDTH_SURPRISE
    return target.category == UNKNOWN_CATEGORY and as_wide and places.target == "unseen" and not places.emptied


def _places(places: PlaceEvidence) -> list[str]:
    """What the look with something in the hand says against a success; a place that is hidden says nothing."""
    others = ", ".join(places.emptied)
    if places.target == "occupied":
        return [f"the place of {others} is empty, the target's is not" if others else "the target's place is not empty"]
    if places.is_other:
        return [f"the place of {others} has become empty"]
    return [f"{others} left its place, too"] if others else []


def _seen(camera: CameraEvidence, *, put_back: bool) -> list[str]:
    """What a look after the motion says against a success; where a target stands that was put back says nothing."""
    found: list[str] = []
    if camera.missing:
        found.append(f"{', '.join(camera.missing)} no longer seen")
    if camera.deformed:
        found.append("the object changed its shape")
    if not put_back and not gone(camera) and not camera.target_in_hand:
        found.append("the target still stands where it stood")
    return found
