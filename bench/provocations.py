"""Prescribed ways to make a grasp fail, so that the robot's diagnosis can be compared with what was observed.

Each bends a good plan in one respect. What it then leads to is physics' business: the observer's label counts, not ours.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.attempt_once import Bend
from kb.grasp import MAX_FORCE, Grasp
from kb.percept import PerceivedObject, Percept
from kb.sensing import Plan
from kb.vocabulary import FailureType
from sim.quality import holding_force, maximum_force
from tools.planning.candidate import horizontal, leaning, vec3, wrap


@dataclass(frozen=True)
class Provocation:
    """What is bent, where, and which failure it is meant to provoke."""

    name: str
    meant: FailureType
    scenes: tuple[str, ...]
    bend: Bend


def _with(plan: Plan, **changes: object) -> Plan:
    """The plan with another grasp; stored joint angles no longer fit."""
    grasp = Grasp.model_validate(plan.grasp.model_dump() | changes)
    return plan.model_copy(update={"grasp": grasp, "joints": ()})


def _moved(plan: Plan, shift: NDArray[np.float64]) -> Plan:
    return _with(plan, position=vec3(np.asarray(plan.grasp.position) + shift))


def beside(plan: Plan, percept: Percept, target: PerceivedObject, rng: np.random.Generator) -> Plan:
    """Closes beside the object: shifted across the closing axis by more than object and finger."""
    axis = plan.grasp.closing_axis()
    across = np.array([-axis[1], axis[0], 0.0]) / math.hypot(axis[0], axis[1])
    reach = 0.5 * max(target.size[:2]) + rng.uniform(0.020, 0.040)
    return _moved(plan, across * reach * rng.choice([-1.0, 1.0]))


def above(plan: Plan, percept: Percept, target: PerceivedObject, rng: np.random.Generator) -> Plan:
    """Closes above the object."""
    return _moved(plan, np.array([0.0, 0.0, target.top_z - plan.grasp.position[2] + rng.uniform(0.015, 0.03)]))


def out_of_reach(plan: Plan, percept: Percept, target: PerceivedObject, rng: np.random.Generator) -> Plan:
    """Half a metre farther than the object stands."""
    away = horizontal(math.atan2(target.position[1], target.position[0]))
    return _moved(plan, away * rng.uniform(0.45, 0.6))


def into_the_table(plan: Plan, percept: Percept, target: PerceivedObject, rng: np.random.Generator) -> Plan | None:
    """Aims lower than the table."""
    if plan.grasp.approach[2] > -0.6:
        return None
    low = plan.grasp.position[2] + 0.0088 * plan.grasp.approach[2]
    return _moved(plan, np.array([0.0, 0.0, -low - rng.uniform(0.008, 0.016)]))


def hardly_open(plan: Plan, percept: Percept, target: PerceivedObject, rng: np.random.Generator) -> Plan | None:
    """Opens less than the object is wide."""
    if plan.local_width < 0.02:
        return None
    return _with(plan, aperture=max(0.004, plan.local_width - rng.uniform(0.004, 0.012)))


def towards_the_neighbour(
    plan: Plan, percept: Percept, target: PerceivedObject, rng: np.random.Generator
) -> Plan | None:
    """Turns the hand's width towards the nearest neighbour and leans over it."""
    others = [other for other in percept.objects if other.id != target.id]
    if not others:
        return None
    near = min(others, key=lambda other: math.dist(other.position[:2], target.position[:2]))
    bearing = math.atan2(near.position[1] - target.position[1], near.position[0] - target.position[0])
    # Coming from over there, half way between the two.
    shift = horizontal(bearing) * rng.uniform(0.02, 0.05)
    low = max(0.02, min(plan.grasp.position[2], near.top_z - 0.02))
    x, y = target.position[0] + shift[0], target.position[1] + shift[1]
    return _with(
        plan,
        position=(x, y, low),
        approach=leaning(bearing + math.pi, math.radians(15)),
        yaw=wrap(bearing),
        aperture=0.08,
        type="power",
    )


def askew(plan: Plan, percept: Percept, target: PerceivedObject, rng: np.random.Generator) -> Plan | None:
    """Turns the closing axis far off the narrow side."""
    if target.size[0] < 1.3 * target.size[1]:
        return None
    turn = math.radians(rng.uniform(40.0, 80.0)) * rng.choice([-1.0, 1.0])
    return _with(plan, yaw=wrap(plan.grasp.yaw + turn))


