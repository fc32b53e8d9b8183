"""The seven-factor grasp quality Q(g, o) = sum_k w_k phi_k(g, o) of Eq. (2), and what each low factor means.

The paper prints the weights and one threshold; the formulas are the choices of the ledger (G15 to G17). Planning grades a
grasp with estimated properties of the object, the analytic evaluator with the true ones: the formulas are the same.
Nothing here knows MuJoCo, scenes or perception.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from kb.grasp import MAX_FORCE, Grasp, Quality
from kb.vocabulary import AffordanceType, FailureType, GraspType, Material

WEIGHTS = (0.20, 0.15, 0.10, 0.15, 0.15, 0.10, 0.15)
"""w_1 to w_7 of Sec. IV-D."""
THRESHOLDS = (0.4, 0.4, 0.4, 0.4, 0.4, 0.0, 0.4)
"""theta_1 to theta_7: only theta_2 is printed; difficulty (6) is no fault of the grasp, so it never fails (ledger G15)."""
MIN_QUALITY = 0.60
"""Q below which a grasp fails although every factor passes (ledger G16)."""

REACH_ERROR = 0.04
"""Distance from the affordance region at which phi_1 is 0 [m] (ledger G15)."""
WIDEST_OBJECT = 0.078
"""Widest thing that still fits into the open hand [m] (ledger G15)."""
FIT_ALLOWANCE = 0.002
"""The hand must open at least this much wider than the object [m] (ledger G15)."""
BEST_ALLOWANCE = 0.010
"""Opening beyond the object's width that is rated best [m] (ledger G15)."""
WIDTH_SCALE = 0.05
"""Deviation from the best opening at which phi_2 is 0 [m] (ledger G15)."""
FULL_CLEARANCE = 0.02
"""Clearance from which phi_5 is 1 [m] (ledger G15)."""
GRAVITY = 9.81
LIFT_ACCELERATION = 1.0
"""Upward acceleration the grip must bear beyond gravity [m/s2] (ledger G15)."""
SAFETY = 1.5
"""Factor between the force that just holds and f_min (ledger G15)."""
GENTLEST_LIMIT = 5.0
"""f_max never falls below this [N] (ledger G15)."""

COMPLIANT: frozenset[Material] = frozenset({"organic", "fabric", "paper", "foam"})
"""Materials that give way: too much force deforms them instead of breaking them (ledger G17)."""

TYPE_MATCH: dict[AffordanceType, dict[GraspType, float]] = {
    "GRASPABLE_BODY": {"power": 1.0, "pinch": 0.5, "side": 0.8},
    "GRASPABLE_HANDLE": {"power": 0.3, "pinch": 1.0, "side": 0.9},
    "GRASPABLE_EDGE": {"power": 0.1, "pinch": 1.0, "side": 0.5},
    "PINCHABLE": {"power": 0.2, "pinch": 1.0, "side": 0.5},
    "WRAPPABLE": {"power": 1.0, "pinch": 0.7, "side": 0.5},
    "FRAGILE": {"power": 0.3, "pinch": 0.8, "side": 1.0},
    "TOOL_HANDLE": {"power": 0.7, "pinch": 0.5, "side": 1.0},
    "CLAMPABLE": {"power": 0.3, "pinch": 1.0, "side": 0.6},
}
"""phi_4 by affordance type and grasp type (ledger G15)."""


@dataclass(frozen=True)
class Subject:
    """What is graded besides the grasp: properties of the object and of this grasp's place on it, estimated or true."""

    region_distance: float
    """e_p: distance from the grasp's position to the nearest graspable point of the affordance region [m]."""
    width: float
    """w_o: local width of the object along the closing axis [m]."""
    mass: float
    """[kg]."""
    friction: float
    """Sliding friction coefficient between finger pad and object."""
    fragility: float
    """0 durable to 1 breaks at a touch."""
    affordance: AffordanceType
    clearance: float
    """d_min: smallest distance of the swept hand to the table (1 mm allowed), neighbours and occluders [m]."""


@dataclass(frozen=True)
class Circumstances:
    """Facts of an attempt that no factor carries and that the decision list of ledger G17 asks for."""

    reachable: bool = True
    correct_object: bool = True
    """The object between the fingers is the one that was meant."""
    timed_out: bool = False
    blocked_by: Literal["object", "table"] = "table"
    """What is nearest to the swept hand: another object (neighbour, occluder) or the table and the arm itself."""
    normal_outside_cone: bool = False
    """The closing axis meets the surface outside the friction cone."""
    material: Material = "mixed"
    constraint_violated: bool = False


def holding_force(mass: float, friction: float) -> float:
    """Force per finger at which two pads just bear the object's weight while it is lifted [N]."""
    return mass * (GRAVITY + LIFT_ACCELERATION) / (2.0 * friction)


def minimum_force(mass: float, friction: float) -> float:
    """f_min: smallest force rated safe against slipping [N] (ledger G15); also the floor of the force cut (G9)."""
    return SAFETY * holding_force(mass, friction)


def maximum_force(fragility: float) -> float:
    """f_max: largest force rated safe for the object [N] (ledger G15)."""
    return max(GENTLEST_LIMIT, MAX_FORCE * (1.0 - fragility))


def grade(grasp: Grasp, subject: Subject) -> Quality:
    """Grades a grasp: the seven factors, each in [0, 1], and their weighted sum (Eq. (2))."""
    q, phi = grade_numbers(grasp.aperture, grasp.force, grasp.type, subject)
    return Quality(q=q, phi=phi)


