"""Say from the robot's own sensing whether a grasp succeeded, and if not, which of the 14 failures it was.

Only observables are used: finger opening, motor force, wrist wrench, joint tracking, reach, and what further looks
showed (ledger G41). The list is walked in the order of time: the first anomalous event decides (physics.md, ledger G17).
"""

from __future__ import annotations

from kb.base import Noun
from kb.constraint import Constraints
from kb.percept import PerceivedObject, Percept
from kb.sensing import Evidence, Plan
from kb.vocabulary import FailureType
from tools.context import ToolContext
from tools.diagnosis.claim import doubts
from tools.diagnosis.first_anomaly import first_anomaly


class ClassifyArgs(Noun):
    """Arguments of `classify_failure`."""

    plan: Plan
    evidence: Evidence
    constraints: Constraints
    target: PerceivedObject
    """The target as it was perceived before the attempt."""
    percept: Percept
    """The look before the attempt."""


class Diagnosis(Noun):
    """The robot's own word on an attempt."""

    claimed: bool
    """It believes that it succeeded."""
    failure: FailureType | None
    confidence: float
    """How sure it is of claim or failure type, in [0, 1]."""
    reasons: tuple[str, ...]
    """The readings that decided, in words with numbers."""


def classify_failure(args: ClassifyArgs, context: ToolContext) -> Diagnosis:
    """Diagnoses one attempt.

    Args:
        args: Plan, evidence, constraints, and what was seen before.
        context: Unused; every tool has it.

    Returns:
        The claim of success, or the failure type with the readings that decided.
    """
    del context
    against = doubts(args.plan, args.evidence, args.constraints, args.target)
    if not against.all:
        sensed = args.evidence.sensing
        reason = (
            f"carried {sensed.load_end:.3f} kg through hold and shake, fingers at {1000 * sensed.aperture_end:.1f} mm, "
            f"raised {100 * sensed.lift_height:.0f} cm"
        )
        if args.evidence.places is not None and args.evidence.places.target == "empty":
            reason += ", and its place is empty"
        return Diagnosis(claimed=True, failure=None, confidence=0.98, reasons=(reason,))
    found = first_anomaly(args.plan, args.evidence, args.constraints, args.target, args.percept)
    return Diagnosis(
        claimed=False, failure=found.failure, confidence=found.confidence, reasons=(*found.reasons, *against.all[:2])
    )
