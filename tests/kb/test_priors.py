"""General knowledge per category."""

from __future__ import annotations

import pytest

from kb.priors import density, friction, prior
from kb.taxonomy import CATEGORIES
from kb.vocabulary import MATERIALS

TABLE_I = {
    "cup": ("GRASPABLE_HANDLE", "ceramic", 0.3, "handle"),
    "apple": ("WRAPPABLE", "organic", 0.1, "body"),
    "bottle": ("GRASPABLE_BODY", "plastic", 0.1, "body"),
    "banana": ("WRAPPABLE", "organic", 0.2, "body"),
    "bowl": ("GRASPABLE_EDGE", "ceramic", 0.3, "rim"),
    "cube": ("GRASPABLE_BODY", "wood", 0.0, "body"),
    "vase": ("FRAGILE", "glass", 0.8, "neck"),
    "wine_glass": ("FRAGILE", "glass", 0.9, "stem"),
    "screwdriver": ("TOOL_HANDLE", "metal", 0.0, "handle"),
    "smartphone": ("CLAMPABLE", "mixed", 0.5, "edge"),
    "tennis_ball": ("WRAPPABLE", "fabric", 0.0, "body"),
    "block": ("GRASPABLE_BODY", "plastic", 0.0, "body"),
}
MASSES = {
    "cup": 0.30, "apple": 0.18, "bottle": 0.35, "banana": 0.12, "bowl": 0.35, "cube": 0.09, "vase": 0.50,
    "wine_glass": 0.15, "screwdriver": 0.15, "smartphone": 0.19, "tennis_ball": 0.058, "block": 0.04,
}  # fmt: skip
FRICTIONS = {
    "ceramic": 0.5, "glass": 0.4, "plastic": 0.5, "wood": 0.6, "metal": 0.4, "organic": 0.6, "fabric": 0.8, "mixed": 0.5,
}  # fmt: skip


@pytest.mark.parametrize(("category", "row"), TABLE_I.items())
def test_descriptors_are_those_of_table_one(category: str, row: tuple[str, str, float, str]) -> None:
    """Type, material, fragility and region of the twelve objects are the paper's."""
    affordance = prior(category).affordance
    assert (affordance.type, affordance.material, affordance.fragility, affordance.region) == row


@pytest.mark.parametrize(("category", "mass"), MASSES.items())
def test_mass_ranges_hold_what_the_benchmark_draws(category: str, mass: float) -> None:
    """The plausible masses include the benchmark's nominal mass +- 20 %."""
    low, high = prior(category).mass
    assert low <= 0.83 * mass
    assert high >= 1.18 * mass


@pytest.mark.parametrize(("material", "mu"), FRICTIONS.items())
def test_friction_ranges_hold_what_the_benchmark_draws(material: str, mu: float) -> None:
    """The plausible friction includes the benchmark's nominal value +- 20 %."""
    low, high = friction(material)  # type: ignore[arg-type]
    assert low <= 0.8 * mu + 1e-9
    assert high >= 1.2 * mu - 1e-9


def test_every_category_and_material_has_ordered_positive_ranges() -> None:
    """No range is empty, reversed or touches zero."""
    ranges = [prior(category).mass for category in CATEGORIES]
    ranges += [friction(material) for material in MATERIALS] + [density(material) for material in MATERIALS]
    assert all(0.0 < low < high for low, high in ranges)


def test_an_unknown_category_gets_the_careful_prior() -> None:
    """Outside the table: body grasp, moderate fragility, and the name as asked."""
    generic = prior("teapot")
    assert (generic.category, generic.superclass, generic.affordance.type) == ("teapot", None, "GRASPABLE_BODY")
    assert 0.2 <= generic.affordance.fragility < 0.5
