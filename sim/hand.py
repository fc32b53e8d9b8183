"""The Panda hand as boxes (`sim.swept_hand` tells how close it comes to points while it grasps).

Hand frame: origin at the flange, x across the fingers, y closing axis, z approach. The tool centre point lies at
z = `TCP_OFFSET`. Sizes were measured on the hand and finger meshes of the `rtb-data` package. This module knows no
objects: points come from whoever has seen or placed them.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kb.grasp import FULL_SPEED

Array = NDArray[np.float64]

TCP_OFFSET = 0.1034
"""Flange to tool centre point along z [m] (Franka hand manual: F_T_EE of the standard hand)."""
FINGER_OFFSET = 0.0584
"""Flange to the origin of the fingers along z [m] (Franka hand description)."""
TIP_BEYOND_TCP = FINGER_OFFSET + 0.0538 - TCP_OFFSET
"""The fingertips reach this far beyond the tool centre point [m]."""
PALM_ABOVE_TCP = TCP_OFFSET - 0.066
"""The palm's lower face stands this far back from the tool centre point [m]; the tips are 46 mm below it (ledger G39)."""

PALM_BOXES: tuple[tuple[tuple[float, float, float], tuple[float, float, float]], ...] = (
    ((0.0, 0.0, -0.003), (0.0315, 0.102, 0.023)),
    ((0.0, 0.0, 0.043), (0.0235, 0.102, 0.023)),
)
"""Centre and half size [m] in the hand frame: the wide rear part and the slim front part of the palm (ledger G2)."""
FINGER_BOXES: tuple[tuple[tuple[float, float, float], tuple[float, float, float]], ...] = (
    ((0.0, 0.01895, 0.0100), (0.0105, 0.00735, 0.0100)),
    ((0.0, 0.0130, 0.0280), (0.0095, 0.0080, 0.0080)),
    ((0.0, 0.0072, 0.0449), (0.0089, 0.0072, 0.0089)),
)
"""Root, middle and pad of the left finger in the finger's frame, whose y axis points away from the other finger. The
pad's inner face is y = 0. The right finger is the left one turned by pi about z."""
PAD = 2
"""Index of the pad in `FINGER_BOXES`."""

FULL_LIFT = 0.17
"""How far the tool point rises in a grasp motion [m]: 10 cm demanded by success, and room for the shake."""


def hand_boxes(aperture: float) -> list[tuple[Array, Array]]:
    """Centres (3,) and half sizes (3,) [m] of the hand's boxes in the hand frame at an opening `aperture` [m]."""
    boxes = [(np.array(centre), np.array(half)) for centre, half in PALM_BOXES]
    for sign in (1.0, -1.0):
        for centre, half in FINGER_BOXES:
            y = sign * (centre[1] + aperture / 2.0)
            boxes.append((np.array([centre[0], y, centre[2] + FINGER_OFFSET]), np.array(half)))
    return boxes


def approach_time(distance: float, speed: float) -> float:
    """Duration [s] of a straight quintic motion over `distance` [m] whose peak speed is `speed` x FULL_SPEED.

    The peak of a quintic time law is 15/8 of its mean speed.
    """
    return max(0.25, 15.0 / 8.0 * distance / (FULL_SPEED * speed))
