"""The public result of a run: one pydantic model whose keys are a promise (product.md)."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from kb.base import Finite, Noun, Vec3
from kb.grasp import GraspField, Provenance, Quality
from kb.verdict import Verdict
from kb.vocabulary import ConstraintKind, FailureType, GoalKind, GraspType, Relation

Level = Literal[0, 1, 2, 3]


class GraspRecord(Noun):
    """The executed grasp (see `kb.grasp.Grasp` for units and frames)."""

    position: Vec3
    approach: Vec3
    yaw: Finite
    aperture: Finite
    force: Finite
    type: GraspType
    standoff: Finite
    speed: Finite


class AttemptRecord(Noun):
    """One attempt: what was tried, what the robot sensed and claimed, what the observer saw."""

    level: Level
    grasp: GraspRecord | None
    provenance: dict[GraspField, tuple[Provenance, ...]] = Field(
        default_factory=dict[GraspField, tuple[Provenance, ...]]
    )
    quality: Quality | None = None
    success: bool
    """The observer's word (on hardware without an observer: `claimed`)."""
    claimed: bool
    """The agent's own word, from its sensing."""
    failure: FailureType | None
    """The agent's diagnosis."""
    evidence: dict[str, Any] = Field(default_factory=dict)
    correction: dict[str, Any] | None = None
    """The correction that led to this attempt."""
    observed_failure: FailureType | None
    verdict: Verdict | None
    region: str | None = None
    """Region that was gripped (extra key)."""


class GoalRecord(Noun):
    kind: GoalKind
    target: str | None
    """Perceived id of the object meant."""
    object: str | None
    """Scene id of the thing meant, matched afterwards by the observer."""
    success: bool
    claimed: bool = False
    parent: int | None = None
    verdict: Verdict | None
    attempts: tuple[AttemptRecord, ...] = ()
    note: str = ""


class ConstraintRecord(Noun):
    kind: ConstraintKind
    target: str
    required: bool
    inferred: bool
    satisfied: bool
    measured: dict[str, Any] = Field(default_factory=dict)


class ExperienceRecord(Noun):
    id: str
    category: str
    s_cat: float
    s_aff: float
    s_vis: float
    score: float
    success: bool


class EdgeRecord(Noun):
    source: str
    relation: Relation
    target: str


class GraphRecord(Noun):
    nodes: tuple[dict[str, Any], ...] = ()
    edges: tuple[EdgeRecord, ...] = ()


class Timings(Noun):
    """Wall-clock seconds; the only place where wall times stand."""

    perception: float = 0.0
    retrieval: float = 0.0
    planning: float = 0.0
    execution: float = 0.0
    brain: float = 0.0
    total: float = 0.0


class ModelUse(Noun):
    """How a language model took part in a run; all zero with the rules brain."""

    calls: int = 0
    """Questions that were answered."""
    prompt_tokens: int = 0
    completion_tokens: int = 0
    refusals: int = 0
    """Replies that did not pass the gate."""
    faults: int = 0
    """Questions to which no reply came."""
    fallbacks: tuple[str, ...] = ()
    """Where the rules decided instead, and why, in order."""
    contradictions: int = 0
    """Names and relations that a model gave and that measuring contradicts: dropped."""

    def plus(self, other: ModelUse) -> ModelUse:
        """Both together."""
        if other == NO_USE:
            return self
        return ModelUse(
            calls=self.calls + other.calls,
            prompt_tokens=self.prompt_tokens + other.prompt_tokens,
            completion_tokens=self.completion_tokens + other.completion_tokens,
            refusals=self.refusals + other.refusals,
            faults=self.faults + other.faults,
            fallbacks=(*self.fallbacks, *other.fallbacks),
            contradictions=self.contradictions + other.contradictions,
        )


NO_USE = ModelUse()
"""No model was asked."""


class RunResult(Noun):
    """What `ragvlm run --json` writes and `Agent.run` returns."""

    schema_version: Literal[1] = 1
    instruction: str
    scene: str
    seed: int
    configuration: str
    brain: str
    perception: str
    evaluator: str
    executed: bool
    success: bool
    answer: str
    question: str | None = None
    goals: tuple[GoalRecord, ...] = ()
    constraints: tuple[ConstraintRecord, ...] = ()
    experiences: tuple[ExperienceRecord, ...] = ()
    scene_graph: GraphRecord = Field(default_factory=GraphRecord)
    damage_events: int = 0
    """Objects that came to harm in any motion of the turn, by the observer."""
    timings_s: Timings = Field(default_factory=Timings)
    funnel: dict[str, Any] = Field(default_factory=dict)
    """Counts of the retrieval funnel (extra key)."""
    model_use: ModelUse = Field(default_factory=ModelUse)
    """The part of a language model in the run (extra key)."""
