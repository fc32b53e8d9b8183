"""The test lift: over the first two centimetres the hand feels in short stretches what it carries, and grips accordingly.

What slips between the fingers weighs as much as friction carries, what turns pulls with the torque that friction resists.
Gripped harder, more of its weight leaves the table, so that force and load rise together until it hangs free. Thus weight
and friction are learnt from the first contact, before anything can fall.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sim.controller import along, follow, hold, holding_command
from sim.hand import approach_time
from sim.motion_run import NOTHING, MotionRun
from sim.wrench import GRAVITY

Array = NDArray[np.float64]

STEPS = 8
"""Stretches of the test lift."""
SLOWLY = 1.5
"""The test lift takes this many times as long as the same height otherwise."""
WEAK_GRIP, MORE_SLOWLY = 4.0, 3.0
"""What bears no more than this [N] is thin glass, and lifted this slowly: a jerk presses it with twice the grip."""
SETTLE_S = 0.02
"""Time in which the fingers follow a changed force [s]."""
UPPER = 0.8
"""Quantile of the readings of a step that counts: what creeps carries less than what slides."""
LEAST_RAISE, TOO_WEAK = 1.3, 1.05
"""A grip is too weak if more than its force times the second is wanted, and is raised by the first factor at least."""
POOR_FRICTION = 0.3
"""Friction coefficient that the grip reckons with: glass and metal at their worst."""
MARGIN = 1.5
"""The grip bears this many times the weight (ledger G9)."""
LONGEST_ARM = 0.12
"""A load hangs at most this far beside the grip [m]: a greater torque for its weight is a jerk and no lever."""
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
    samples = along(way, (MORE_SLOWLY if most <= WEAK_GRIP else SLOWLY) * approach_time(height, speed))
    before = way[0]
    # One smooth motion: stopping between the steps would shake loose what is barely held.
    for stretch in np.array_split(samples, STEPS):
        # Only what moves is felt to slip: at rest the table takes the weight back.
        felt = motion.run(follow(stretch, motion.grip, before), "lift").sensordata
        before = stretch[-1]
        if motion.aperture < NOTHING:
            break
        load = float(np.quantile(motion.wrist.mass(felt), UPPER))
        torque = float(np.median(motion.wrist.torque(felt)[:, 1]))
        wanted = needed_force(load, torque)
        if force < most and wanted > TOO_WEAK * force:
            force = min(max(wanted, LEAST_RAISE * force), most)
            motion.world.set_grip_force(force)
            motion.run(hold(before, holding_command(motion.aperture, force), SETTLE_S), "lift")
    return force


def needed_force(load: float, torque: float) -> float:
    """Force [N] that holds a load [kg] and resists a torque about the closing axis [N m], at poor friction."""
    pull = max(load, 0.0) * GRAVITY
    lever = min(abs(torque), pull * LONGEST_ARM)
    return max(MARGIN * pull / (2.0 * POOR_FRICTION), lever / (2.0 * TWIST_FRICTION * TWIST_RADIUS))
