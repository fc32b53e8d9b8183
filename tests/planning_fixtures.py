"""Objects with parts and surface points, made by hand, for tests of planning and diagnosis."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np

from kb.experience import Experience, Funnel, Retrieval, RetrievedExperience, Strategy
from kb.percept import Part, PerceivedObject, Percept, pack_surface
from kb.switches import Switches
from sim.panda import READY
from tests.percept_fixtures import percept, thing
from tools.context import ToolContext


def context(**switches: Any) -> ToolContext:
    """A context with an arm at its ready pose and nothing else."""
    robot = SimpleNamespace(joints=READY, aperture=0.03)
    return ToolContext(robot=robot, switches=Switches.model_validate(switches), rng=np.random.default_rng(3))


def solid(object_id: str, category: str, x: float, y: float, yaw: float = 0.0, **changes: Any) -> PerceivedObject:
    """An object with points on the surface of its box or cylinder."""
    bare = thing(object_id, category, x, y, yaw=yaw, **changes)
    rng = np.random.default_rng(7)
    size = np.asarray(bare.size)
    if bare.shape in ("cylinder", "sphere", "bowl", "compound"):
        angle, height = rng.uniform(0, 2 * math.pi, 400), rng.uniform(-0.5, 0.5, 400)
        radius = size[0] / 2 * (np.sqrt(1 - 4 * height**2) if bare.shape == "sphere" else np.ones(400))
        local = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), height * size[2]])
    else:
        local = rng.uniform(-0.5, 0.5, (400, 3))
        local[np.arange(400), rng.integers(0, 3, 400)] = rng.choice([-0.5, 0.5], 400)
        local = local * size
    cosine, sine = math.cos(yaw), math.sin(yaw)
    turned = np.column_stack(
        [cosine * local[:, 0] - sine * local[:, 1], sine * local[:, 0] + cosine * local[:, 1], local[:, 2]]
    )
    surface = pack_surface(turned + np.asarray(bare.position), bare.position)
    return bare.model_copy(update={"surface": surface})


def cup(object_id: str, x: float, y: float, handle_at: float = 0.5) -> PerceivedObject:
    """A cup of 8 cm with its rim, its body and a handle towards the azimuth `handle_at` [rad]."""
    out = (math.cos(handle_at), math.sin(handle_at), 0.0)
    handle = Part(
        region="handle",
        centre=(x + 0.062 * out[0], y + 0.062 * out[1], 0.0475),
        axis=(0.0, 0.0, 1.0),
        width=0.011,
        length=0.055,
        radius=0.062,
        outward=out,
    )
    rim = Part(region="rim", centre=(x, y, 0.09), axis=(0.0, 0.0, 1.0), width=0.004, length=0.09, radius=0.04)
    body = Part(region="body", centre=(x, y, 0.045), axis=(0.0, 0.0, 1.0), width=0.08, length=0.09, radius=0.04)
    return solid(object_id, "cup", x, y, parts=(handle, rim, body))


def bottle(object_id: str, x: float, y: float) -> PerceivedObject:
    """A bottle of 7 x 22 cm with body and neck."""
    body = Part(region="body", centre=(x, y, 0.08), axis=(0.0, 0.0, 1.0), width=0.07, length=0.155, radius=0.035)
    neck = Part(region="neck", centre=(x, y, 0.20), axis=(0.0, 0.0, 1.0), width=0.034, length=0.04, radius=0.017)
    return solid(object_id, "bottle", x, y, parts=(body, neck))


def screwdriver(object_id: str, x: float, y: float, yaw: float) -> PerceivedObject:
    """A lying screwdriver of 20 cm whose handle is towards -axis."""
    axis = (math.cos(yaw), math.sin(yaw), 0.0)
    handle = Part(
        region="handle",
        centre=(x - 0.05 * axis[0], y - 0.05 * axis[1], 0.015),
        axis=axis,
        width=0.03,
        length=0.10,
    )
    return solid(object_id, "screwdriver", x, y, yaw, parts=(handle,))


def retrieved(experience: Experience, s_cat: float = 1.0, score: float = 0.9) -> RetrievedExperience:
    """A retrieved experience with plausible scores."""
    return RetrievedExperience(experience=experience, s_cat=s_cat, s_aff=0.9, s_vis=0.8, score=score)


def retrieval(*experiences: Experience) -> Retrieval:
    """A retrieval whose top is the given experiences; failures are also what to avoid."""
    top = tuple(retrieved(item) for item in experiences)
    funnel = Funnel(total=116, level1=30, level2=20, level3=len(top), fallback=False)
    return Retrieval(top=top, avoid=tuple(item for item in top if not item.experience.success), funnel=funnel)


def experience(entry_id: str, seen: PerceivedObject, *, success: bool = True, **strategy: Any) -> Experience:
    """An entry for the category of `seen` with the given strategy fields."""
    fields: dict[str, Any] = {
        "region": seen.affordance.region,
        "type": "pinch",
        "approach": "top",
        "tilt": 0.0,
        "force": 15.0,
        "force_band": (12.0, 18.0),
        "aperture": 0.08,
        "depth": 0.5,
    }
    return Experience(
        id=entry_id,
        category=seen.category,
        affordance=seen.affordance,
        size=seen.size,
        mass=sum(seen.mass) / 2,
        strategy=Strategy.model_validate(fields | strategy),
        success=success,
        n_trials=10,
        n_success=10 if success else 1,
        embedding=(1.0, 0.0),
        embedder="none",
        seeds=(0, 9),
    )


__all__ = [
    "Percept",
    "bottle",
    "context",
    "cup",
    "experience",
    "percept",
    "retrieval",
    "retrieved",
    "screwdriver",
    "solid",
]
