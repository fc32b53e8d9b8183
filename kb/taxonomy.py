"""Categories known to the system and their superclasses (ledger G12-G14): data, read from `kb/data/taxonomy*.yaml`.

Nouns, synonyms and plurals of what people say are the parser's business, not this file's.
"""

from __future__ import annotations

from functools import cache
from importlib import resources
from typing import Literal

import yaml

from kb.base import Noun
from kb.errors import BadInputError
from kb.vocabulary import UNKNOWN_CATEGORY

CATEGORIES: tuple[str, ...] = (
    "cup",
    "mug",
    "apple",
    "bottle",
    "banana",
    "bowl",
    "cube",
    "vase",
    "wine_glass",
    "screwdriver",
    "smartphone",
    "tennis_ball",
    "block",
    "box",
    "pen",
    "key",
    "bin",
)
"""The categories that perception and the knowledge base know (ledger G12, G13)."""

TaxonomyName = Literal["known", "blind"]
"""`known`: as in ledger G14; `blind`: without the names that the far-out-of-distribution queries use."""

_FILES: dict[TaxonomyName, str] = {"known": "taxonomy.yaml", "blind": "taxonomy_blind.yaml"}


class Taxonomy(Noun):
    """A versioned partition of category names into superclasses."""

    version: str
    superclasses: dict[str, tuple[str, ...]]

    def superclass(self, category: str) -> str | None:
        """The superclass of `category`, or None if it has none."""
        for name, members in self.superclasses.items():
            if category in members:
                return name
        return None

    def same_superclass(self, one: str, other: str) -> bool:
        """Whether the two categories share a superclass; a category without one is like nothing but itself."""
        if one == other:
            return True
        found = self.superclass(one)
        return found is not None and found == self.superclass(other)

    def s_cat(self, query: str, entry: str) -> float:
        """Category score of level 1: 1.0 exact, 0.5 same superclass, else 0 (ledger A2.2)."""
        if UNKNOWN_CATEGORY in (query, entry):
            return 0.0  # two things that nobody can name have nothing in common by that
        if query == entry:
            return 1.0
        return 0.5 if self.same_superclass(query, entry) else 0.0


@cache
def taxonomy(name: TaxonomyName = "known") -> Taxonomy:
    """Reads the taxonomy `name` once.

    Raises:
        BadInputError: if there is no such taxonomy, or a category stands in two superclasses.
    """
    if name not in _FILES:
        raise BadInputError(f"there is no taxonomy {name!r}", choices=_FILES)
    text = resources.files("kb").joinpath("data", _FILES[name]).read_text(encoding="utf-8")
    read = Taxonomy.model_validate(yaml.safe_load(text))
    seen: dict[str, str] = {}
    for superclass_name, members in read.superclasses.items():
        for member in members:
            if member in seen:
                what = f"{member!r} stands in {seen[member]!r} and in {superclass_name!r}"
                raise BadInputError(what, where=_FILES[name])
            seen[member] = superclass_name
    return read


def superclass(category: str) -> str | None:
    """Superclass of `category` in the known taxonomy, or None."""
    return taxonomy().superclass(category)


def same_superclass(one: str, other: str) -> bool:
    """Whether two categories are equal or share a superclass in the known taxonomy."""
    return taxonomy().same_superclass(one, other)
