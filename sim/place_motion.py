"""The phases of setting down: carry above, lower until contact is felt, let go, retreat, go home."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kb.base import Vec3
from kb.grasp import closing_axis
from kb.sensing import Phase
from sim.arm_shape import self_clearance
from sim.build_model import TIMESTEP
from sim.carry_path import CARRY_HEIGHTS, OVERSHOOT, WayDown, carry_way, way_down
from sim.controller import along, follow, hold
from sim.hand import approach_time
from sim.kinematics import forward
from sim.lower_motion import hang, lower
from sim.motion import CARRIED_RADIUS, Obstacle, plan_transit
from sim.motion_run import HaltedError, MotionRun
from sim.panda import FINGER_TRAVEL, GRIP_SLEW, READY
from sim.reach import descents, line_any
from sim.setting import setting_obstacles

Array = NDArray[np.float64]

RETREAT = 0.10
"""Way back along the approach after letting go [m]."""
RISE = 0.12
"""Way up where the retreat alone leaves the hand low [m]."""
RELEASE_ROOM = 0.03
"""How much wider than the held object the hand opens to let go [m]."""
OPENING_FORCE = 20.0
"""Motor force while the hand opens [N]."""
ASIDE = 40
"""Detours aside that are looked for where an empty hand finds no other way."""
LOOSE = 5e-4
"""How far the fingers have moved apart when they no longer press [m]."""
SLOWEST_CARRY = 0.3
"""Least velocity scale of the way to above the set-down."""
STRAIGHT_DOWN = 0.9
"""Cosine of the hand's tilt from which the way up is a way back from what was set down."""
ON_WAY = 0.15
"""A posture whose joints are all this near to those of a way is on it [rad]."""
TRAVEL_FORCE = 30.0
"""Wrist force, less nothing for the load, that stops a free motion [N]: a load of 0.6 kg shaken at 2 g stays below."""


def carried(motion: MotionRun) -> Array | None:
    """Points of what is held in the hand frame, for path planning; None if nothing is held."""
    if not motion.holding:
        return None
    way = hang(motion)
    length = float(np.linalg.norm(way))
    count = max(1, int(np.ceil(length / CARRIED_RADIUS)))
    shares = (np.arange(count) + 0.5) / count
    from sim.hand import TCP_OFFSET

    return np.array([0.0, 0.0, TCP_OFFSET]) + shares[:, None] * way


def travel(
    motion: MotionRun,
    goal: Array,
    obstacles: Sequence[Obstacle],
    phase: Phase,
    slow: float = 1.0,
    shape: Array | None = None,
) -> None:
    """Free motion to a configuration, around obstacles, with whatever is held.

    Args:
        motion: The motion.
        goal: Joint angles to arrive at (7,) [rad].
        obstacles: What to keep away from.
        phase: Name of the phase.
        slow: Velocity scale.
        shape: Points of what is held in the hand frame (P, 3) [m]; a line to the ground it was taken from, if left out.

    Raises:
        HaltedError: "path" if no free path was found.
    """
    start = motion.commanded
    if float(np.abs(start - goal).max()) < 1e-6:
        return
    boxes = [*obstacles, *setting_obstacles(motion.world.placed.bin)]
    load = carried(motion)
    if load is not None and shape is not None and len(shape):
        load = shape
    if load is not None:
        transit = carry_way(start, goal, boxes, load)
    else:
        # Places are seen to a centimetre: a way that may graze something comes after all detours.
        transit = plan_transit(start, goal, boxes, aside=ASIDE) or plan_transit(start, goal, boxes, margin=0.0)
    if transit is None:
        motion.note(phase=phase)
        raise HaltedError("path")
    recording = motion.run_guarded(transit.samples(TIMESTEP, slow), motion.grip, phase, TRAVEL_FORCE)
    if load is not None:
        motion.carry(recording)


def place_pose(motion: MotionRun, position: Vec3, approach: Vec3 | None, yaw: float | None) -> Array:
    """Tool pose (4, 4) of a set-down; what is not given stays as the hand is now."""
    pose = forward(motion.commanded)
    z = pose[:3, 2] if approach is None else np.asarray(approach, float) / np.linalg.norm(approach)
    azimuth = float(np.arctan2(pose[1, 1], pose[0, 1])) if yaw is None else yaw
    y = pose[:3, 1] if approach is None and yaw is None else closing_axis(z, azimuth)
    pose[:3, :3] = np.column_stack([np.cross(y, z), y, z])
    pose[:3, 3] = position
    return pose


def carry_above(
    motion: MotionRun, pose: Array, obstacles: Sequence[Obstacle], speed: float, load: Array | None = None
) -> WayDown | None:
    """Carries what is held above the set-down pose and lowers it until contact is felt.

    Args:
        motion: The motion.
        pose: Tool pose at the set-down (4, 4).
        obstacles: What to keep away from.
        speed: Velocity scale.
        load: Points of what is held in the hand frame (P, 3) [m]; a line to the ground it was taken from, if left out.

    Returns:
        The way that was taken, or None if what was held slipped out of the hand on it.

    Raises:
        HaltedError: "unreachable" or "path".
    """
    boxes = [*obstacles, *setting_obstacles(motion.world.placed.bin)]
    held = carried(motion)
    if held is not None and load is not None and len(load):
        held = load
    way = way_down(pose, motion.commanded, boxes, held)
    if way is None:
        reached = next(descents(pose, motion.commanded, CARRY_HEIGHTS[-1], OVERSHOOT), None) is not None
        motion.note(reachable=reached, phase="carry")
        raise HaltedError("path" if reached else "unreachable")
    # What is carried far off its middle turns in the hand with a jerk where the hand brakes hard.
    samples = way.transit.samples(TIMESTEP, min(1.0, max(speed * speed, SLOWEST_CARRY)))
    recording = motion.run_guarded(samples, motion.grip, "carry", TRAVEL_FORCE)
    if held is not None:
        motion.carry(recording)
        if not motion.holding:
            motion.note(lost=True)
            return None
    lower(motion, way.path, way.length, speed)
    return way


