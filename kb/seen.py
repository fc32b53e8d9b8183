"""What a model says it sees in a picture with numbered marks: names, affordances, states and relations, no measures."""

from __future__ import annotations

from pydantic import Field

from kb.affordance import Fragility
from kb.base import Noun
from kb.vocabulary import AffordanceType, Material, ObjectState, Region, Relation


class NamedObject(Noun):
    """One marked object as a model names it."""

    id: str
    """Perceived id of the mark."""
    category: str
    affordance: AffordanceType
    material: Material
    fragility: Fragility
    region: Region
    state: ObjectState = "empty"


class SaidRelation(Noun):
    """`source relation target`, as a model sees it."""

    source: str
    relation: Relation
    target: str


class Seen(Noun):
    """Everything that a model says about one look. Empty: it adds nothing to what was measured."""

    objects: tuple[NamedObject, ...] = ()
    relations: tuple[SaidRelation, ...] = Field(default=())
