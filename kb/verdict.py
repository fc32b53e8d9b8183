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
    slip_lift_m: Finite = 0.0
    """Part of the slip that happened while the object was lifted."""
    slip_hold_m: Finite = 0.0
    """Slip from the end of the lift on, while it was held and shaken."""


class ObservedAttempt(Noun):
    """The observer's record of one motion."""

    verdict: Verdict
    success: bool
    failure: FailureType | None
    """Label of the first anomalous event in time."""
    lift_success: bool = False
    """Weaker than `success`, comparable with literature: the right object was raised 10 cm and not lost."""
    affordance_correct: bool = False
    """The pads closed on the annotated region."""
    strict: bool = False
    """`success`, on the annotated region, and no required constraint violated."""
