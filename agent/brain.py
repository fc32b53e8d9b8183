"""What a brain does: understand a person, think before an attempt, reflect after a failure, and answer.

Rules and language models implement the same protocol. A brain sees facts and returns typed values; it never touches
the robot, and whatever it returns is checked against the world by the nodes that use it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, Protocol

from pydantic import Field

from agent.attempt import Attempt, Held
from agent.goal import Goal, Understanding
from kb.base import Noun
from kb.constraint import Constraints
from kb.experience import Retrieval
from kb.percept import Percept
from kb.run_result import Level
from kb.scene_graph import SceneGraph
from kb.sensing import Correction, Plan


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
    last_target: str | None = None
    plan_reason: str = ""
    dry_run: bool = False
    stopped: bool = False


class Deliberation(Noun):
    """What a brain thinks before an attempt."""

    text: str
    choice: Literal["act", "look_again", "ask", "give_up"] = "act"
    question: str | None = None


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


class Brain(Protocol):
    """The protocol that rules and language models implement."""

    @property
    def name(self) -> str:
        """As in `--brain`."""
        ...

    def understand(self, situation: Situation) -> Understanding:
        """Turns the instruction into typed goals, a refusal, or a question."""
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
