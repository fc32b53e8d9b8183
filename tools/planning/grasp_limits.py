"""The limits that a grasp must keep whoever chose it: workspace, target, opening, force, fragility, stand-off and speed.

Pure functions of what was planned and perceived. They bound what a language model (or any other outsider) may change of
a planned grasp; they say nothing about where a good grasp is.
"""

from __future__ import annotations

import math

from kb.grasp import MAX_APERTURE, MAX_FORCE, MIN_FORCE, Grasp
from kb.percept import PerceivedObject
from sim.placement import REACH, TABLE_LOWER, TABLE_UPPER
from sim.quality import FIT_ALLOWANCE, maximum_force, minimum_force
from tools.planning.force_choice import CLOSING_PEAK, DAMAGE_SPREAD

FORCE_SHARE = (0.8, 1.3)
"""Force that may be chosen as a share of the planned one: around the paper's own corrections of 0.8 to 1.2 (Sec. IV-B)."""
CEILING = 0.60
"""Highest tool point of a grasp [m]: the tallest thing is 0.25 m, stacked on another one it stays below this."""
BESIDE_TARGET = 0.02
"""How far the tool point may lie outside the perceived box of its target [m]: four times the error of position."""
STANDOFF = (0.05, 0.20)
"""Stand-off that may be chosen [m]; shorter ones leave no room to see a collision coming."""
SLOWEST = 0.1
"""Smallest velocity scale (`kb.grasp.Grasp`)."""
EPSILON = 1e-9


def force_bounds(planned: float, target: PerceivedObject) -> tuple[float, float]:
    """Forces that may be chosen instead of the planned one [N].

    The upper bound is what the weakest specimen bears with the closing peak, the lower one what holds the heaviest
    plausible mass at the lowest plausible friction (what falls may break). Where the plan itself is beyond a bound, it
    is the bound: a choice may never go further that way.
    """
    low, high = FORCE_SHARE[0] * planned, FORCE_SHARE[1] * planned
    bears = CLOSING_PEAK * DAMAGE_SPREAD * maximum_force(target.affordance.fragility)
    holds = minimum_force(target.mass[1], target.friction[0])
    return max(MIN_FORCE, min(planned, max(low, holds))), min(MAX_FORCE, max(planned, min(high, bears)))


def refuse_grasp(grasp: Grasp, planned: Grasp, target: PerceivedObject, width: float) -> str | None:
    """Why the grasp must not be executed, or None.

    Args:
        grasp: The grasp as chosen.
        planned: The grasp that it changes: the plan's own, or one of its alternatives.
        target: The target as perceived.
        width: Local width between the pads [m].
    """
    numbers = (*grasp.position, *grasp.approach, grasp.yaw, grasp.aperture, grasp.force, grasp.standoff, grasp.speed)
    if not all(math.isfinite(value) for value in numbers):
        return "a number of the grasp is not finite"
    return _place(grasp, target) or _opening(grasp, width) or _force(grasp, planned, target) or _motion(grasp, planned)


def _place(grasp: Grasp, target: PerceivedObject) -> str | None:
    x, y, z = grasp.position
    on_table = TABLE_LOWER[0] <= x <= TABLE_UPPER[0] and TABLE_LOWER[1] <= y <= TABLE_UPPER[1]
    if not on_table or not 0.0 <= z <= CEILING:
        return f"({x:.2f}, {y:.2f}, {z:.2f}) m is outside the workspace"
    if math.hypot(x, y) > REACH:
        return f"({x:.2f}, {y:.2f}) m is {math.hypot(x, y):.2f} m away, and the arm reaches {REACH:.2f} m"
    if abs(math.hypot(*grasp.approach) - 1.0) > 1e-3:
        return "the approach is no unit vector"
    if grasp.approach[2] > 0.35:
        return "the hand cannot arrive from below"
    off = outside(grasp, target)
    if off > BESIDE_TARGET:
        return f"the grasp is {off * 1000:.0f} mm beside {target.id}"
    return None


def outside(grasp: Grasp, target: PerceivedObject) -> float:
    """Distance of the tool point from the target's perceived box [m]; 0 inside."""
    dx, dy, dz = (a - b for a, b in zip(grasp.position, target.position, strict=True))
    cosine, sine = math.cos(target.yaw), math.sin(target.yaw)
    local = (cosine * dx + sine * dy, cosine * dy - sine * dx, dz)
    return math.hypot(*(max(0.0, abs(d) - side / 2) for d, side in zip(local, target.size, strict=True)))


def _opening(grasp: Grasp, width: float) -> str | None:
    if grasp.aperture > MAX_APERTURE + EPSILON:
        return f"the hand opens to {MAX_APERTURE * 1000:.0f} mm at most"
    if grasp.aperture < min(MAX_APERTURE, width + FIT_ALLOWANCE) - EPSILON:
        return f"{grasp.aperture * 1000:.0f} mm is too narrow for the {width * 1000:.0f} mm between the fingers"
    return None


def _force(grasp: Grasp, planned: Grasp, target: PerceivedObject) -> str | None:
    low, high = force_bounds(planned.force, target)
    if grasp.force > high + EPSILON:
        fragile = f"fragility {target.affordance.fragility:.1f} and the planned {planned.force:.1f} N"
        return f"{grasp.force:.1f} N is too strong: {fragile} allow at most {high:.1f} N"
    if grasp.force < low - EPSILON:
        return f"{grasp.force:.1f} N is too weak: the planned {planned.force:.1f} N allow no less than {low:.1f} N"
    return None


def _motion(grasp: Grasp, planned: Grasp) -> str | None:
    # What a constraint or the experience asked for is a lower bound of the distance and an upper bound of the speed.
    least = min(planned.standoff, STANDOFF[0])
    if not least - EPSILON <= grasp.standoff <= STANDOFF[1] + EPSILON:
        return f"a stand-off of {grasp.standoff * 1000:.0f} mm is outside {STANDOFF[0] * 1000:.0f} to 200 mm"
    if grasp.speed > planned.speed + EPSILON:
        return f"speed {grasp.speed:.2f} is faster than the planned {planned.speed:.2f}"
    if grasp.speed < SLOWEST - EPSILON:
        return f"speed {grasp.speed:.2f} is slower than {SLOWEST:g}"
    return None
