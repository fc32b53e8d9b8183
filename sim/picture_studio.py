"""The studio of pictures for people: backdrop, lamps and the grain of the table's wood.

Knows nothing of rays, robots or scenes: it says where lamps hang and what colour things are without them.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sim.viewpoint import Viewpoint

Array = NDArray[np.float32]


def backdrop(rays: NDArray[np.float64]) -> Array:
    """A quiet studio gradient by elevation, linear colours (N, 3)."""
    lift = np.clip(rays[:, 2].astype(np.float32) * 1.2 + 0.55, 0, 1)[:, None]
    low, high = linear_rgb(0.72, 0.79, 0.88), linear_rgb(1.25, 1.30, 1.36)
    return (low * (1 - lift) + high * lift).astype(np.float32)


def key_points(target: NDArray[np.float64], viewpoint: Viewpoint, count: int) -> NDArray[np.float64]:
    """Points on the round key light, above and to the left of the viewer, (count, 3)."""
    right, _, forward = viewpoint.axes()
    centre = target - 1.0 * forward * (1, 1, 0) - 1.35 * right + np.array([0, 0, 2.2])
    axis = (target - centre) / np.linalg.norm(target - centre)
    u = np.cross(axis, [0, 0, 1])
    u /= np.linalg.norm(u)
    v = np.cross(axis, u)
    number = np.arange(count)
    radius = 0.28 * np.sqrt((number + 0.5) / count) * (count > 1)
    angle = number * math.pi * (3 - math.sqrt(5))  # the golden angle spreads points evenly
    return centre + radius[:, None] * (np.cos(angle)[:, None] * u + np.sin(angle)[:, None] * v)


def dome(target: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """Points spread evenly over the upper half of a sphere of 4 m around the target, (count, 3)."""
    number = np.arange(count)
    z = 0.06 + 0.94 * (number + 0.5) / count
    ring = np.sqrt(1 - z**2)
    angle = number * math.pi * (3 - math.sqrt(5))
    return target + 4.0 * np.column_stack([ring * np.cos(angle), ring * np.sin(angle), z])


def grain(point: Array) -> Array:
    """Brightness factor of planks with fine grain along x at points (N, 3)."""
    plank = np.floor(point[:, 1] / 0.1333)
    tone = 1.0 + 0.05 * np.sin(plank * 12.9898 + 1.3)
    warp = 0.006 * np.sin(point[:, 0] * 7 + plank * 2.1) + 0.003 * np.sin(point[:, 0] * 19 + plank)
    lines = np.sin((point[:, 1] + warp) * 620) * 0.5 + np.sin((point[:, 1] + 2 * warp) * 233 + plank) * 0.5
    seam = np.abs(point[:, 1] / 0.1333 - np.round(point[:, 1] / 0.1333)) < 0.006
    return ((tone + 0.035 * lines) * np.where(seam, 0.86, 1.0)).astype(np.float32)


def linear_rgb(red: float, green: float, blue: float) -> NDArray[np.float32]:
    """A linear colour (3,)."""
    return np.array([red, green, blue], np.float32)
