"""What was put into the bin, as it should lie there: its walls hide it from every look, so that the robot has to remember.

Without that memory the fingers open into what lies there already, or the next thing comes to lie on it.
"""

from __future__ import annotations

import math

import numpy as np

from kb.base import Vec3
from kb.percept import PerceivedObject, pack_surface
from kb.sensing import Sensing

KEPT = 24
"""Things in the bin that are remembered: more would not fit."""


def with_another(
    in_bin: tuple[PerceivedObject, ...],
    put: PerceivedObject,
    sensing: Sensing | None,
    corners: tuple[Vec3, Vec3] | None,
) -> tuple[PerceivedObject, ...]:
    """The things in the bin, and what was just let go there.

    Args:
        in_bin: What was put there before.
        put: The thing as it stood before it was taken.
        sensing: Of the placing motion.
        corners: Of the bin [m].
    """
    if sensing is None or sensing.aimed_at is None or corners is None:
        return in_bin
    cosine, sine = math.cos(sensing.turned), math.sin(sensing.turned)
    turn = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    x, y = sensing.aimed_at
    position = (x, y, corners[0][2] + put.size[2] / 2)
    surface = (put.surface_points() - np.asarray(put.position)) @ turn.T + np.asarray(position)
    yaw = math.remainder(put.yaw + sensing.turned, math.pi)
    lying = put.model_copy(
        update={
            "position": position, "yaw": yaw, "surface": pack_surface(surface, position), "parts": (), "embedding": (),
            "posterior": {},
        }
    )  # fmt: skip
    return (*(obj for obj in in_bin if obj.id != put.id), lying)[-KEPT:]
