"""What a brain does: understand a person, name what is seen, think before an attempt, reflect on a failure, and answer.

Rules and language models implement the same protocol. A brain sees facts and returns typed values; it never touches
the robot, and whatever a brain other than the rules returns passes the gate of `agent.safety` before it counts.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Literal, Protocol

from pydantic import Field

from agent.attempt import Attempt, Held
from agent.goal import Goal, Understanding
from kb.base import Finite, Noun
from kb.constraint import Constraints
from kb.experience import Retrieval
from kb.grasp import GraspField
from kb.percept import PerceivedObject, Percept
from kb.rgbd import RgbdView
from kb.run_result import Level
from kb.scene_graph import SceneGraph
from kb.seen import Seen
from kb.sensing import Correction, Plan


class Refusal(Noun):
    """A reply that did not count, and why; the next prompt shows it as an observation."""

    reply: str
    reason: str


class Exchange(Noun):
    """One prompt and what came back, for the record."""

    role: str
    """What was asked for: "understand", "perceive", "think", "reflect" or "answer"."""
    version: str
    """Version of the prompts."""
    model: str
    messages: tuple[dict[str, Any], ...]
    """As sent; pictures by content hash."""
    reply: str
    fault: str | None = None
    """Why there is no reply: a fault of the server or the model."""
    prompt_tokens: int = 0
    completion_tokens: int = 0


def _nobody(_exchange: Exchange) -> None:
    """The default listener."""


def unheard(_reply: str) -> None:
    """The default listener to a reply that is being made."""


@dataclass(frozen=True)
class Situation:
    """The facts a brain may use. What is not known yet is None or empty."""

    instruction: str = ""
    goals: tuple[Goal, ...] = ()
    goal: Goal | None = None
    percept: Percept | None = None
    graph: SceneGraph | None = None
    retrieval: Retrieval | None = None
    constraints: Constraints = field(default_factory=Constraints)
    plan: Plan | None = None
    level: Level = 0
    correction: Correction | None = None
    """The correction that the next attempt applies."""
    pending: Goal | None = None
    """The goal that the last question back was about."""
    attempts: tuple[Attempt, ...] = ()
    """H: all attempts of the conversation."""
    tries: tuple[Attempt, ...] = ()
    """The attempts for the goal in work."""
    turn: int = 0
    held: Held | None = None
    in_bin: tuple[PerceivedObject, ...] = ()
    """What was put into the bin."""
    last_target: str | None = None
    plan_reason: str = ""
    dry_run: bool = False
    stopped: bool = False
    allowed: tuple[Correction, ...] = ()
    """Corrections that a reflection may choose from; the first is the one that the rules offer."""
    views: tuple[RgbdView, ...] = ()
    """Pictures of the last look, while this process has them."""
    facts: str = ""
    """What the rules would answer: the recorded facts that an answer may use."""
    refusals: tuple[Refusal, ...] = ()
    """What this brain replied to the same question before, and why it did not count."""
    seconds: float = 120.0
    """Time left for a reply [s]."""
    tell: Callable[[Exchange], None] = _nobody
    """Told every exchange with a model, as it happens."""
    hear: Callable[[str], None] = unheard
    """Told a model's reply so far, each time that more of it has come."""


class Deliberation(Noun):
    """What a brain thinks before an attempt."""

    text: str
    choice: Literal["act", "look_again", "ask", "give_up"] = "act"
    question: str | None = None
    candidate: str | None = None
    """Name of the alternative to be executed instead of the plan."""
    changes: dict[GraspField, Finite] = Field(default_factory=dict[GraspField, Finite])
    """Wanted new values of force [N], aperture [m], stand-off [m] or speed."""


class Reflected(Noun):
    """What a brain makes of a failure."""

    text: str
    correction: Correction | None = None
    """The correction to apply: the one offered, or None to try afresh."""
    give_up: bool = False


class Spoken(Noun):
    """What a brain says to the person."""

    text: str
    question: str | None = None
    data: dict[str, str] = Field(default_factory=dict)


class UnusableReplyError(Exception):
    """A model's reply is not what was asked for. It does not leave the agent: the reply is refused with this reason."""

    def __init__(self, reply: str, reason: str) -> None:
        self.reply = reply
        self.reason = reason
        super().__init__(reason)


class BrainFaultError(Exception):
    """There is no reply. It leaves the agent only as an `EnvironmentFaultError`, and only where a mend is known."""

    def __init__(self, what: str, *, mend: str | None = None) -> None:
        self.what = what
        self.mend = mend
        """What a person can do about it: wrong address, key or model name; None for a fault that may pass."""
        super().__init__(what)


class Brain(Protocol):
    """The protocol that rules and language models implement."""

    @property
    def name(self) -> str:
        """As in `--brain`."""
        ...

    def understand(self, situation: Situation) -> Understanding:
        """Turns the instruction into typed goals, a refusal, or a question."""
        ...

    def perceive(self, situation: Situation) -> Seen:
        """Names the objects in the pictures and says how they lie; depth has measured them already."""
        ...

    def think(self, situation: Situation) -> Deliberation:
        """Reasons over the planned grasp, the constraints and the history (Algorithm 1, Thought)."""
        ...

    def reflect(self, situation: Situation, offered: Correction | None) -> Reflected:
        """Reasons over the last failure and the correction that the rules offer (Algorithm 1, GetCorrection)."""
        ...

    def answer(self, situation: Situation) -> Spoken:
        """Says what was done, or answers a question from the recorded facts."""
        ...
