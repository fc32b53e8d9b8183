"""Perceive: look with the robot's cameras and report the objects on the table.

The verb only takes the pictures and hands them to the perceiver of the session: `tools.perception` (pixels alone) or
`tools.oracle_perception` (the truth, labelled so). It knows nothing of how either of them works.
"""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np

from kb.base import Noun, Vec3
from kb.percept import PerceivedObject, Percept
from kb.rgbd import RgbdView
from kb.vocabulary import PerceptionName

HANGING = 0.06
"""Height of the base above the table from which a thing may hang in the air [m]."""
RESTING = 0.03
"""A thing rests on another whose top is at most this far below its base [m]."""
HAND_REACH = 0.20
"""Horizontal distance from the tool point within which the hand and what it holds are seen [m]."""


class PerceiveArgs(Noun):
    """Arguments of `perceive`."""

    look: int = 0
    """Number of this look within the run, from 0."""
    previous: Percept | None = None
    """The look before, so that objects keep their ids."""
    nouns: tuple[str, ...] = ()
    """Categories that the instruction speaks of; they break ties between categories that look alike, never more."""


class Perceiver(Protocol):
    """Whatever turns pictures into a percept."""

    @property
    def name(self) -> PerceptionName: ...

    def perceive(self, views: tuple[RgbdView, ...], args: PerceiveArgs) -> Percept:
        """All objects seen in `views`."""
        ...


class Looker(Protocol):
    """The part of the robot that perception needs: its cameras, and the bin it was set up with."""

    @property
    def bin(self) -> tuple[Vec3, Vec3] | None: ...

    @property
    def holding(self) -> bool: ...

    @property
    def tool_point(self) -> Vec3: ...

    def look(self, rng: np.random.Generator, names: tuple[str, ...] = ("front", "top")) -> tuple[RgbdView, ...]:
        """One picture per named camera."""
        ...


class PerceiveContext(Protocol):
    """The part of the tool context that `perceive` uses."""

    @property
    def robot(self) -> Looker: ...

    @property
    def perceiver(self) -> Perceiver: ...

    @property
    def rng(self) -> np.random.Generator: ...


def perceive(args: PerceiveArgs, context: PerceiveContext) -> Percept:
    """Takes one picture per camera and reports every object seen on the table.

    Args:
        args: Number of the look, the look before, and the instruction's nouns.
        context: The session's robot, perceiver and random generator (camera noise).

    Returns:
        The percept, with the bin's place as the robot knows it from its set-up.
    """
    views = context.robot.look(context.rng)
    percept = context.perceiver.perceive(views, args)
    if percept.perception != "oracle" and context.robot.holding:
        percept = without_own_hand(percept, context.robot.tool_point)
    return percept.model_copy(update={"bin": context.robot.bin})


def without_own_hand(percept: Percept, tool_point: Vec3) -> Percept:
    """The percept without what hangs in the air around the robot's own hand: the hand's edges, and what it holds.

    What is held is known to the agent already; seen once more as an unknown thing, it would block the place that it came
    from. A thing hangs if its base is above the table and no other thing reaches up to it.

    Args:
        percept: As seen.
        tool_point: Point between the finger pads [m].
    """

    def hangs(obj: PerceivedObject) -> bool:
        if obj.base_z < HANGING or math.dist(obj.position[:2], tool_point[:2]) > HAND_REACH:
            return False
        return all(
            other.id == obj.id or other.top_z < obj.base_z - RESTING or other.base_z >= HANGING
            for other in percept.objects
        )

    kept = tuple(obj for obj in percept.objects if not hangs(obj))
    return percept if len(kept) == len(percept.objects) else percept.model_copy(update={"objects": kept})
