"""A way of grasping that is to be tried: sensible or deliberately bad."""

from __future__ import annotations

from importlib import resources
from typing import Annotated

import yaml
from pydantic import Field

from kb.base import Finite, Noun
from kb.experience import ApproachClass
from kb.vocabulary import GraspType, Region


class Recipe(Noun):
    """How to hold an object, before anything is known of where it stands."""

    name: str
    """Short words for people, e.g. "rim, straight down"."""
    region: Region
    type: GraspType
    approach: ApproachClass
    tilt: Finite = 0.0
    """Wanted angle between the approach and straight down [deg]."""
    force: Annotated[float, Field(ge=1.0, le=70.0)]
    """Middle of the forces tried [N]."""
    depth: Finite | None = None
    """Height of the tool point above the object's base over its height; None: as geometry proposes."""
    aperture: Finite | None = None
    """Opening [m]; None: local width plus a margin."""
    aside: Finite = 0.0
    """Shift along the object's longer axis, as a share of its length: deliberately off the middle."""
    turn: Finite = 0.0
    """Turn of the closing axis [deg]: deliberately askew."""
    speed: Annotated[float, Field(ge=0.1, le=1.0)] = 1.0
    good: bool = True
    """Meant to succeed; physics decides."""


class CategoryPlan(Noun):
    """How many entries a category gets, and what is tried for them, in order."""

    category: str
    models: tuple[str, ...]
    """Catalogue models; entries take turns."""
    entries: Annotated[int, Field(ge=1)]
    failures: Annotated[int, Field(ge=0)]
    """How many of the entries must be failures (ledger G12)."""
    recipes: tuple[Recipe, ...]


def category_plans() -> tuple[CategoryPlan, ...]:
    """All categories of the knowledge base, in the order of ledger G12."""
    text = resources.files("tools.experience").joinpath("recipes.yaml").read_text(encoding="utf-8")
    rows = yaml.safe_load(text)["categories"]
    return tuple(CategoryPlan.model_validate(row) for row in rows)
