"""The one viewpoint of the words left, right, behind and in front: the person's, who stands where the front camera is.

The person looks from (1.33, 0, 0.78) over the table to the robot, and sees the front camera's picture. So "behind"
is farther from the person (towards the robot, -x) and "left" is the picture's left (-y in the robot's base frame).
One file, so that relations between objects, spoken references and places on the table cannot disagree.
"""

from __future__ import annotations

from kb.base import Vec3

EYE: Vec3 = (1.33, 0.0, 0.78)
"""Nominal position of the front camera [m] (perception.md)."""
LEFT: Vec3 = (0.0, -1.0, 0.0)
"""Unit vector to the person's left."""
RIGHT: Vec3 = (0.0, 1.0, 0.0)
BEHIND: Vec3 = (-1.0, 0.0, 0.0)
"""Unit vector away from the person."""
IN_FRONT: Vec3 = (1.0, 0.0, 0.0)
