"""Lowering what is held until it stands: fast first, creeping at the end, until contact is felt."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sim.carry_path import OVERSHOOT
from sim.controller import along, along_evenly, follow, part
from sim.hand import approach_time
from sim.kinematics import forward
from sim.motion_run import Check, MotionRun
from sim.reach import line_any
from sim.wrench import GRAVITY, largest_force

Array = NDArray[np.float64]

CREEP, CREEP_SPEED, LEAST_CREEP = 0.015, 0.025, 0.006
"""Last part of a set-down [m], its speed at velocity scale 1, and its least speed [m/s]. A 90-g cube held with 15 N
lands with 13 N (10-ms mean) at 0.02 m/s, and one held with 5 N with 4.5 N at 0.01 m/s."""
TOUCH = 1.0
"""Change of the vertical wrist force that means contact [N]."""
SWING = 0.6
"""Share of the weight in the hand by which a swing may change what the wrist feels."""
SWINGS = 4
"""Ways down that are begun before what is felt counts as ground, however high."""


def note_hang(motion: MotionRun, tool_z: float) -> None:
    """Remembers how far what was gripped may reach below the tool point, in the hand frame.

    It stood on the table or on something, so its lowest point is at most the tool's height below the tool.
    """
    turn = forward(motion.joints)[:3, :3]
    down = turn.T @ np.array([0.0, 0.0, -max(tool_z, 0.0)])
    for name, value in zip(("hang_x", "hang_y", "hang_z"), down, strict=True):
        motion.world.notes[name] = float(value)


def hang(motion: MotionRun) -> Array:
    """The vector from the tool point to the lowest point of what is held, in the hand frame [m]."""
    notes = motion.world.notes
    return np.array([notes.get(name, 0.0) for name in ("hang_x", "hang_y", "hang_z")])


def lower(motion: MotionRun, path: Array, length: float, speed: float) -> None:
    """Lowers along a straight path (K, 7) of `length` [m], fast first and creeping at the end, until contact is felt.

    What swings in the hand when the arm sets off pulls at the wrist as a contact does. So what is felt high above the
    expected ground counts only if it is still felt at rest.
    """
    felt, mass = 0.0, float(motion.wrist.mass(motion.world.data.sensordata[None])[0])
    high = max(TOUCH, SWING * mass * GRAVITY)
    for _ in range(SWINGS):
        force, touched = _descend(motion, path, length, speed, high)
        felt = max(felt, force)
        motion.halt("set_down")
        left = _share_left(path, motion.commanded)
        if not touched or left * length < CREEP + OVERSHOOT or _borne(motion, mass, high / 2):
            break
        path, length = part(path, 1.0 - left, 1.0), left * length
    motion.note(approach_force=felt)


def _descend(motion: MotionRun, path: Array, length: float, speed: float, high: float) -> tuple[float, bool]:
    """One way down: the largest change of the wrist's force on it [N], and whether it ended with a contact.

    High above the expected ground a change of `high` [N] is one.
    """
    cut = max(0.0, 1.0 - (CREEP + OVERSHOOT) / length)
    creep = (1.0 - cut) * length / max(CREEP_SPEED * speed, LEAST_CREEP)
    stages = [(along_evenly(part(path, cut, 1.0), creep), TOUCH)]
    if cut > 0.05:
        stages.insert(0, (along(part(path, 0.0, cut), approach_time(length * cut, speed)), high))
    felt = 0.0
    for joints, limit in stages:
        record = motion.run(follow(joints, motion.grip, motion.commanded), "set_down", touch_check(motion, limit))
        force = motion.wrist.force_w(record.sensordata)
        felt = max(felt, largest_force(force - force[:1]))
        if record.ended_by == "contact":
            return felt, True
    return felt, False


def _share_left(path: Array, joints: Array) -> float:
    """Share of a path (K, 7) that lies beyond the point of it that is nearest to a configuration (7,)."""
    fine = part(path, 0.0, 1.0, 201)
    return 1.0 - int(np.abs(fine - joints).sum(axis=1).argmin()) / 200


def _borne(motion: MotionRun, mass: float, least: float) -> bool:
    """Whether something bears at least so much [N] of what hung on the hand with `mass` [kg], now that the arm is at rest."""
    now = float(motion.wrist.mass(motion.world.data.sensordata[None])[0])
    return abs(now - mass) * GRAVITY > least


def touch_check(motion: MotionRun, limit: float = TOUCH) -> Check:
    """A check that ends the phase once the vertical wrist force differs by `limit` [N] from its value at the beginning."""
    sensed, wrist = motion.world.data.sensordata, motion.wrist
    first: list[float] = []
    mean = 0.0

    def check() -> str | None:
        nonlocal mean
        if len(first) < 5:
            first.append(float(wrist.mass(sensed[None])[0]))
            mean = float(np.mean(first))
            return None
        # Called at every step: what is far from the threshold in plain numbers needs no second reckoning.
        if abs(wrist.mass_now(sensed) - mean) * GRAVITY < 0.999 * limit:
            return None
        mass = float(wrist.mass(sensed[None])[0])
        return "contact" if abs(mass - mean) * GRAVITY > limit else None

    return check


def lower_here(motion: MotionRun) -> None:
    """Lowers what is held straight down to where its lowest point is expected on the ground, or to contact."""
    pose = forward(motion.commanded)
    down = float((pose[:3, :3] @ hang(motion))[2])
    drop = pose[2, 3] + down + OVERSHOOT
    if drop <= 0.005:
        return
    path = line_any(pose, -drop * np.linspace(0.0, 1.0, 9)[:, None] * np.array([0.0, 0.0, 1.0]), motion.commanded)
    if path is not None:
        lower(motion, path, drop, 0.6)
