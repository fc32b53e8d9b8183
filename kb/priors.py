"""General knowledge per category: what one may expect of a cup before measuring it (Table I; not the scene's truth).

No sizes: those are measured, never looked up by category.
"""

from __future__ import annotations

from functools import cache
from importlib import resources
from typing import Any

import yaml

from kb.affordance import AffordanceDescriptor
from kb.base import Finite, Noun
from kb.taxonomy import superclass
from kb.vocabulary import Material

Interval = tuple[Finite, Finite]


class CategoryPrior(Noun):
    """What is expected of an object of a category."""

    category: str
    superclass: str | None
    affordance: AffordanceDescriptor
    """Descriptor of Table I."""
    mass: Interval
    """Ordinary masses [kg]."""
    friction: Interval
    """Plausible friction coefficients of its material against the pads."""
    colours: tuple[str, ...] = ("any",)
    """Plausible colour names; "any" if colour says nothing."""
    container: bool = False
    """It is hollow and open, and may be filled."""
    stemmed: bool = False
    """It stands on a stem."""


class _Facts(Noun):
    friction: dict[Material, Interval]
    density: dict[Material, Interval]
    categories: dict[str, dict[str, Any]]


@cache
def _facts() -> _Facts:
    text = resources.files("kb").joinpath("data", "priors.yaml").read_text(encoding="utf-8")
    return _Facts.model_validate(yaml.safe_load(text))


@cache
def prior(category: str) -> CategoryPrior:
    """The prior of `category`; for one outside the table ("unknown" among them) a careful generic prior.

    The generic prior is GRASPABLE_BODY of mixed material, fragility 0.3 (as a ceramic thing: careful without being
    useless), 0.03-0.6 kg.
    """
    row = _facts().categories.get(category)
    if row is None:
        affordance = AffordanceDescriptor(type="GRASPABLE_BODY", material="mixed", fragility=0.3, region="body")
        return CategoryPrior(
            category=category,
            superclass=superclass(category),
            affordance=affordance,
            mass=(0.03, 0.6),
            friction=friction("mixed"),
        )
    kind, material, fragility, region = row["affordance"]
    affordance = AffordanceDescriptor(type=kind, material=material, fragility=fragility, region=region)
    return CategoryPrior(
        category=category,
        superclass=superclass(category),
        affordance=affordance,
        mass=tuple(row["mass"]),
        friction=friction(affordance.material),
        colours=tuple(row.get("colours", ("any",))),
        container=bool(row.get("container", False)),
        stemmed=bool(row.get("stemmed", False)),
    )


def friction(material: Material) -> Interval:
    """Plausible friction coefficients of `material` against the finger pads."""
    return _facts().friction[material]


def density(material: Material) -> Interval:
    """Plausible mean density of things of `material`, hollows included [kg/m^3]."""
    return _facts().density[material]
