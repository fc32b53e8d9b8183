"""One proven grasp in episodic memory M = {(c_j, g*_j)} (Sec. IV-C): how an object was grasped, not where it stood."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from kb.affordance import AffordanceDescriptor
from kb.base import Finite, Noun
from kb.vocabulary import GraspType, Region

Share = Annotated[float, Field(ge=0.0, le=1.0)]


class MemoryItem(Noun):
    """The parameters of a grasp that the robot itself believes to have succeeded."""

    category: str
    """Category of the object, as perceived."""
    affordance: AffordanceDescriptor
    """Its descriptor, as perceived."""
    superclass: str | None = None
    """Superclass of the category; given by whoever remembers, so that memory needs no taxonomy."""
    region: Region
    """Region that was gripped."""
    type: GraspType
    tilt: Finite
    """Angle between the approach and straight down [rad]."""
    force: Finite
    """Force per finger [N]."""
    depth: Share
    """Height of the tool point above the object's lowest point over the object's height."""
    aperture: Finite
    """Opening before closing [m]."""
    width: Finite | None = None
    """Opening at which the fingers came to rest [m]."""
    standoff: Finite = 0.10
    speed: Finite = 1.0
    mass: Finite | None = None
    """Mass sensed while it was carried [kg]."""
    attempts: Annotated[int, Field(ge=1)] = 1
    """Attempts it took until this grasp."""
    order: Annotated[int, Field(ge=0)] = 0
    """Running number within the session: of two equally fitting items the later one counts."""
    source: str = ""
    """Which run and goal it comes from, for provenance ("goal 0, attempt 1")."""
