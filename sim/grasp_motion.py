"""The phases of a grasp, in order: plan, arrive, approach, close, lift, hold and shake."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kb.grasp import Grasp
from sim.build_model import TIMESTEP
from sim.controller import CLOSED, GRIP_COLUMN, along, along_steadily, follow, hold, holding_command, part
from sim.grip_test import trial_lift
from sim.hand import approach_time
from sim.lower_motion import note_hang
from sim.motion import Obstacle, Transit, clearances, plan_direct, plan_transit
from sim.motion_run import NOTHING, HaltedError, MotionRun
from sim.panda import GRIP_SLEW
from sim.reach import Reach, Unreachable, reach_from, solve_reaches
from sim.recording import Recording
from sim.setting import setting_obstacles
from sim.shake import shake_path
from sim.wrench import largest_force

Array = NDArray[np.float64]

OPENING_FORCE = 20.0
"""Motor force while the hand opens or stands open [N]."""
DEEPEST = 0.02
"""Overlap of the pre-grasp with a perceived box that is still tried [m]: boxes are larger than round or stemmed things."""
OPTIONS, DETOURS = 5, 3
"""Arm configurations compared by their direct way, and by detours if no direct way is free."""
CREEPING, CREEP_RAMP = 0.02, 0.1
"""Speed of a creeping hand [m/s]: a fingertip that lands on a phone presses with 76 to 81 N at full speed, 35 to 38 at
0.04 m/s, 23 to 26 at 0.03 and 16 to 23 at 0.02. And the time in which it gets up to that speed [s]."""
FULL_CLOSING, SLOWEST_CLOSING = 15.0, 0.3
"""Force from which the fingers close at their full speed [N], and the least share of that speed: a finger that lands at
full speed on a stem held with 3.6 N presses with up to 6.1 N for 10 ms."""
REST_STEPS = 30
"""Steps for which fingers must rest and press before the hand counts as closed."""
TEST_LIFT = 0.02
"""Height at which the load is weighed [m]."""
HOLD_S, SHAKE_S = 2.0, 2.0
"""Durations of holding and shaking [s] (benchmark section 3)."""
REST_SPEED = 0.5e-3
"""Opening speed below which the fingers rest [m/s]."""


def plan(
    motion: MotionRun,
    grasp: Grasp,
    joints: Sequence[float] | None,
    obstacles: Sequence[Obstacle],
    lift: float,
) -> tuple[Reach, Transit]:
    """Joint angles for the whole grasp and a free way to its pre-grasp.

    Raises:
        HaltedError: "unreachable" or "path".
    """
    motion.note(phase="plan")
    start = motion.commanded
    boxes = [*obstacles, *setting_obstacles(motion.world.placed.bin), target_zone(grasp)]
    if joints is not None and len(joints) == 7:
        wanted = reach_from(grasp, np.asarray(joints), lift=lift)
        chosen = _quickest(start, (wanted,), boxes, grasp) if isinstance(wanted, Reach) else None
        if chosen is not None:
            motion.note(ik_residual=chosen[0].residual)
            return chosen
    options = solve_reaches(grasp, start, lift=lift, options=OPTIONS)
    if isinstance(options, Unreachable):
        motion.note(reachable=False, ik_residual=options.residual)
        raise HaltedError("unreachable")
    chosen = _quickest(start, options, boxes, grasp)
    if chosen is None:
        raise HaltedError("path")
    motion.note(ik_residual=chosen[0].residual)
    return chosen


def _quickest(
    start: Array, options: Sequence[Reach], boxes: Sequence[Obstacle], grasp: Grasp
) -> tuple[Reach, Transit] | None:
    """The option with the quickest free way: a direct one if any is free, else a detour.

    Options whose pre-grasp lies deep inside something else than the target are left out.
    """
    others = [box for box in boxes if not is_around(box, grasp)]
    options = [reach for reach in options if clearances(reach.pregrasp[None], others).min() > -DEEPEST]
    direct = [(reach, plan_direct(start, reach.pregrasp, boxes)) for reach in options]
    free = [(reach, transit) for reach, transit in direct if transit is not None]
    if not free:
        detours = ((reach, plan_transit(start, reach.pregrasp, boxes)) for reach in options[:DETOURS])
        free = [(reach, transit) for reach, transit in detours if transit is not None]
    return min(free, key=lambda pair: pair[1].duration) if free else None


def is_around(box: Obstacle, grasp: Grasp) -> bool:
    """Whether the grasp's point lies within a box, give or take 2 cm: then the box is the target's."""
    offset = np.asarray(grasp.position) - np.asarray(box.centre)
    cos, sin = math.cos(box.yaw), math.sin(box.yaw)
    local = (cos * offset[0] + sin * offset[1], cos * offset[1] - sin * offset[0], offset[2])
    return all(abs(value) <= half + 0.02 for value, half in zip(local, box.half, strict=True))


def target_zone(grasp: Grasp) -> Obstacle:
    """A slim column around the grasp that the free way keeps out of, even if the caller names no obstacle there."""
    x, y, z = grasp.position
    half = max(0.02, grasp.aperture / 2 - 0.01)
    top = max(z + 0.02, 0.03)
    return Obstacle((x, y, top / 2), grasp.yaw, (half, half, top / 2))


def arrive(motion: MotionRun, grasp: Grasp, transit: Transit, force_limit: float) -> None:
    """Free motion to the pre-grasp while the hand opens as far as commanded."""
    motion.world.set_grip_force(OPENING_FORCE)
    motion.run_guarded(transit.samples(TIMESTEP), grasp.aperture, "transit", force_limit)
    opened = abs(motion.aperture - grasp.aperture)
    if opened > NOTHING:
        motion.run(hold(motion.commanded, grasp.aperture, opened / 0.1 + 0.05), "transit")


def approach(
    motion: MotionRun,
    grasp: Grasp,
    reach: Reach,
    force_limit: float,
    creep: float = 0.0,
    creep_speed: float = CREEPING,
) -> None:
    """Straight approach with the force reflex; on contact the arm stops, backs off, and the motion ends.

    Args:
        motion: The motion so far.
        grasp: Stand-off, speed and opening.
        reach: Joint angles of the approach.
        force_limit: Wrist force of the reflex [N].
        creep: Last stretch [m] that the hand goes slowly, where it may land on the thing.
        creep_speed: Speed of that stretch [m/s].
    """
    samples = approach_samples(grasp, reach, creep, creep_speed)
    seconds = TIMESTEP * len(samples)
    gone = motion.run_guarded(samples, grasp.aperture, "approach", force_limit, back=seconds)
    rest = motion.run(hold(reach.joints, grasp.aperture, 0.04), "approach")
    rows = np.concatenate([gone.sensordata, rest.sensordata])
    motion.note(
        approach_force=largest_force(motion.wrist.force(rows)),
        aperture_start=float(motion.reading("robot/opening", rest)[-1, 0]),
    )


def approach_samples(grasp: Grasp, reach: Reach, creep: float, creep_speed: float) -> Array:
    """Joint samples (T, 7) of the approach; the last `creep` metres of it slowly."""
    seconds = approach_time(grasp.standoff, grasp.speed)
    share = 1.0 - creep / grasp.standoff
    if creep <= 0.0 or share < 0.2:
        return along(reach.approach, seconds)
    quick = along(part(reach.approach, 0.0, share), approach_time(grasp.standoff - creep, grasp.speed))
    slow = along_steadily(part(reach.approach, share, 1.0), creep / creep_speed, CREEP_RAMP)
    return np.concatenate([quick, slow])


def close(motion: MotionRun, grasp: Grasp, reach: Reach) -> None:
    """Closes with the commanded force until the fingers rest; the gentler the force, the slower."""
    motion.world.set_grip_force(grasp.force)
    data, sensors = motion.world.data.sensordata, motion.world.index.sensors
    speed, force = sensors["robot/opening_speed"].start, sensors["robot/grip_force"].start
    resting = 0

    def check() -> str | None:
        nonlocal resting
        still = abs(data[speed]) < REST_SPEED and -data[force] > 0.98 * grasp.force
        resting = resting + 1 if still else 0
        return "rest" if resting >= REST_STEPS else None

    speed_of_closing = GRIP_SLEW * min(1.0, max(SLOWEST_CLOSING, grasp.force / FULL_CLOSING))
    longest = (motion.aperture - CLOSED) / speed_of_closing + 0.6
    controls = hold(reach.joints, CLOSED, longest)
    elapsed = TIMESTEP * np.arange(1, len(controls) + 1)
    controls[:, GRIP_COLUMN] = np.maximum(CLOSED, motion.aperture - speed_of_closing * elapsed)
    closed = motion.run(controls, "close", check)
    tool_z = float(motion.reading("robot/tcp_position", closed)[-1, 2])
    squeeze = holding_command(motion.aperture, grasp.force)
    motion.run(hold(reach.joints, squeeze, 0.01), "close")
    note_hang(motion, tool_z)
    motion.note(
        aperture_closed=float(motion.reading("robot/opening", closed)[-1, 0]),
        motor_force_closed=-float(motion.reading("robot/grip_force", closed)[-1, 0]),
        closing_force_peak=float(-motion.reading("robot/grip_force", closed).min()),
        closing_wrench=largest_force(motion.wrist.force(closed.sensordata)),
    )


def lift_up(motion: MotionRun, grasp: Grasp, reach: Reach, most_force: float | None = None) -> bool:
    """Lifts a little, weighs, and lifts the rest; False if the hand closed on nothing and there is nothing to lift.

    With `most_force` [N] the first bit is a test lift that raises the grip up to there if something slips.
    """
    share = TEST_LIFT / reach.height
    first, rest = part(reach.lift, 0.0, share), part(reach.lift, share, 1.0)
    base_z = float(motion.world.read("robot/tcp_position")[2])
    if most_force is not None and most_force > grasp.force:
        held = trial_lift(motion, first, grasp.force, most_force, grasp.speed, TEST_LIFT)
        motion.note(grip_raised=held - grasp.force)
    else:
        motion.run(follow(along(first, approach_time(TEST_LIFT, grasp.speed)), motion.grip, reach.joints), "lift")
    weighed = motion.run(hold(first[-1], motion.grip, 0.1), "lift")
    motion.carry(weighed)
    # A hand that is pushed up from below carries nothing: a mass is never negative.
    motion.note(load_lifted=max(0.0, float(motion.wrist.mass(weighed.sensordata)[-25:].mean())))
    if motion.aperture < NOTHING:
        _note_end(motion, weighed, base_z)
        return False
    up = motion.run(
        follow(along(rest, approach_time(reach.height - TEST_LIFT, grasp.speed)), motion.grip, first[-1]), "lift"
    )
    motion.carry(up)
    motion.note(aperture_lifted=motion.aperture)
    _note_end(motion, up, base_z)
    return True


def hold_and_shake(motion: MotionRun, reach: Reach, shake: bool) -> None:
    """Holds still, then shakes the wrist, and weighs at the end."""
    top = reach.lift[-1]
    base_z = float(motion.world.read("robot/tcp_position")[2]) - motion.fields["lift_height"]
    last = motion.run(hold(top, motion.grip, HOLD_S), "hold")
    motion.carry(last)
    if shake:
        motion.carry(motion.run(follow(shake_path(top, SHAKE_S), motion.grip, top), "shake"))
        last = motion.run(hold(top, motion.grip, 0.15), "shake")
        motion.carry(last)
    _note_end(motion, last, base_z)


def _note_end(motion: MotionRun, last: Recording, base_z: float) -> None:
    rows = last.sensordata[-25:]
    motion.note(
        aperture_end=float(motion.reading("robot/opening", last)[-1, 0]),
        motor_force_end=-float(motion.reading("robot/grip_force", last)[-1, 0]),
        load_end=float(motion.wrist.mass(rows).mean()),
        load_torque=float(np.linalg.norm(motion.wrist.torque(rows).mean(axis=0))),
        lift_height=float(motion.reading("robot/tcp_position", last)[-1, 2]) - base_z,
    )
