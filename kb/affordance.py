"""The four-dimensional affordance descriptor a = (type, mat, frag, reg) of Sec. III-A."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from kb.base import Noun
from kb.vocabulary import AffordanceType, Material, Region

Fragility = Annotated[float, Field(ge=0.0, le=1.0)]


class AffordanceDescriptor(Noun):
    """What an object affords, as perceived or as stored with an experience."""

    type: AffordanceType
    """Primary affordance type."""
    material: Material
    """Main material."""
    fragility: Fragility
    """0 = durable, 1 = breaks at a touch."""
    region: Region
    """Where it is meant to be grasped."""


FRAGILE_NEIGHBOUR = 0.5
"""Objects at least this fragile count as fragile neighbours (ledger G8; Table I: vase .8, glass .9, phone .5)."""
