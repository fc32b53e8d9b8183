"""Contents of a filled container: free balls, packed without overlap (benchmark.md section 3, S1)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sim.footprint import rotation
from sim.placed import Cavity, Particles, PlacedObject

RADIUS = 0.010
"""Radius of a ball [m]."""
FILL = 0.70
"""Height of the contents over the container's height."""
DENSITY = 900.0
"""Density of the balls [kg/m^3]: chocolates in a cup."""
PACKING = 0.47
"""Share of the volume that balls of this size fill in a cup, measured after settling."""
CLEARANCE = 2e-4
"""Free distance between balls, and to the wall, at the start [m]."""


def fill(container: PlacedObject, rng: np.random.Generator) -> Particles:
    """Balls that fill an upright container to about 70 % of its height once they have settled.

    Args:
        container: A placed object with a cavity.
        rng: Turns the layers and draws the colour.

    Raises:
        ValueError: the object has no cavity.
    """
    cavity = container.cavity
    if cavity is None:
        raise ValueError(f"{container.id} has no cavity")
    level = FILL * container.size[2]
    wanted = max(1, round(PACKING * _volume(cavity, level) / (4 / 3 * math.pi * RADIUS**3)))
    positions: list[tuple[float, float, float]] = []
    height = cavity.floor + RADIUS + CLEARANCE
    while len(positions) < wanted:
        turn = float(rng.uniform(0, 2 * math.pi))
        layer = _layer(_radius(cavity, height - RADIUS) - RADIUS - CLEARANCE, turn)
        positions += [(x, y, height) for x, y in layer][: wanted - len(positions)]
        height += 2 * RADIUS + CLEARANCE
    local = np.asarray(positions)
    world = local @ rotation(container.quaternion).T + np.asarray(container.position)
    brown = float(rng.uniform(0.1, 0.5))
    return Particles(
        container=container.id,
        radius=RADIUS,
        mass=DENSITY * 4 / 3 * math.pi * RADIUS**3,
        positions=world,
        rgba=(brown, 0.6 * brown, 0.35 * brown, 1.0),
    )


def contained(container: PlacedObject, positions: NDArray[np.float64]) -> bool:
    """Whether every ball's centre (N, 3) in the world lies within the container's cavity, below its rim."""
    cavity = container.cavity
    if cavity is None:
        return False
    local = (positions - np.asarray(container.position)) @ rotation(container.quaternion)
    inside = np.hypot(local[:, 0], local[:, 1]) < cavity.radius_top
    return bool(np.all(inside & (local[:, 2] > 0.0) & (local[:, 2] < cavity.top)))


def _radius(cavity: Cavity, height: float) -> float:
    """Free radius at a height above the base [m]; above the opening that of the opening."""
    share = min(1.0, max(0.0, (height - cavity.floor) / (cavity.top - cavity.floor)))
    return cavity.radius_floor + share * (cavity.radius_top - cavity.radius_floor)


def _volume(cavity: Cavity, level: float) -> float:
    """Volume of the cavity below `level` [m^3]."""
    heights = np.linspace(cavity.floor, min(level, cavity.top), 50)
    radii = np.array([_radius(cavity, float(height)) for height in heights])
    return float(np.trapezoid(np.pi * radii**2, heights))


def _layer(radius: float, turn: float) -> list[tuple[float, float]]:
    """Centres of balls in one level, on a hexagonal grid turned by `turn`, within `radius` of the axis [m]."""
    if radius < 0.0:
        return [(0.0, 0.0)]
    step = 2 * RADIUS + CLEARANCE
    reach = int(radius / step) + 2
    centres = [
        (step * (i + j / 2), step * j * math.sqrt(3) / 2)
        for i in range(-reach, reach + 1)
        for j in range(-reach, reach + 1)
    ]
    chosen = [(x, y) for x, y in centres if math.hypot(x, y) <= radius]
    cos, sin = math.cos(turn), math.sin(turn)
    return [(cos * x - sin * y, sin * x + cos * y) for x, y in sorted(chosen, key=lambda c: math.hypot(*c))]
