"""What a shape is: convex pieces, true parts, and the places where other things may rest on or in it.

Object frame: origin at the centre of the footprint, lowest point z = 0, z up, upright as it stands on the table. SI units.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from kb.percept import Part
from sim.placed import Cavity, Geom

Colour = tuple[float, float, float, float]
Point = tuple[float, float, float]


@dataclass(frozen=True)
class Form:
    """A shape at a given size and colour; the geoms carry their shares of the volume as `mass`."""

    geoms: tuple[Geom, ...]
    parts: tuple[Part, ...]
    size: Point
    """Extents along x, y, z [m]."""
    cavity: Cavity | None = None


Shape = Callable[[float, Callable[[], Colour]], Form]
"""A shape's maker: scale (1 is the catalogue's nominal size) and a source of colours (the first call gives the main
colour, further calls other ones that fit the category)."""


def quaternion_about(axis: str, angle: float) -> tuple[float, float, float, float]:
    """Quaternion (w, x, y, z) of a turn by `angle` [rad] about "x", "y" or "z"."""
    half = angle / 2.0
    vector = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}[axis]
    return (math.cos(half), *(math.sin(half) * v for v in vector))  # type: ignore[return-value]


def quaternion_product(
    one: tuple[float, float, float, float], two: tuple[float, float, float, float]
) -> tuple[float, float, float, float]:
    """Quaternion of turning by `two` first, then by `one`."""
    a, b, c, d = one
    w, x, y, z = two
    return (
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    )


def box(centre: Point, half: Point, rgba: Colour, region: str = "body", turn: float = 0.0) -> Geom:
    """A box with half-extents `half` [m], turned about z by `turn` [rad]; `mass` holds its volume."""
    return Geom(
        "box", half, centre, quaternion_about("z", turn), rgba=rgba, mass=8 * half[0] * half[1] * half[2], region=region
    )


def sphere(centre: Point, radius: float, rgba: Colour, region: str = "body") -> Geom:
    """A ball."""
    return Geom("sphere", (radius,), centre, rgba=rgba, mass=4 / 3 * math.pi * radius**3, region=region)


def cylinder(radius: float, bottom: float, top: float, rgba: Colour, region: str = "body") -> Geom:
    """An upright cylinder about the z axis between two heights."""
    half = (top - bottom) / 2
    volume = 2 * math.pi * radius**2 * half
    return Geom("cylinder", (radius, half), (0.0, 0.0, (top + bottom) / 2), rgba=rgba, mass=volume, region=region)


def lying_cylinder(start: float, end: float, radius: float, height: float, rgba: Colour, region: str) -> Geom:
    """A cylinder along x from `start` to `end` with its axis at `height`."""
    half = (end - start) / 2
    volume = 2 * math.pi * radius**2 * half
    place = ((start + end) / 2, 0.0, height)
    turn = quaternion_about("y", math.pi / 2)
    return Geom("cylinder", (radius, half), place, turn, rgba=rgba, mass=volume, region=region)


def capsule(start: Point, end: Point, radius: float, rgba: Colour, region: str = "body") -> Geom:
    """A capsule whose axis runs from `start` to `end`."""
    a, b = np.asarray(start, float), np.asarray(end, float)
    axis = b - a
    length = float(np.linalg.norm(axis))
    x, y, z = (axis / length).tolist()
    # The shortest turn from z to the axis; z itself reversed needs a fixed choice.
    w = math.sqrt(max(0.0, (1 + z) / 2))
    quaternion = (w, -y / (2 * w), x / (2 * w), 0.0) if w > 1e-6 else (0.0, 1.0, 0.0, 0.0)
    volume = math.pi * radius**2 * length + 4 / 3 * math.pi * radius**3
    middle = ((a + b) / 2).tolist()
    return Geom("capsule", (radius, length / 2), tuple(middle), quaternion, rgba=rgba, mass=volume, region=region)


def wall(
    bottom: tuple[float, float],
    top: tuple[float, float],
    thickness: float,
    pieces: int,
    rgba: Colour,
    region: str = "body",
) -> list[Geom]:
    """A ring of boxes about the z axis: a straight, conical or tapered wall.

    Args:
        bottom: (radius, height) of the wall's mid-surface at its lower edge [m].
        top: The same at its upper edge.
        thickness: Wall thickness [m].
        pieces: Number of boxes.
        rgba: Colour.
        region: Affordance region of the pieces.
    """
    (r0, z0), (r1, z1) = bottom, top
    height = math.hypot(r1 - r0, z1 - z0)
    lean = quaternion_about("y", math.atan2(r1 - r0, z1 - z0))
    radius, middle = (r0 + r1) / 2, (z0 + z1) / 2
    half = (thickness / 2, max(r0, r1) * math.tan(math.pi / pieces), height / 2)
    ring: list[Geom] = []
    for k in range(pieces):
        angle = 2 * math.pi * k / pieces
        place = (radius * math.cos(angle), radius * math.sin(angle), middle)
        turn = quaternion_product(quaternion_about("z", angle), lean)
        ring.append(Geom("box", half, place, turn, rgba=rgba, mass=8 * half[0] * half[1] * half[2], region=region))
    return ring


def prism(outline: NDArray[np.float64], bottom: float, top: float, rgba: Colour, region: str = "body") -> Geom:
    """An upright prism over a convex outline (N, 2) [m], as a convex mesh."""
    low = np.column_stack([outline, np.full(len(outline), bottom)])
    vertices = np.vstack([low, low + np.array([0.0, 0.0, top - bottom])])
    x, y = outline[:, 0], outline[:, 1]
    area = 0.5 * abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1)))
    return Geom("mesh", vertices=vertices, rgba=rgba, mass=area * (top - bottom), region=region)


def frustum(bottom: tuple[float, float], top: tuple[float, float], rgba: Colour, region: str = "body") -> Geom:
    """A solid cone's slice about z between (radius, height) pairs, as a 20-sided convex mesh."""
    angles = np.arange(20) * (2 * math.pi / 20)
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    (r0, z0), (r1, z1) = bottom, top
    low = np.column_stack([circle * r0, np.full(20, z0)])
    high = np.column_stack([circle * r1, np.full(20, z1)])
    volume = math.pi * (z1 - z0) * (r0**2 + r0 * r1 + r1**2) / 3
    return Geom("mesh", vertices=np.vstack([low, high]), rgba=rgba, mass=volume, region=region)


def denser(geom: Geom, factor: float) -> Geom:
    """The same piece with `factor` times the mass share."""
    return replace(geom, mass=geom.mass * factor)
