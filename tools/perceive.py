"""Perceive: look with the robot's cameras and report the objects on the table.

The verb only takes the pictures and hands them to the perceiver of the session: `tools.perception` (pixels alone) or
`tools.oracle_perception` (the truth, labelled so). It knows nothing of how either of them works.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from kb.base import Noun, Vec3
from kb.percept import Percept
from kb.rgbd import RgbdView
from kb.vocabulary import PerceptionName


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
    return percept.model_copy(update={"bin": context.robot.bin})
