"""Made-up lessons."""

from __future__ import annotations

from functools import cache
from typing import Any

from kb.experience import Strategy
from kb.lesson import Lesson
from kb.priors import prior
from kb.store import ExperienceStore
from kb.store_file import StoreHeader


@cache
def header() -> StoreHeader:
    """Header of the shipped knowledge base."""
    return ExperienceStore.open().header


def make_lesson(category: str = "cup", *, like: str = "cup", success: bool = True, **changes: Any) -> Lesson:
    """A lesson about an object with the descriptor of `like`, held at its region from above."""
    descriptor = prior(like).affordance
    strategy = Strategy(
        region=descriptor.region, type="pinch", approach="top", tilt=0.0, force=12.0, force_band=(12.0, 12.0),
        aperture=0.06, depth=0.5,
    )  # fmt: skip
    one = sum(map(ord, category)) % header().dim
    vector = tuple(float(i == one) for i in range(header().dim))
    row = {
        "category": category, "affordance": descriptor, "size": (0.08, 0.08, 0.09), "mass": 0.2, "strategy": strategy,
        "place": (0.5, 0.0), "yaw": 0.0, "claimed": success, "confirmed": success,
        "failure": None if success else "SLIP", "embedding": vector, "embedder": header().embedder, **changes,
    }  # fmt: skip
    return Lesson.model_validate(row)
