"""What the independent observer says afterwards, from the true state. Nothing here may reach agent, tools or memory."""

from __future__ import annotations

from kb.base import Finite, Noun
from kb.vocabulary import FailureType


class Verdict(Noun):
    """Physical facts of one attempt (benchmark.md section 3)."""

    lifted_m: Finite
    held_s: Finite
    slip_m: Finite
    contact: bool
    aperture_m: Finite
    peak_force_n: Finite
    damage: tuple[str, ...] = ()
    """Scene ids of damaged objects."""
    disturbed: tuple[str, ...] = ()
    """Scene ids of other objects that were moved > 5 mm or tilted > 5 degrees."""
    correct_object: bool
    placed: bool | None = None
    """For a place goal: the object rests where it was to go."""


class ObservedAttempt(Noun):
    """The observer's record of one motion."""

    verdict: Verdict
    success: bool
    failure: FailureType | None
    """Label of the first anomalous event in time."""
