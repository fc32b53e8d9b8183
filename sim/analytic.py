"""The robot of the analytic evaluator: the interface of `sim.robot.Robot`, with outcomes from the seven factors.

Nothing is simulated: things are put where a perfect execution of the outcome would leave them, and the sensing is what a
robot would have felt. Results of this evaluator are labelled `analytic` wherever they are shown.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import mujoco
import numpy as np

from kb.base import Vec3
from kb.errors import BadInputError
from kb.grasp import MAX_APERTURE, Grasp, closing_axis
from kb.sensing import Sensing
from kb.vocabulary import FailureType
from sim.analytic_outcome import Outcome, evaluate
from sim.hand import FULL_LIFT, approach_time
from sim.kinematics import forward
from sim.motion import Obstacle
from sim.panda import READY
from sim.pose import Array
from sim.reach import Unreachable, solve_reach
from sim.robot import FORCE_LIMIT, OFFER, Robot

HELD = "analytic/held/"
"""Prefix of the note in the world that says what is in the hand; it survives snapshots."""
HOLD_AND_SHAKE = 4.0
"""Simulated time of holding and shaking [s]."""
TRANSIT = 2.0
"""Simulated time of a free motion [s]."""
ON_SOMETHING = 0.02
"""What is let go lower than this above the table stands on the table, higher on another object [m]."""
GRIPS: tuple[FailureType | None, ...] = (None, "FORCE_DAMAGE", "DEFORMATION", "CONSTRAINT_VIOLATION")
"""Outcomes after which the object is in the hand."""


class AnalyticRobot(Robot):
    """Deterministic given the world; perception alone is noisy."""

    has_arm = False
    """Outcomes follow from the hand alone: only whether the pose is within reach counts, no link can touch anything."""

    @property
    def holding(self) -> bool:
        """Something is in the hand."""
        return self.held is not None

    @property
    def grip_force(self) -> float:
        """Closing force of the finger motor [N]."""
        return float(self.world.notes.get("analytic/force", 0.0)) if self.holding else 0.0

    @property
    def held(self) -> str | None:
        """Scene id of what is in the hand. Not for tools: it is the truth."""
        return next((key[len(HELD) :] for key in self.world.notes if key.startswith(HELD)), None)

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
        creep_speed: float = 0.0,
    ) -> Sensing:
        """As `Robot.grasp`; the outcome follows from the true scene."""
        del joints, obstacles, shake, most_force, creep, creep_speed
        if self.holding:
            raise BadInputError("the hand already holds something; place or release it first", where="grasp")
        self.world.attempt += 1
        if self.stop.pressed:
            return Sensing(stopped_by="stop", phase="plan")
        reach = solve_reach(grasp, self.joints, lift=lift)
        outcome = evaluate(self.world, grasp, reach, self.world.attempt)
        sensing = _felt(outcome, grasp, self._mass(outcome.gripped), force_limit)
        if isinstance(reach, Unreachable):
            self._tell(outcome)
            return sensing.model_copy(update={"ik_residual": float(reach.residual)})
        taken = outcome.gripped is not None and outcome.failure in GRIPS
        self._move(reach.joints, outcome.width if taken else grasp.aperture)
        if taken and outcome.gripped is not None:
            self.world.notes[HELD + outcome.gripped] = 1.0
            self.world.notes["analytic/force"] = grasp.force
        self._move(reach.lift[-1], outcome.width if taken else sensing.aperture_end)
        self._pass(sensing.sim_time)
        self._tell(outcome)
        return sensing

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
        """As `Robot.place`: what is held then stands where the tool point was sent."""
        del obstacles, speed, left_behind, load
        self.world.attempt += 1
        held = self.held
        target = _set_down_pose(forward(self.joints), position, approach, yaw)
        if held is not None:
            self._carry_to(held, target)
            self._let_go()
            self._tell(Outcome(attempt=self.world.attempt, gripped=None, failure=None, placed=held))
        if then_home:
            self._move(READY, MAX_APERTURE)
        self._pass(2 * TRANSIT)
        return Sensing(phase="home" if then_home else "retreat", sim_time=2 * TRANSIT)

    def release_and_home(self, obstacles: Sequence[Obstacle] = ()) -> Sensing:
        """Sets down what is held straight below, and drives home."""
        del obstacles
        self.world.attempt += 1
        held = self.held
        if held is not None:
            self._carry_to(held, forward(self.joints))
            self._let_go()
            self._tell(Outcome(attempt=self.world.attempt, gripped=None, failure=None, placed=held))
        self._move(READY, MAX_APERTURE)
        self._pass(TRANSIT)
        return Sensing(phase="home", sim_time=TRANSIT)

    def go_home(self, obstacles: Sequence[Obstacle] = ()) -> Sensing:
        """Drives home, still holding what is held."""
        del obstacles
        self.world.attempt += 1
        self._move(READY, self.aperture if self.holding else MAX_APERTURE)
        self._pass(TRANSIT)
        return Sensing(phase="home", sim_time=TRANSIT)

    def handover(self, obstacles: Sequence[Obstacle] = (), *, load: Sequence[Vec3] = ()) -> Sensing:
        """Holds out what is held towards a person and keeps holding it."""
        del obstacles, load
        self.world.attempt += 1
        self._move(OFFER, self.aperture)
        self._pass(TRANSIT)
        return Sensing(phase="hold", sim_time=TRANSIT)

    def _mass(self, name: str | None) -> float:
        return next((thing.mass for thing in self.world.placed.objects if thing.id == name), 0.0)

    def _move(self, joints: Array, opening: float) -> None:
        """Puts the arm there at once, with what is in the hand."""
        data, index, held = self.world.data, self.world.index, self.held
        before = forward(self.joints)
        data.qpos[index.arm] = joints
        data.qpos[index.fingers] = opening / 2
        data.ctrl[0 : index.gripper_control : 3] = joints
        data.ctrl[index.gripper_control] = opening
        data.qvel[:] = 0.0
        if held is not None:
            self._follow(held, before, forward(np.asarray(joints, float)))
        self.world.bearings()

    def _follow(self, name: str, before: Array, after: Array) -> None:
        """Moves an object as the hand moves from one pose (4, 4) to another."""
        address = self.world.index.objects[name].qpos
        pose = self.world.data.qpos[address]
        step = after @ np.linalg.inv(before)
        quaternion = np.empty(4)
        mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(step[:3, :3]).ravel())
        turned = np.empty(4)
        mujoco.mju_mulQuat(turned, quaternion, pose[3:])
        self.world.data.qpos[address] = np.concatenate([step[:3, :3] @ pose[:3] + step[:3, 3], turned])

    def _carry_to(self, name: str, target: Array) -> None:
        """Brings the held object to where the tool pose (4, 4) says, then down onto what is below: table or bin."""
        self._follow(name, forward(self.joints), target)
        address, inside = self.world.index.objects[name].qpos, self.world.placed.bin
        pose = self.world.data.qpos[address]
        if inside is not None and all(inside[0][i] < pose[i] < inside[1][i] for i in (0, 1)):
            pose[2] = inside[0][2]
        elif pose[2] < ON_SOMETHING:
            pose[2] = 0.0

    def _let_go(self) -> None:
        for key in [key for key in self.world.notes if key.startswith(HELD)]:
            del self.world.notes[key]

    def _pass(self, seconds: float) -> None:
        self.world.data.time += seconds

    def _tell(self, outcome: Outcome) -> None:
        """Tells the observers, not the caller."""
        for recorder in self.world.recorders:
            told = getattr(recorder, "on_outcome", None)
            if told is not None:
                told(outcome)


def _set_down_pose(pose: Array, position: Vec3, approach: Vec3 | None, yaw: float | None) -> Array:
    """Tool pose (4, 4) of a set-down; what is not given stays as in `pose`."""
    z = pose[:3, 2] if approach is None else np.asarray(approach, float) / np.linalg.norm(approach)
    azimuth = float(np.arctan2(pose[1, 1], pose[0, 1])) if yaw is None else yaw
    y = pose[:3, 1] if approach is None and yaw is None else closing_axis(z, azimuth)
    out = np.eye(4)
    out[:3, :3] = np.column_stack([np.cross(y, z), y, z])
    out[:3, 3] = position
    return out


def _felt(outcome: Outcome, grasp: Grasp, mass: float, force_limit: float) -> Sensing:
    """What a robot would have felt: the reading that belongs to each failure (ledger G17), never the failure itself."""
    arrival = approach_time(grasp.standoff, grasp.speed)
    base = Sensing(
        phase="shake",
        aperture_commanded=grasp.aperture,
        aperture_start=grasp.aperture,
        aperture_closed=outcome.width,
        aperture_lifted=outcome.width,
        aperture_end=outcome.width,
        motor_force_closed=grasp.force,
        motor_force_end=grasp.force,
        closing_force_peak=grasp.force,
        load_lifted=mass,
        load_end=mass,
        load_min=mass,
        lift_height=outcome.height,
        held_s=HOLD_AND_SHAKE,
        sim_time=TRANSIT + 2 * arrival + HOLD_AND_SHAKE,
    )
    nothing = {"load_end": 0.0, "load_min": 0.0, "aperture_end": 0.0}
    bumped = {
        "phase": "approach",
        "stopped_by": "force",
        "abort_force": force_limit,
        "approach_force": force_limit,
        "aperture_closed": grasp.aperture,
        "aperture_lifted": grasp.aperture,
        "aperture_end": grasp.aperture,
        "load_lifted": 0.0,
        "load_end": 0.0,
        "load_min": 0.0,
        "lift_height": 0.0,
        "held_s": 0.0,
        "closing_force_peak": 0.0,
        "sim_time": TRANSIT + arrival,
    }
    missed = {**nothing, "aperture_closed": 0.0, "aperture_lifted": 0.0, "load_lifted": 0.0, "held_s": 0.0}
    changes: dict[FailureType, Mapping[str, object]] = {
        "UNREACHABLE_POSE": {"phase": "plan", "reachable": False, "stopped_by": "unreachable", "sim_time": 0.0},
        "COLLISION": {**bumped, "abort_direction": tuple(-float(v) for v in grasp.approach)},
        "APPROACH_ANGLE": {**bumped, "abort_direction": (0.0, 0.0, 1.0)},
        "WIDTH_MISMATCH": {**bumped, "abort_direction": tuple(-float(v) for v in grasp.approach)},
        "POSITION_ERROR": missed,
        "ORIENTATION": {"aperture_closed": outcome.width + 0.02, **nothing, "load_lifted": 0.0, "held_s": 0.0},
        "SLIP": {"aperture_lifted": max(0.0, outcome.width - 0.004), "aperture_end": max(0.0, outcome.width - 0.008)},
        "DROP": {**nothing, "held_s": 0.5},
        "UNKNOWN": {**nothing, "held_s": 2.0},
    }
    return base if outcome.failure is None else base.model_copy(update=changes.get(outcome.failure, {}))
