"""What planning takes from an episodic memory, without knowing the memory itself."""

from __future__ import annotations

from typing import Any

from kb.base import Finite, Noun
from kb.vocabulary import GraspType, Region

FIELDS = ("region", "type", "tilt", "force", "depth", "aperture", "standoff", "speed", "mass", "source", "category")


class RememberedGrasp(Noun):
    """Parameters of a grasp that worked earlier in this episode (ledger A6, G22)."""

    category: str = ""
    """Category with which it worked; its mass counts for that category only."""
    region: Region
    type: GraspType
    tilt: Finite
    """Angle between the approach and straight down [rad]."""
    force: Finite
    """[N]."""
    depth: Finite
    """Height of the tool point above the object's lowest point over the object's height."""
    aperture: Finite = 0.08
    """[m]."""
    standoff: Finite = 0.10
    speed: Finite = 1.0
    mass: Finite | None = None
    """Mass sensed while it was carried [kg]."""
    source: str = "earlier success"
    """For provenance."""

    @classmethod
    def of(cls, item: Any) -> Any:
        """Takes the fields from anything that carries them (an item of the episodic memory); else passes it through."""
        if item is None or isinstance(item, cls | dict):
            return item  # pyright: ignore[reportUnknownVariableType]
        if not hasattr(item, "region"):
            return item
        values = {name: getattr(item, name) for name in FIELDS if hasattr(item, name)}
        values["source"] = values.get("source") or "earlier success"
        return cls.model_validate(values)