def too_weak(low: float, high: float) -> Bend:
    """Closes with a share of the force that just holds."""

    def bend(plan: Plan, percept: Percept, target: PerceivedObject, rng: np.random.Generator) -> Plan:
        hold = holding_force(sum(target.mass) / 2, sum(target.friction) / 2)
        return _with(plan, force=max(1.0, hold * rng.uniform(low, high)))

    return bend


def too_strong(plan: Plan, percept: Percept, target: PerceivedObject, rng: np.random.Generator) -> Plan | None:
    """Closes with more than the object bears."""
    force = maximum_force(target.affordance.fragility) * rng.uniform(1.3, 1.42)
    return None if force > MAX_FORCE else _with(plan, force=force)


def crushed(plan: Plan, percept: Percept, target: PerceivedObject, rng: np.random.Generator) -> Plan:
    """Closes with all the hand can give."""
    return _with(plan, force=rng.uniform(66.0, 70.0))


def the_other_one(plan: Plan, percept: Percept, target: PerceivedObject, rng: np.random.Generator) -> Plan | None:
    """Grasps what stands beside the target as if it were the target, twins included: a false claim is one, however alike things are."""
    others = [other for other in percept.objects if other.id != target.id and min(other.size[:2]) < 0.074]
    if not others:
        return None
    near = min(others, key=lambda other: (abs(other.size[1] - target.size[1]), other.id))
    height = max(0.0115, near.top_z - 0.022)
    yaw = wrap(near.yaw + math.pi / 2)
    position = (near.position[0], near.position[1], height)
    return _with(plan, position=position, approach=(0.0, 0.0, -1.0), yaw=yaw, aperture=0.08, type="power", force=15.0)


def off_centre(plan: Plan, percept: Percept, target: PerceivedObject, rng: np.random.Generator) -> Plan | None:
    """Grips a long thing near its end with little force: it is lifted, turns, and is lost."""
    if target.size[0] < 0.10 or target.size[2] > 0.06:
        return None
    along = horizontal(target.yaw) * target.size[0] * rng.uniform(0.25, 0.36) * rng.choice([-1.0, 1.0])
    hold = holding_force(sum(target.mass) / 2, sum(target.friction) / 2)
    position = np.asarray(target.position) + along
    position[2] = plan.grasp.position[2]
    return _with(plan, position=vec3(position), force=max(1.0, hold * rng.uniform(1.15, 1.7)))


SOLO = ("single_cube", "single_bottle", "single_banana", "single_bowl", "single_apple", "single_cup")
LONG = ("single_banana", "screwdriver_side_grasp", "phone_near_wine_glass")

PROVOCATIONS: tuple[Provocation, ...] = (
    Provocation("beside it", "POSITION_ERROR", SOLO, beside),
    Provocation("above it", "POSITION_ERROR", ("single_cube", "single_apple", "single_banana"), above),
    Provocation("out of reach", "UNREACHABLE_POSE", SOLO, out_of_reach),
    Provocation("into the table", "APPROACH_ANGLE", ("single_cube", "single_banana", *LONG[1:]), into_the_table),
    Provocation("hardly open", "WIDTH_MISMATCH", ("single_cube", "single_bottle", "ball_behind_box"), hardly_open),
    Provocation(
        "towards the neighbour",
        "COLLISION",
        ("cup_near_vase", "ball_behind_box", "phone_near_wine_glass"),
        towards_the_neighbour,
    ),
    Provocation("askew", "ORIENTATION", LONG, askew),
    Provocation("far too weak", "SLIP", SOLO, too_weak(0.15, 0.5)),
    Provocation("a little too weak", "DROP", SOLO, too_weak(0.7, 1.05)),
    Provocation("off its centre", "DROP", LONG, off_centre),
    Provocation("too strong", "FORCE_DAMAGE", ("single_cup", "single_bowl", "phone_near_wine_glass"), too_strong),
    Provocation("crushed", "DEFORMATION", ("single_apple", "single_banana"), crushed),
    Provocation(
        "the other one",
        "WRONG_OBJECT",
        ("screwdriver_side_grasp", "clear_table", "repeated_categories"),
        the_other_one,
    ),
)
