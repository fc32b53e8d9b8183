"""LEANING_ON: a tilted thing that stands on the table and touches another one."""

from __future__ import annotations

import math

import numpy as np

from kb.percept import PerceivedObject
from tools.scene_relations.solid import Solid

TILT = (math.radians(12.0), math.radians(78.0))
"""Range of the inclination of a leaning thing's axis or face: flatter it lies, steeper it stands."""
LONG = 3.0
"""Least ratio of the largest to the second standard deviation of the surface for a thing to have an axis."""
FLAT = 0.25
"""Largest ratio of the smallest to the second standard deviation for a thing to have a face."""
CONTACT = 0.008
"""Distance at which observed surface points count as touching the other thing [m] (noise of depth and of size)."""
STANDING = 0.015
"""Largest height of its lowest point above the table [m]."""
FEWEST_POINTS = 30


def inclination(obj: PerceivedObject) -> float | None:
    """Angle of the long axis, or of the face, of the object against the table [rad]; None without axis or face."""
    points = obj.surface_points()
    if len(points) < FEWEST_POINTS:
        return None
    _, spread, axes = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)
    if spread[0] >= LONG * spread[1]:
        return math.asin(min(1.0, abs(float(axes[0][2]))))
    if spread[2] <= FLAT * spread[1]:
        return math.acos(min(1.0, abs(float(axes[2][2]))))
    return None


def leans_on(obj: PerceivedObject, other: Solid) -> bool:
    """LEANING_ON: inclined by 12-78 degrees, its foot on the table, and its upper half touches the other thing."""
    angle = inclination(obj)
    if angle is None or not TILT[0] <= angle <= TILT[1] or obj.base_z > STANDING:
        return False
    points = obj.surface_points()
    upper = points[points[:, 2] > obj.base_z + obj.size[2] / 3.0]
    return len(upper) > 0 and float(other.distance(upper).min()) <= CONTACT
