"""A scene after all its random draws: what is compiled into physics, and the ground truth of the world.

This is the truth. Perception (except the oracle) and the agent must not import it.
World frame: robot base at the origin, x to the front, y to the left, z up, table top at z = 0. SI units.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from kb.affordance import AffordanceDescriptor
from kb.percept import Part
from kb.vocabulary import ConstraintKind, ObjectState

GeomType = Literal["box", "sphere", "cylinder", "capsule", "ellipsoid", "mesh"]


@dataclass(frozen=True)
class Geom:
    """One convex collision (and visual) piece in its object's frame."""

    type: GeomType
    size: tuple[float, ...] = ()
    """MuJoCo half-sizes [m]; empty for a mesh."""
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    quaternion: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
    """w, x, y, z."""
    vertices: NDArray[np.float64] | None = None
    """Vertices of a convex mesh piece (N, 3) [m]."""
    rgba: tuple[float, float, float, float] = (0.5, 0.5, 0.5, 1.0)
    mass: float = 0.0
    """Share of the object's mass [kg]."""
    region: str | None = None
    """Affordance region this piece belongs to ("handle", "rim", ...), for the observer."""


@dataclass(frozen=True)
class Cavity:
    """The hollow of an upright open container, in the object frame."""

    floor: float
    """Height of its bottom [m]."""
    top: float
    """Height of its opening [m]."""
    radius_floor: float
    """Free radius at the bottom [m]."""
    radius_top: float
    """Free radius at the opening [m]."""


@dataclass(frozen=True)
class PlacedObject:
    """One free body, drawn and posed. Object frame: origin at the centre of the footprint, lowest point z = 0."""

    id: str
    model: str
    category: str
    affordance: AffordanceDescriptor
    geoms: tuple[Geom, ...]
    position: tuple[float, float, float]
    quaternion: tuple[float, float, float, float]
    size: tuple[float, float, float]
    """Extents of the object in its own frame, x, y, z [m]."""
    mass: float
    friction: float
    damage_force: float
    """F_dmg of this instance [N] (benchmark.md section 1)."""
    state: ObjectState = "empty"
    transparent: bool = False
    soft: bool = False
    """Round or compliant things: solref .01 and condim 6 instead of .004 and 4 (physics.md)."""
    parts: tuple[Part, ...] = ()
    """True parts in the object frame (positions relative to it)."""
    fixed: bool = False
    """Part of the set-up (the bin on its stand): a static body."""
    cavity: Cavity | None = None
    """Its hollow, if it is an open container."""


@dataclass(frozen=True)
class Particles:
    """Contents of a container as free spheres."""

    container: str
    radius: float
    mass: float
    positions: NDArray[np.float64]
    """World positions at the start (N, 3) [m]."""
    rgba: tuple[float, float, float, float] = (0.4, 0.2, 0.05, 1.0)


@dataclass(frozen=True)
class RequiredConstraint:
    """A constraint that the task requires, checked by measurement (benchmark.md section 3)."""

    kind: ConstraintKind
    target: str
    """Scene id of the protected neighbour, supported object, occluder or container."""


@dataclass(frozen=True)
class Task:
    """What the scene's task demands beyond the general definition of success."""

    target: str | None
    """Scene id of the object meant by the task's instruction."""
    instructions: tuple[str, ...]
    required: tuple[RequiredConstraint, ...] = ()
    side_grasp_of: str | None = None
    """Scene id of a tool to be gripped on its handle, 30-60 degrees off vertical, across the shaft (IT-d)."""
    kind: Literal["pick", "clear", "sort"] = "pick"


@dataclass(frozen=True)
class CameraDraw:
    """A camera's true pose and the pose that the robot is told, (4, 4) camera-to-world, OpenCV axes."""

    name: str
    true_pose: NDArray[np.float64]
    told_pose: NDArray[np.float64]
    width: int = 640
    height: int = 480
    fovy: float = 42.0
    """Vertical field of view [deg]."""


@dataclass(frozen=True)
class PlacedScene:
    name: str
    seed: int
    objects: tuple[PlacedObject, ...]
    particles: tuple[Particles, ...] = ()
    cameras: tuple[CameraDraw, ...] = ()
    light: tuple[float, float, float] = (0.2, -0.3, 1.0)
    """Direction towards the light."""
    ambient: float = 0.4
    table_rgba: tuple[float, float, float, float] = (0.72, 0.66, 0.58, 1.0)
    bin: tuple[tuple[float, float, float], tuple[float, float, float]] | None = None
    """Inside of the bin, lower and upper corner [m]."""
    task: Task | None = None
    noise: float = 1.0
    """Scale of camera noise."""
    extras: dict[str, float] = field(default_factory=dict)
