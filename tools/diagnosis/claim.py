"""Every reason to doubt that a grasp succeeded; the robot claims success only where none is left."""

from __future__ import annotations

from kb.constraint import Constraints
from kb.percept import PerceivedObject
from kb.sensing import Evidence, Plan
from sim.quality import maximum_force

CLOSED_EMPTY = 0.0010
"""Opening below which nothing is between the fingers [m]."""
HELD = 1.9
"""A load must be sensed this long after the lift [s] (benchmark.md section 3: 2 s and the shake)."""
RAISED = 0.10
"""Demanded height of the lift [m]."""
LEAST_LOAD = 0.005
"""Below this the wrist can't tell a load from none [kg]."""
SUNK = 0.008
"""Change of the opening after closing that says the object moved between the fingers [m]."""
WIDTH_SURPRISE = 0.016
"""Opening at rest that differs this much from the perceived width: something else, or another place, is held [m]."""


def doubts(plan: Plan, evidence: Evidence, constraints: Constraints, target: PerceivedObject) -> tuple[str, ...]:
    """Reasons, in words with numbers; empty if all readings agree with a success."""
    sensed = evidence.sensing
    found: list[str] = []
    if not sensed.reachable:
        return ("the pose can't be reached",)
    if sensed.stopped_by is not None:
        return (f"the motion was stopped by {sensed.stopped_by} in phase {sensed.phase}",)
    if sensed.lift_height < RAISED:
        found.append(f"raised only {100 * sensed.lift_height:.1f} cm")
    if sensed.aperture_end < CLOSED_EMPTY:
        found.append(f"fingers closed to {1000 * sensed.aperture_end:.1f} mm at the end")
    elif abs(sensed.aperture_end - sensed.aperture_closed) > SUNK:
        change = 1000 * (sensed.aperture_end - sensed.aperture_closed)
        found.append(f"opening changed by {change:+.1f} mm while carrying")
    if sensed.held_s < HELD:
        found.append(f"a load was sensed for {sensed.held_s:.1f} s only")
    if sensed.load_end < max(LEAST_LOAD, 0.4 * target.mass[0]):
        found.append(f"{sensed.load_end:.3f} kg on the wrist at the end, {target.mass[0]:.3f} expected at least")
    found += _wrong_thing(plan, evidence, target)
    bearable = maximum_force(target.affordance.fragility)
    if sensed.closing_force_peak > bearable:
        found.append(f"closing peaked at {sensed.closing_force_peak:.0f} N, {bearable:.0f} N is bearable")
    camera = evidence.camera
    if camera is not None:
        if camera.missing:
            found.append(f"{', '.join(camera.missing)} no longer seen")
        if camera.deformed:
            found.append("the object changed its shape")
    if any(item.kind == "content" for item in constraints.active) and sensed.load_end < 0.9 * sensed.load_lifted:
        found.append(f"the load fell from {sensed.load_lifted:.3f} to {sensed.load_end:.3f} kg: contents were lost")
    return tuple(found)


def _wrong_thing(plan: Plan, evidence: Evidence, target: PerceivedObject) -> list[str]:
    """Something is held, but is it the target?"""
    sensed = evidence.sensing
    found: list[str] = []
    width_off = abs(sensed.aperture_closed - plan.local_width)
    heavy = sensed.load_end > 1.8 * target.mass[1]
    light = sensed.load_end < 0.5 * target.mass[0]
    if width_off > WIDTH_SURPRISE and (heavy or light):
        found.append(
            f"fingers rest at {1000 * sensed.aperture_closed:.0f} mm where {1000 * plan.local_width:.0f} mm were "
            f"expected, with {sensed.load_end:.3f} kg"
        )
    camera = evidence.camera
    if camera is not None and camera.target_visible and camera.target_moved < 0.02 and not camera.target_in_hand:
        found.append("the target still stands where it stood")
    return found
