"""The robot: it looks, grasps, carries, sets down and goes home, and reports what its own sensors felt.

It never reads the truth ("truth/..." sensors, object poses). Every motion drives the arm through simulated time; nothing
teleports.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kb.base import Vec3
from kb.errors import BadInputError
from kb.grasp import Grasp
from kb.rgbd import RgbdView
from kb.sensing import Sensing
from sim.controller import hold
from sim.grasp_motion import CREEPING, approach, arrive, close, hold_and_shake, lift_up, plan
from sim.hand import FULL_LIFT
from sim.kinematics import forward
from sim.lower_motion import lower_here
from sim.motion import Obstacle
from sim.motion_run import HaltedError, MotionRun, is_holding
from sim.place_motion import carry_above, home, let_go, place_pose, travel
from sim.stop import StopSwitch
from sim.world import World

Array = NDArray[np.float64]

FORCE_LIMIT = 30.0
"""Wrist force that aborts an approach [N] (benchmark section 3)."""
OFFER = np.array([0.0, -0.35, 0.0, -2.2, 0.0, 1.95, math.pi / 4])
"""Where something is held out to a person [rad]: tool about 0.5 m in front, 0.4 m up."""


class Robot:
    """Sensing and acting on one world."""

    has_arm = True
    """Its arm takes up room and has to get to where the hand goes."""

    def __init__(self, world: World, *, stop: StopSwitch | None = None) -> None:
        self.world = world
        self.stop = stop if stop is not None else StopSwitch()

    # State from its own sensors ---------------------------------------------------------------------------------

    @property
    def joints(self) -> Array:
        """Joint angles from the encoders [rad], shape (7,)."""
        return self.world.read("robot/joint_position")

    @property
    def aperture(self) -> float:
        """Opening of the fingers [m]."""
        return float(self.world.read("robot/opening")[0])

    @property
    def grip_force(self) -> float:
        """Closing force of the finger motor [N]."""
        return -float(self.world.read("robot/grip_force")[0])

    @property
    def holding(self) -> bool:
        """The hand was told to close, presses, and something keeps the fingers apart."""
        return is_holding(self.world)

    @property
    def tool_point(self) -> Vec3:
        """Point between the finger pads by forward kinematics of the encoders' angles [m]."""
        x, y, z = (float(value) for value in forward(self.joints)[:3, 3])
        return x, y, z

    @property
    def bin(self) -> tuple[Vec3, Vec3] | None:
        """Lower and upper corner of the inside of the bin [m], known from the set-up."""
        return self.world.placed.bin

    def look(self, rng: np.random.Generator, names: Sequence[str] = ("front", "top")) -> tuple[RgbdView, ...]:
        """Pictures by the named cameras."""
        return self.world.capture(rng, names)

    # Motions ----------------------------------------------------------------------------------------------------

    def grasp(
        self,
        grasp: Grasp,
        *,
        joints: Sequence[float] | None = None,
        obstacles: Sequence[Obstacle] = (),
        shake: bool = True,
        force_limit: float = FORCE_LIMIT,
        lift: float = FULL_LIFT,
        most_force: float | None = None,
        creep: float = 0.0,
        creep_speed: float = CREEPING,
    ) -> Sensing:
        """Moves to the grasp, closes, lifts, holds and shakes; a success ends holding the object in the air.

        Args:
            grasp: What to do; its force becomes the motor's force range.
            joints: Joint angles at the grasp (7,), if the plan has chosen them.
            obstacles: Perceived boxes that the arm keeps away from on its free way; may include the target.
            shake: Whether to shake after holding.
            force_limit: Wrist force that aborts the approach [N]; lower for fragile targets.
            lift: Height of the lift [m], at least 5 cm; up to 4 cm less where the arm cannot do more.
            most_force: If given, the first two centimetres are a test lift, and what slips is gripped harder, up to
                this force per finger [N].
            creep: Last stretch of the approach [m] that is gone slowly, because the hand may land on the thing.
            creep_speed: Speed of that stretch [m/s].

        Raises:
            BadInputError: the hand already holds something.
        """
        if self.holding:
            raise BadInputError("the hand already holds something; place or release it first", where="grasp")
        motion = MotionRun(self.world, self.stop)
        motion.note(aperture_commanded=grasp.aperture)
        try:
            reach, transit = plan(motion, grasp, joints, obstacles, lift)
            arrive(motion, grasp, transit, force_limit)
            approach(motion, grasp, reach, force_limit, creep, creep_speed)
            close(motion, grasp, reach)
            if lift_up(motion, grasp, reach, most_force):
                hold_and_shake(motion, reach, shake)
        except HaltedError as halted:
            motion.note(stopped_by=halted.cause)
        return motion.sensing()

    def place(
        self,
        position: Vec3,
        *,
        approach: Vec3 | None = None,
        yaw: float | None = None,
        obstacles: Sequence[Obstacle] = (),
        speed: float = 1.0,
        then_home: bool = True,
        left_behind: Obstacle | None = None,
        load: Sequence[Vec3] = (),
    ) -> Sensing:
        """Carries what is held above `position`, lowers it until contact is felt, lets go, retreats and goes home.

        Args:
            position: Tool point at set-down [m].
            approach: Direction of the hand at set-down; as it is now, if left out (then the object stays as upright).
            yaw: Azimuth of the closing axis at set-down [rad]; as it is now, if left out.
            obstacles: Perceived boxes to keep away from.
            speed: Velocity scale in (0, 1].
            then_home: Whether to drive home afterwards.
            left_behind: Box of what is set down where it will stand: the way home keeps clear of it.
            load: Points of what is held in the hand frame [m], for a way on which it touches nothing.
        """
        motion = MotionRun(self.world, self.stop)
        try:
            target = place_pose(motion, position, approach, yaw)
            way = carry_above(motion, target, obstacles, speed, np.asarray(load, float).reshape(-1, 3))
            if way is not None:
                let_go(motion, way)
            if then_home:
                home(motion, obstacles if left_behind is None else (*obstacles, left_behind), way)
        except HaltedError as halted:
            motion.note(stopped_by=halted.cause)
        return motion.sensing()

    def release_and_home(self, obstacles: Sequence[Obstacle] = ()) -> Sensing:
        """Sets down what is held where it is, gently, opens, retreats and drives home."""
        motion = MotionRun(self.world, self.stop)
        try:
            if self.holding:
                lower_here(motion)
            let_go(motion)
            home(motion, obstacles)
        except HaltedError as halted:
            motion.note(stopped_by=halted.cause)
        return motion.sensing()

    def go_home(self, obstacles: Sequence[Obstacle] = ()) -> Sensing:
        """Drives home, still holding what is held."""
        motion = MotionRun(self.world, self.stop)
        try:
            home(motion, obstacles)
        except HaltedError as halted:
            motion.note(stopped_by=halted.cause)
        return motion.sensing()

    def handover(self, obstacles: Sequence[Obstacle] = (), *, load: Sequence[Vec3] = ()) -> Sensing:
        """Holds out what is held towards a person and keeps holding it.

        Args:
            obstacles: Perceived boxes to keep away from.
            load: Points of what is held in the hand frame [m], for a way on which it touches nothing.
        """
        motion = MotionRun(self.world, self.stop)
        try:
            travel(motion, OFFER, obstacles, "carry", 0.6, np.asarray(load, float).reshape(-1, 3))
            motion.carry(motion.run(hold(OFFER, motion.grip, 0.3), "hold"))
        except HaltedError as halted:
            motion.note(stopped_by=halted.cause)
        return motion.sensing()
