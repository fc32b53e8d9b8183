"""Whether and how the arm can make a grasp: reach, a free way, links clear of everything, and calm enough for the shake."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kb.grasp import Grasp
from kb.percept import PerceivedObject
from sim.grasp_motion import DEEPEST, is_around
from sim.motion import Obstacle, clearances, plan_transit
from sim.reach import Reach, Unreachable, solve_reaches
from sim.shake import ANGLE, KNOTS, rocked_configurations
from tools.planning.arm_clearance import arm_clearance
from tools.planning.candidate import Array
from tools.planning.lift_height import lift_height

ARM_CLEARANCE = 0.004
"""Distance that the arm's links keep from everything perceived [m]."""
OPTIONS = 3
"""Arm postures looked at for one grasp."""
CALM = 0.85
"""Largest swing of a joint while the wrist turns by +-15 degrees [rad]; beyond it the arm is near a singularity, and what
it holds is thrown about (measured: a screwdriver is lost from 0.98 rad on at any force, most postures need 0.3 to 0.7)."""

FOLDED = -2.75
"""Fourth joint angle below which the elbow is so folded that the forearm may meet the shoulder on the way [rad]
(measured: contact at -2.90)."""

Posture = tuple[float, ...]


@dataclass(frozen=True)
class ArmWay:
    """The arm as it stands, and what it must not touch."""

    start: Array
    """Joint angles now [rad], shape (7,)."""
    points_w: Array
    """Points of everything but the target, shape (N, 3) [m]."""
    boxes: tuple[Obstacle, ...]
    """For the free motion to the pre-grasp."""
    others: tuple[PerceivedObject, ...] = ()
    """Everything but the target, over which the hand is lifted."""
    has_arm: bool = True
    """Whether the links take up room; without, reach alone decides."""

    def posture(self, grasp: Grasp, *, whole: bool, calm: bool) -> Posture | None:
        """Joint angles at the grasp, or None.

        Args:
            grasp: The grasp.
            whole: Check the whole motion; otherwise reach alone (alternatives that are only shown).
            calm: Refuse postures in which turning the wrist swings the arm about.
        """
        lift = lift_height(grasp.position, self.others)
        whole = whole and self.has_arm
        found = solve_reaches(grasp, self.start, lift=lift, options=OPTIONS if whole else 1)
        if isinstance(found, Unreachable):
            return None
        for reach in found:
            if not whole or self._free(grasp, reach, calm):
                return tuple(float(q) for q in reach.joints)
        return None

    def _free(self, grasp: Grasp, reach: Reach, calm: bool) -> bool:
        if calm and not is_calm(reach):
            return False
        if not self._outside(grasp, reach):
            return False
        if len(self.points_w) and arm_clearance(reach, self.points_w) < ARM_CLEARANCE:
            return False
        return plan_transit(self.start, reach.pregrasp, self.boxes) is not None

    def _outside(self, grasp: Grasp, reach: Reach) -> bool:
        """Whether the approach keeps off the bin and begins outside everything but the target."""
        seen = self.boxes[: len(self.others) + 1]
        setting = self.boxes[len(seen) :]
        if setting and float(clearances(reach.approach[::4], setting)[:, 1:].min()) < 0.0:
            return False
        beside = [box for box in seen if not is_around(box, grasp)]
        return float(clearances(reach.pregrasp[None], beside).min()) > -DEEPEST


def is_calm(reach: Reach) -> bool:
    """Whether the elbow stays open and the shake at the top of the lift moves no joint by more than `CALM`."""
    if min(float(reach.approach[:, 3].min()), float(reach.lift[:, 3].min())) < FOLDED:
        return False
    rocked = rocked_configurations(reach.lift[-1], np.linspace(-ANGLE, ANGLE, KNOTS))
    return rocked is None or float(np.ptp(rocked, axis=0).max()) <= CALM
