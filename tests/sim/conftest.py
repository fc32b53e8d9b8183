"""Simple placed objects for the tests of the physical world."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from kb.affordance import AffordanceDescriptor
from sim.placed import Geom, PlacedObject, PlacedScene

PLAIN = AffordanceDescriptor(type="GRASPABLE_BODY", material="wood", fragility=0.0, region="body")


def _thing(name: str, geom: Geom, position: tuple[float, float, float], size: tuple, **fields: Any) -> PlacedObject:
    values: dict[str, Any] = {
        "model": name, "category": name, "affordance": PLAIN, "geoms": (geom,), "position": position,
        "quaternion": (1.0, 0.0, 0.0, 0.0), "size": size, "mass": geom.mass, "friction": 0.6, "damage_force": 70.0,
    }  # fmt: skip
    return PlacedObject(id=name, **(values | fields))


@pytest.fixture(scope="session")
def cube() -> Callable[..., PlacedObject]:
    """Makes a wooden cube of 50 mm and 90 g."""

    def make(name: str = "cube", x: float = 0.5, y: float = 0.0, z: float = 0.0, *, half: float = 0.025, **fields: Any):
        mass = fields.pop("mass", 0.09)
        geom = Geom("box", (half, half, half), (0.0, 0.0, half), mass=mass)
        return _thing(name, geom, (x, y, z), (2 * half,) * 3, **fields)

    return make


@pytest.fixture(scope="session")
def can() -> Callable[..., PlacedObject]:
    """Makes an upright can of 66 mm, 18 cm high, 350 g."""

    def make(name: str = "can", x: float = 0.5, y: float = 0.0, z: float = 0.0, **fields: Any):
        geom = Geom("cylinder", (0.033, 0.09), (0.0, 0.0, 0.09), mass=0.35)
        return _thing(name, geom, (x, y, z), (0.066, 0.066, 0.18), **({"friction": 0.5, "soft": True} | fields))

    return make


@pytest.fixture(scope="session")
def ball() -> Callable[..., PlacedObject]:
    """Makes a ball of 65 mm and 58 g."""

    def make(name: str = "ball", x: float = 0.5, y: float = 0.0, z: float = 0.0, **fields: Any):
        geom = Geom("sphere", (0.0325,), (0.0, 0.0, 0.0325), mass=0.058)
        return _thing(name, geom, (x, y, z), (0.065,) * 3, **({"friction": 0.8, "soft": True} | fields))

    return make


@pytest.fixture(scope="session")
def scene() -> Callable[..., PlacedScene]:
    """Makes a placed scene of given objects."""

    def make(*things: PlacedObject, **fields: Any) -> PlacedScene:
        return PlacedScene("test", 0, things, **fields)

    return make
