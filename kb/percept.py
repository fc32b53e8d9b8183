"""What perception reports about a scene: objects with measured geometry and estimated properties.

World frame (robot base; table top z = 0), SI units. Nothing here is ground truth, unless `perception` says "oracle".
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from kb.affordance import AffordanceDescriptor
from kb.base import Finite, Noun, Vec3
from kb.vocabulary import ObjectState, PerceptionName, Region

SURFACE_UNIT = 1e-4
"""Quantisation of stored surface points [m]."""

Shape = Literal["box", "cylinder", "sphere", "bar", "plate", "bowl", "compound"]
"""Coarse geometric family: "bar" is long and slim, "plate" flat and thin, "bowl" open with a wall, "compound" the rest."""


class Part(Noun):
    """A part of an object that matters for grasping."""

    region: Region
    centre: Vec3
    """Centre of the part [m]. For a rim: the centre of the rim's circle at the height of its top edge."""
    axis: Vec3
    """Unit main axis: along a handle's or stem's bar, normal of a rim's circle, long axis of a body."""
    width: Finite
    """Local width to be gripped [m]: bar diameter (handle, stem, neck), wall thickness (rim), smaller horizontal
    extent (body, edge)."""
    length: Finite
    """Extent along `axis` [m]."""
    radius: Finite | None = None
    """Radius of the circle for a rim, neck, stem or round body [m]; for a loop handle: distance of the bar's centre from
    the body's axis."""
    outward: Vec3 | None = None
    """For a loop handle: horizontal unit vector from the body's axis to the handle."""
    confidence: float = 1.0


class PerceivedObject(Noun):
    """One object as perceived."""

    id: str
    """"obj_0", "obj_1", ... in a stable order (front-left to back-right); stays with the object over looks."""
    category: str
    """Most probable category, or "unknown"."""
    confidence: float
    """Calibrated probability of `category` (for "unknown": probability that no known category fits)."""
    posterior: dict[str, float] = Field(default_factory=dict)
    """Probability per known category, and under "unknown"; sums to 1."""
    position: Vec3
    """Centre of the upright oriented bounding box [m]."""
    yaw: Finite
    """Azimuth of the longer horizontal axis [rad], in (-pi/2, pi/2]."""
    size: Vec3
    """Extents of the box along its longer horizontal axis, shorter horizontal axis, and vertical [m]."""
    shape: Shape
    affordance: AffordanceDescriptor
    affordance_confidence: float = 1.0
    """How clearly the geometry says so, for an object of no known category; 1 where the category says it."""
    fragility_range: tuple[Finite, Finite] | None = None
    """Plausible fragility of an object of no known category; None where the category tells it."""
    state: ObjectState = "empty"
    transparent: bool = False
    colour: Vec3 = (0.5, 0.5, 0.5)
    """Mean colour, linear in [0, 1]."""
    colour_name: str = "grey"
    mass: tuple[float, float] = (0.05, 0.5)
    """Plausible range of the mass [kg]."""
    friction: tuple[float, float] = (0.3, 0.7)
    """Plausible range of the sliding friction coefficient against the finger pads."""
    parts: tuple[Part, ...] = ()
    visible_fraction: float = 1.0
    """Share of the silhouette seen by the front camera that is not hidden behind something else, estimated."""
    embedding: tuple[float, ...] = ()
    """Visual embedding of the masked crop (Embedder protocol)."""
    surface: bytes = b""
    """Observed surface points, int16 in units of `SURFACE_UNIT` relative to `position`, C order (N, 3)."""

    @property
    def base_z(self) -> float:
        """Height of the lowest point [m]."""
        return self.position[2] - self.size[2] / 2

    @property
    def top_z(self) -> float:
        """Height of the highest point [m]."""
        return self.position[2] + self.size[2] / 2

    def surface_points(self) -> NDArray[np.float64]:
        """Observed surface points in the world frame [m], shape (N, 3)."""
        steps = np.frombuffer(self.surface, dtype=np.int16).reshape(-1, 3)
        return steps.astype(np.float64) * SURFACE_UNIT + np.asarray(self.position)

    def part(self, region: Region) -> Part | None:
        """The part of that region, if one was seen (the most confident one)."""
        found = [part for part in self.parts if part.region == region]
        return max(found, key=lambda part: part.confidence) if found else None


def pack_surface(points: NDArray[np.float64], position: Vec3, limit: int = 600) -> bytes:
    """Quantises at most `limit` evenly chosen surface points (N, 3) [m] for `PerceivedObject.surface`."""
    chosen = points if len(points) <= limit else points[np.linspace(0, len(points) - 1, limit).astype(int)]
    return np.round((chosen - np.asarray(position)) / SURFACE_UNIT).astype(np.int16).tobytes()


class Percept(Noun):
    """All objects of one look at the scene."""

    look: int
    """Number of the look within the run, from 0."""
    perception: PerceptionName
    """Which perceiver made it; "oracle" reads the simulator's truth and must be labelled so wherever it is shown."""
    objects: tuple[PerceivedObject, ...]
    noise: Finite = 1.0
    """Depth noise of the pictures over the ordinary one, as measured in them; at least 1."""
    bin: tuple[Vec3, Vec3] | None = None
    """Lower and upper corner of the inside of the bin beside the table [m], known to the robot from its set-up."""

    def object(self, object_id: str) -> PerceivedObject:
        """The object of that id; KeyError if it was not seen."""
        for candidate in self.objects:
            if candidate.id == object_id:
                return candidate
        raise KeyError(object_id)
