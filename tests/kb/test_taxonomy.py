"""The taxonomy file and its blind twin."""

from __future__ import annotations

import pytest

from kb.errors import BadInputError
from kb.taxonomy import CATEGORIES, same_superclass, superclass, taxonomy

FAR_NAMES = {"thermos", "can", "jar", "hammer", "knife", "brush", "remote", "egg", "bulb", "plate"}


def test_the_taxonomy_has_the_superclasses_of_the_ledger() -> None:
    """Ten superclasses (ledger G14) with 39 names in all, each in one superclass."""
    classes = taxonomy().superclasses
    assert set(classes) == {
        "drinkware", "glassware", "container", "dish", "fruit", "block", "tool", "electronics", "ball", "small",
    }  # fmt: skip
    names = [name for members in classes.values() for name in members]
    assert len(names) == len(set(names)) == 39


def test_blind_is_known_without_the_far_names() -> None:
    """The blind file differs from the known one by exactly the ten far-out-of-distribution names."""
    known = {name for members in taxonomy("known").superclasses.values() for name in members}
    blind = {name for members in taxonomy("blind").superclasses.values() for name in members}
    assert known - blind == FAR_NAMES
    assert blind <= known
    assert taxonomy("known").version != taxonomy("blind").version


@pytest.mark.parametrize("category", [name for name in CATEGORIES if name != "bin"])
def test_every_category_but_the_bin_has_a_superclass(category: str) -> None:
    """Every graspable category stands in the known and in the blind taxonomy."""
    assert superclass(category) is not None
    assert taxonomy("blind").superclass(category) == superclass(category)


def test_category_scores_are_one_half_and_zero() -> None:
    """Exact 1, same superclass 0.5, unrelated 0 (ledger A2.2); a class outside the taxonomy matches only itself."""
    scores = [taxonomy().s_cat(one, other) for one, other in (("mug", "mug"), ("mug", "cup"), ("mug", "vase"))]
    assert scores == [1.0, 0.5, 0.0]
    assert taxonomy().s_cat("teapot", "teapot") == 1.0
    assert not same_superclass("teapot", "samovar")
    assert same_superclass("vase", "wine_glass")


def test_an_unknown_taxonomy_is_refused() -> None:
    """The message names the two that exist."""
    with pytest.raises(BadInputError, match="known, blind"):
        taxonomy("other")  # type: ignore[arg-type]
