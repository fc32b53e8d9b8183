"""The test lift: the first two centimetres in small steps, after each of which the hand grips what it feels.

What slips between the fingers weighs as much as friction carries, what turns pulls with the torque that friction resists.
Gripped harder, more of its weight leaves the table, so that force and load rise together until it hangs free. Thus weight
and friction are learnt from the first contact, before anything can fall.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sim.controller import along, follow, hold, holding_command, part
from sim.hand import approach_time
from sim.motion_run import NOTHING, MotionRun
from sim.wrench import GRAVITY

Array = NDArray[np.float64]

STEPS = 8
"""Steps of the test lift."""
SETTLE_S = 0.04
"""Time in which the fingers follow a changed force [s]."""
POOR_FRICTION = 0.3
"""Friction coefficient that the grip reckons with: glass and metal at their worst."""
MARGIN = 1.5
"""The grip bears this many times the weight (ledger G9)."""
TWIST_FRICTION, TWIST_RADIUS = 0.4, 0.014
"""Friction coefficient and effective radius [m] at which a pad resists turning about the closing axis."""


def trial_lift(motion: MotionRun, way: Array, force: float, most: float, speed: float, height: float) -> float:
    """Lifts along `way` and raises the grip as the load demands.

    Args:
        motion: The motion under way, the hand closed.
        way: Joint angles of the test lift (T, 7).
        force: Force with which the hand closed [N].
        most: Force that it must not exceed [N].
        speed: Velocity scale.
        height: Height of the test lift [m].

    Returns:
        The force with which the hand now holds [N].
    """
    below = way[0]
    seconds = approach_time(height, speed) / STEPS
    for number in range(STEPS):
        stretch = part(way, number / STEPS, (number + 1) / STEPS)
        # Only what moves is felt to slip: at rest the table takes the weight back.
        felt = motion.run(follow(along(stretch, seconds), motion.grip, below), "lift").sensordata
        below = stretch[-1]
        if motion.aperture < NOTHING:
            break
        felt = felt[len(felt) // 2 :]
        load, torque = np.median(motion.wrist.mass(felt)), np.median(motion.wrist.torque(felt)[:, 1])
        wanted = needed_force(float(load), float(torque))
        if force < min(wanted, most):
            force = min(wanted, most)
            motion.world.set_grip_force(force)
            motion.run(hold(below, holding_command(motion.aperture, force), SETTLE_S), "lift")
    return force


def needed_force(load: float, torque: float) -> float:
    """Force [N] that holds a load [kg] and resists a torque about the closing axis [N m], at poor friction."""
    weight = MARGIN * max(load, 0.0) * GRAVITY / (2.0 * POOR_FRICTION)
    return max(weight, abs(torque) / (2.0 * TWIST_FRICTION * TWIST_RADIUS))
