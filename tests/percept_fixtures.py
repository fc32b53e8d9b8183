"""Percepts made by hand, for tests of relations and constraints."""

from __future__ import annotations

import math

import numpy as np

from kb.percept import PerceivedObject, Percept, Shape, pack_surface
from kb.priors import prior

SIZES: dict[str, tuple[tuple[float, float, float], Shape]] = {
    "cup": ((0.08, 0.08, 0.09), "cylinder"),
    "mug": ((0.08, 0.08, 0.09), "cylinder"),
    "apple": ((0.08, 0.08, 0.08), "sphere"),
    "tennis_ball": ((0.066, 0.066, 0.066), "sphere"),
    "bottle": ((0.07, 0.07, 0.22), "cylinder"),
    "bowl": ((0.12, 0.12, 0.06), "bowl"),
    "cube": ((0.05, 0.05, 0.05), "box"),
    "block": ((0.04, 0.04, 0.04), "box"),
    "vase": ((0.08, 0.08, 0.15), "compound"),
    "wine_glass": ((0.07, 0.07, 0.20), "compound"),
    "smartphone": ((0.15, 0.07, 0.01), "plate"),
    "screwdriver": ((0.20, 0.03, 0.03), "bar"),
    "box": ((0.12, 0.10, 0.12), "box"),
    "key": ((0.06, 0.025, 0.006), "plate"),
}


def thing(object_id: str, category: str, x: float, y: float, base: float = 0.0, **changes: object) -> PerceivedObject:
    """An object of a category with its usual size at (x, y), its lowest point at height `base` [m]."""
    size, shape = SIZES[category]
    known = prior(category)
    fields: dict[str, object] = {
        "id": object_id,
        "category": category,
        "confidence": 1.0,
        "position": (x, y, base + size[2] / 2.0),
        "yaw": 0.0,
        "size": size,
        "shape": shape,
        "affordance": known.affordance,
        "mass": known.mass,
        "friction": known.friction,
    }
    return PerceivedObject.model_validate(fields | changes)


def leaning_plate(object_id: str, x: float, y: float, tilt: float) -> PerceivedObject:
    """A phone whose long side rises by `tilt` [rad] towards +x from its foot at (x, y) on the table."""
    along, across = np.meshgrid(np.linspace(0.0, 0.15, 16), np.linspace(-0.035, 0.035, 8))
    points = np.column_stack(
        [x + along.ravel() * math.cos(tilt), y + across.ravel(), 0.005 + along.ravel() * math.sin(tilt)]
    )
    low, high = points.min(axis=0), points.max(axis=0)
    low[2] = 0.0
    centre = tuple(float(v) for v in (low + high) / 2.0)
    size = tuple(float(v) for v in high - low)
    swap = size[1] > size[0]
    return thing(
        object_id,
        "smartphone",
        x,
        y,
        position=centre,
        size=(size[1], size[0], size[2]) if swap else size,
        yaw=math.pi / 2 if swap else 0.0,
        shape="plate",
        surface=pack_surface(points, (centre[0], centre[1], centre[2])),
    )


def percept(*objects: PerceivedObject) -> Percept:
    """The first look at these objects."""
    return Percept(look=0, perception="rgbd", objects=objects)
