"""What one trial teaches: a strategy that was carried out on a perceived object, and what the robot itself sensed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated

from pydantic import Field

from kb.affordance import AffordanceDescriptor
from kb.base import Finite, Noun, Vec2, Vec3
from kb.experience import Strategy
from kb.vocabulary import FailureType

APART = 0.03
"""Positions nearer than this [m] are one pose, unless the object is turned."""
TURNED = math.radians(20.0)
"""Turned by at least this [rad], the same place counts as another pose."""


class Lesson(Noun):
    """One outcome. Nothing of the observer is in here."""

    category: str
    """As perceived."""
    affordance: AffordanceDescriptor
    size: Vec3
    mass: Finite
    """As the wrist weighed it [kg]; 0 where nothing was lifted."""
    strategy: Strategy
    place: Vec2
    """Where the object stood [m]."""
    yaw: Finite
    """How it stood [rad]."""
    claimed: bool
    """The robot's own word after the first lift."""
    confirmed: bool
    """Its word after setting down and lifting again; False where it did not come to that."""
    failure: FailureType | None = None
    """Its diagnosis where it did not claim success."""
    used: str | None = None
    """Id of the experience that the strategy came from, if it did."""
    embedding: tuple[Finite, ...] = ()
    embedder: str
    seed: Annotated[int, Field(ge=0)] = 0
    """Seed of the trial's world."""

    @property
    def success(self) -> bool:
        """Claimed, and confirmed by a second lift."""
        return self.claimed and self.confirmed

    @property
    def key(self) -> str:
        """What is learnt about: lessons with the same key speak about the same way of holding the same kind of thing."""
        s = self.strategy
        kind = self.category if self.category != "unknown" else f"unknown-{self.affordance.type.lower()}"
        return f"learnt-{kind}-{s.region}-{s.type}-{s.approach}"


def distinct_poses(lessons: Sequence[Lesson]) -> list[Lesson]:
    """Of these lessons as many, in order, as were made in poses apart from one another."""
    kept: list[Lesson] = []
    for lesson in lessons:
        if all(_apart(lesson, other) for other in kept):
            kept.append(lesson)
    return kept


def _apart(one: Lesson, other: Lesson) -> bool:
    distance = math.dist(one.place, other.place)
    turn = abs((one.yaw - other.yaw + math.pi / 2) % math.pi - math.pi / 2)
    return distance >= APART or turn >= TURNED