def grade_numbers(
    aperture: float, force: float, type_: GraspType, subject: Subject
) -> tuple[float, tuple[float, float, float, float, float, float, float]]:
    """Q and the seven factors of a grasp with this opening [m], force [N] and type."""
    load = Load.of(subject.mass, subject.friction, subject.fragility, subject.affordance)
    return load.grade(aperture, force, type_, subject.region_distance, subject.width, subject.clearance)


@dataclass(frozen=True)
class Load:
    """What all grasps of one object have in common in Eq. (2)."""

    holding: float
    """`holding_force` [N]."""
    least: float
    """`minimum_force` [N]."""
    most: float
    """`maximum_force` [N]."""
    match: Mapping[GraspType, float]
    """phi_4 by type."""
    fragile: float
    """Fragility's share of the difficulty."""
    heavy: float
    """The mass's share of the difficulty."""

    @classmethod
    def of(cls, mass: float, friction: float, fragility: float, affordance: AffordanceType) -> Load:
        """The load that an object of this mass [kg], friction, fragility and affordance is."""
        holding = holding_force(mass, friction)
        return cls(
            holding,
            SAFETY * holding,
            maximum_force(fragility),
            TYPE_MATCH[affordance],
            0.5 * fragility,
            0.2 * min(1.0, mass / 1.0),
        )

    def grade(
        self, aperture: float, force: float, type_: GraspType, region_distance: float, width: float, clearance: float
    ) -> tuple[float, tuple[float, float, float, float, float, float, float]]:
        """Q and the seven factors of a grasp; in plain numbers, because planning grades every candidate.

        Args:
            aperture: Opening before closing [m].
            force: Per finger [N].
            type_: Of the grasp.
            region_distance: e_p [m].
            width: w_o [m].
            clearance: d_min [m].
        """
        low = (force - 0.5 * self.least) / (0.5 * self.least)
        high = (1.5 * self.most - force) / (0.5 * self.most)
        phi = (
            _clip(1.0 - region_distance / REACH_ERROR),
            width_factor(aperture, width),
            # 1 between f_min and f_max, linear to 0 at half f_min and at one and a half f_max.
            _clip(low if low < high else high),
            self.match[type_],
            _clip(clearance / FULL_CLEARANCE),
            # 1 minus the difficulty: fragile, wide and heavy things are hard.
            _clip(1.0 - (self.fragile + 0.3 * min(1.0, width / 0.08) + self.heavy)),
            _clip(force / self.holding - 1.0),
        )
        a, b, c, d, e, f, g = WEIGHTS
        # Eq. (2). The sum of the weights is 1 only up to rounding, hence the clip.
        total = a * phi[0] + b * phi[1] + c * phi[2] + d * phi[3] + e * phi[4] + f * phi[5] + g * phi[6]
        return _clip(total), phi


def width_factor(aperture: float, width: float) -> float:
    """phi_2: 0 where the object cannot pass between the fingers, else 1 minus the deviation from the best opening."""
    if width > WIDEST_OBJECT or aperture < width + FIT_ALLOWANCE:
        return 0.0
    return _clip(1.0 - abs(aperture - (width + BEST_ALLOWANCE)) / WIDTH_SCALE)


def passes(quality: Quality) -> bool:
    """Whether every factor reaches its threshold and Q its minimum (ledger G16)."""
    enough = all(value >= theta for value, theta in zip(quality.phi, THRESHOLDS, strict=True))
    return enough and quality.q >= MIN_QUALITY


def failure_of(quality: Quality, grasp: Grasp, subject: Subject, facts: Circumstances) -> FailureType | None:
    """The failure type of an attempt by the decision list of ledger G17, first match wins; None for a success."""
    if not facts.reachable:
        return "UNREACHABLE_POSE"
    if not facts.correct_object:
        return "WRONG_OBJECT"
    if facts.timed_out:
        return "TIMEOUT"
    low = [value < theta for value, theta in zip(quality.phi, THRESHOLDS, strict=True)]
    if low[4]:
        return "COLLISION" if facts.blocked_by == "object" else "APPROACH_ANGLE"
    if low[0]:
        return "POSITION_ERROR"
    if low[1]:
        return "WIDTH_MISMATCH"
    if low[3] or facts.normal_outside_cone:
        return "ORIENTATION"
    if low[2] and _high_side(grasp.force, subject) <= _low_side(grasp.force, subject):
        return "DEFORMATION" if facts.material in COMPLIANT else "FORCE_DAMAGE"
    if low[2] or low[6]:
        # Below the holding force friction cannot carry the weight and the object falls; above it, it creeps.
        return "DROP" if grasp.force < holding_force(subject.mass, subject.friction) else "SLIP"
    if facts.constraint_violated:
        return "CONSTRAINT_VIOLATION"
    return None if passes(quality) else "UNKNOWN"


def _low_side(force: float, subject: Subject) -> float:
    least = minimum_force(subject.mass, subject.friction)
    return _clip((force - 0.5 * least) / (0.5 * least))


def _high_side(force: float, subject: Subject) -> float:
    most = maximum_force(subject.fragility)
    return _clip((1.5 * most - force) / (0.5 * most))


def _clip(value: float) -> float:
    return 0.0 if value < 0.0 else 1.0 if value > 1.0 else value
