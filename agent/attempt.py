"""H, the history of attempts (Algorithm 1), and what is in the hand now."""

from __future__ import annotations

from pydantic import Field

from kb.base import Noun, Vec3
from kb.constraint import Constraints
from kb.percept import PerceivedObject, Percept
from kb.run_result import Level
from kb.sensing import CameraEvidence, Correction, PlaceEvidence, Plan, Sensing
from kb.vocabulary import FailureType


class Attempt(Noun):
    """One executed grasp, with all the agent knew and sensed. Nothing of the observer is in here."""

    number: int
    """Counts over the whole conversation, from 0."""
    turn: int
    """Number of the instruction it was made for."""
    goal: int
    """Index of the goal within the turn."""
    level: Level
    plan: Plan
    target: PerceivedObject
    """The target as it was perceived before the attempt."""
    percept: Percept | None = None
    """The look that the attempt was planned on."""
    constraints: Constraints = Field(default_factory=Constraints)
    sensing: Sensing
    camera: CameraEvidence | None = None
    places: PlaceEvidence | None = None
    """What a look showed while something was still in the hand."""
    claimed: bool = False
    failure: FailureType | None = None
    confidence: float = 1.0
    reasons: tuple[str, ...] = ()
    correction: Correction | None = None
    """The correction that led to this attempt."""
    thought: str = ""
    motion: int = 0
    """Number of the motion; the observer's recordings are kept by it."""
    before: bytes = b""
    """Opaque snapshot of the world before the motion, for simulating what would have happened."""

    @property
    def stopped(self) -> bool:
        """Whether a person stopped it: an outcome of its own."""
        return self.sensing.stopped_by == "stop"


def in_hand(attempt: Attempt) -> PerceivedObject:
    """What the attempt left in the hand: the target, unless its own look shows that another thing was taken."""
    places = attempt.places
    if places is None or attempt.percept is None or not places.is_other or len(places.emptied) != 1:
        return attempt.target
    return attempt.percept.object(places.emptied[0])


KEPT_ATTEMPTS, KEPT_MOMENTS = 24, 6
"""Attempts of earlier turns that are kept, and attempts whose saved moment is: every checkpoint holds them all."""


def add_attempts(old: tuple[Attempt, ...], new: tuple[Attempt, ...]) -> tuple[Attempt, ...]:
    """Reducer of H: attempts in order of their numbers; one that comes again (with its diagnosis) replaces the former.

    The turn in work keeps all of its attempts; of earlier turns the latest are kept, and only of the last few the moment
    before them and the look they were planned on.
    """
    if not new:
        return old
    numbers = {attempt.number: attempt for attempt in (*old, *new)}
    kept = [numbers[number] for number in sorted(numbers)]
    turn = kept[-1].turn
    earlier = [a for a in kept if a.turn != turn][-KEPT_ATTEMPTS:]
    kept = [*earlier, *(a for a in kept if a.turn == turn)]
    return tuple(_lighter(a, turn) for a in kept[:-KEPT_MOMENTS]) + tuple(kept[-KEPT_MOMENTS:])


def _lighter(attempt: Attempt, turn: int) -> Attempt:
    """The attempt without its saved moment and, unless its own turn still needs them, without look and pictures' traces."""
    if attempt.turn == turn:
        return attempt if not attempt.before else attempt.model_copy(update={"before": b""})
    if not attempt.before and attempt.percept is None and not attempt.target.surface:
        return attempt
    target = attempt.target.model_copy(update={"surface": b"", "embedding": ()})
    return attempt.model_copy(update={"before": b"", "percept": None, "target": target})


class Held(Noun):
    """What the agent believes to be in the hand."""

    plan: Plan
    object: PerceivedObject
    """The object as it stood before it was taken."""
    category: str
    load: float = 0.0
    """Mass sensed by the wrist [kg]."""
    motion: int = 0
    """Number of the motion that took it."""
    handed_over: bool = False


class Moved(Noun):
    """The thing that was put somewhere last: the next look finds it elsewhere."""

    id: str
    category: str
    origin: Vec3
    """Where it stood before it was taken [m]."""