def let_go(motion: MotionRun, way: WayDown | None = None) -> None:
    """Opens a little wider than what is held, and retreats along the approach without dragging.

    Args:
        motion: The motion.
        way: The way on which the hand came, if it is known.
    """
    here, before = motion.commanded, motion.aperture
    opening = min(2 * FINGER_TRAVEL, max(before + RELEASE_ROOM, 0.02))
    data, column = motion.world.data.sensordata, motion.world.index.sensors["robot/opening"].start
    longest = (opening - motion.grip) / GRIP_SLEW + 0.2
    # The command rises slowly from "closed"; until it passes the fingers, a larger force would squeeze what is held.
    motion.run(hold(here, opening, longest), "release", lambda: "loose" if data[column] > before + LOOSE else None)
    motion.world.set_grip_force(OPENING_FORCE)
    motion.run(hold(here, opening, longest), "release", lambda: "open" if data[column] > opening - 1e-3 else None)
    retreat(motion, way)
    motion.note(aperture_end=motion.aperture)


def retreat(motion: MotionRun, way: WayDown | None = None) -> None:
    """Back along the approach as far as the arm can, then up if the hand is still low.

    A hand that points down and gets no farther goes up as it came, on `way`: that is always possible.
    """
    if not _back(motion, -forward(motion.commanded)[:3, 2], RETREAT, (1.0, 0.6)):
        if way is not None and forward(motion.commanded)[2, 2] < -STRAIGHT_DOWN:
            go_up(motion, way)
        else:
            _back(motion, -forward(motion.commanded)[:3, 2], RETREAT, (0.3,))
    if forward(motion.commanded)[2, 3] <= 0.30:
        _back(motion, np.array([0.0, 0.0, 1.0]), RISE, (1.0, 0.6, 0.3))


def _back(motion: MotionRun, direction: Array, distance: float, shares: Sequence[float]) -> bool:
    """Moves straight by the largest of the shares of a distance [m] that the arm can; False if it can none."""
    pose = forward(motion.commanded)
    for share in shares:
        path = way_back(pose, direction, share * distance, motion.commanded)
        if path is not None:
            seconds = approach_time(share * distance, 1.0)
            motion.run(follow(along(path, seconds), motion.grip, motion.commanded), "retreat")
            return True
    return False


def go_up(motion: MotionRun, way: WayDown) -> None:
    """Up again on the way down, from the point of it where the hand is."""
    here = motion.commanded
    nearest = int(np.abs(way.path - here).max(axis=1).argmin())
    path = np.concatenate([here[None], way.path[:nearest][::-1]])
    if len(path) > 2:
        seconds = approach_time(way.length * (len(path) - 1) / (len(way.path) - 1), 1.0)
        motion.run(follow(along(path, seconds), motion.grip, here), "retreat")


def way_back(pose: Array, direction: Array, distance: float, joints: Array) -> Array | None:
    """Joint angles (7, 7) from a tool pose straight along a direction by a distance [m], or None.

    A folded arm whose wrist would meet its shoulder on the way has none.
    """
    path = line_any(pose, distance * np.linspace(0.0, 1.0, 7)[:, None] * direction, joints)
    return path if path is not None and self_clearance(path) > 0.0 else None


def home(motion: MotionRun, obstacles: Sequence[Obstacle], way: WayDown | None = None) -> None:
    """Drives to the ready pose; an empty hand that is low first retreats, and if need be goes back as it came, on `way`.

    Where the arm met something on its way, it tries once more from where it withdrew to.
    """
    try:
        _go_home(motion, obstacles, way)
    except HaltedError as halted:
        if halted.cause != "force" or motion.holding:
            raise
        motion.halt("home")
        _go_home(motion, obstacles, way)


def _go_home(motion: MotionRun, obstacles: Sequence[Obstacle], way: WayDown | None) -> None:
    """`home`, tried once.

    Raises:
        HaltedError: "path" if no way is free, "force" if the arm met something.
    """
    try:
        travel(motion, READY, obstacles, "home")
    except HaltedError as halted:
        if halted.cause != "path":
            raise
        retreat(motion, way)
        try:
            travel(motion, READY, obstacles, "home")
        except HaltedError as again:
            if again.cause != "path" or way is None or motion.holding:
                raise
            go_back(motion, way)
            travel(motion, READY, obstacles, "home")


def go_back(motion: MotionRun, way: WayDown) -> None:
    """Back to above the set-down and from there to where the way to it began.

    Raises:
        HaltedError: "path" if the hand has strayed too far from that way.
    """
    here = motion.commanded
    if float(np.abs(way.path - here).max(axis=1).min()) > ON_WAY:
        raise HaltedError("path")
    go_up(motion, way)
    samples = way.transit.samples(TIMESTEP)[::-1]
    to_begin = np.stack([motion.commanded, samples[0]])
    motion.run(follow(along(to_begin, 0.5), motion.grip, motion.commanded), "home")
    motion.run_guarded(samples, motion.grip, "home", TRAVEL_FORCE)
