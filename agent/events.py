"""What a run tells while it happens: typed steps, in the order of Algorithm 1 and of the seven stages (ledger G1).

`str(step)` is one line for a person; `step.model_dump_json()` is one line of a trace. Steps carry no wall times.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from agent.brain import Exchange
from agent.goal import Goal
from kb.base import Noun
from kb.constraint import Constraints
from kb.experience import Retrieval
from kb.percept import Percept
from kb.run_result import Level
from kb.scene_graph import SceneGraph
from kb.seen import Seen
from kb.sensing import Correction, Plan, Sensing
from kb.vocabulary import FailureType


class BaseStep(Noun):
    """What all steps share."""

    text: str
    """One sentence for a person."""
    goal: int | None = None
    """Index of the goal this step serves."""

    def __str__(self) -> str:
        """As in "Thought: ..."."""
        return f"{type(self).__name__}: {self.text}"


class Understood(BaseStep):
    """The instruction as goals."""

    kind: Literal["understood"] = "understood"
    goals: tuple[Goal, ...] = ()


class Look(BaseStep):
    """Stage 1: what the cameras show."""

    kind: Literal["look"] = "look"
    percept: Percept
    pictures: tuple[str, ...] = ()
    """Content hashes of the pictures."""


class Grounding(BaseStep):
    """Stage 2: which object is meant."""

    kind: Literal["grounding"] = "grounding"
    target: str | None = None


class Retrieved(BaseStep):
    """Stage 3: experiences with their scores."""

    kind: Literal["retrieved"] = "retrieved"
    retrieval: Retrieval


class Graphed(BaseStep):
    """Stage 4: the scene graph."""

    kind: Literal["graphed"] = "graphed"
    graph: SceneGraph


class Constrained(BaseStep):
    """Stage 5: the constraints of the target."""

    kind: Literal["constrained"] = "constrained"
    constraints: Constraints


class Planned(BaseStep):
    """A planned grasp with its rivals, or why there is none."""

    kind: Literal["planned"] = "planned"
    plan: Plan | None = None


class Thought(BaseStep):
    """Thought: reasoning over the grasp, the constraints and the history."""

    kind: Literal["thought"] = "thought"
    level: Level = 0
    attempt: int = 0


class Approval(BaseStep):
    """A person is asked, or has decided, about the motion."""

    kind: Literal["approval"] = "approval"
    plan: Plan | None = None
    decision: Literal["asked", "approve", "reject", "edit", "steer"] = "asked"


class Action(BaseStep):
    """Stage 6, Action: a motion begins."""

    kind: Literal["action"] = "action"
    tool: str
    plan: Plan | None = None
    level: Level = 0
    attempt: int = 0
    motion: int = 0


class Observation(BaseStep):
    """Observation: what the robot sensed and what it makes of it."""

    kind: Literal["observation"] = "observation"
    sensing: Sensing | None = None
    claimed: bool = False
    failure: FailureType | None = None
    attempt: int = 0


class Reflection(BaseStep):
    """Stage 7 after a failure: the correction for the next attempt, or why there is none."""

    kind: Literal["reflection"] = "reflection"
    correction: Correction | None = None
    level: Level = 0


class Remembered(BaseStep):
    """Stage 7 after a success: the strategy goes into the episodic memory."""

    kind: Literal["remembered"] = "remembered"
    category: str


class ModelCall(BaseStep):
    """A prompt to a language model and its reply, whole, for the record."""

    kind: Literal["model_call"] = "model_call"
    exchange: Exchange


class Saying(BaseStep):
    """What a model has said so far of a reply that is still being made; `text` is inert and may be empty.

    It counts for nothing: the gate judges the whole reply, and the step that follows tells what became of it. It is told
    only where somebody wants to hear it (`AgentContext.aloud`), and stands in no trace.
    """

    kind: Literal["saying"] = "saying"
    role: str


class Refused(BaseStep):
    """A reply that did not pass the gate; the model is told why. (A command that cannot be used is `agent.chat.events.Refused`.)"""

    kind: Literal["reply_refused"] = "reply_refused"
    role: str
    reason: str
    count: int = 1
    """How many replies to this question were refused so far."""


class Fallback(BaseStep):
    """The rules decide in the model's place."""

    kind: Literal["fallback"] = "fallback"
    role: str
    reason: str


class Named(BaseStep):
    """What a model said about the picture, joined with what was measured."""

    kind: Literal["named"] = "named"
    seen: Seen
    dropped: tuple[str, ...] = ()
    """What measuring contradicts, in words."""


class SubGoal(BaseStep):
    """Something else has to be done first."""

    kind: Literal["sub_goal"] = "sub_goal"
    pushed: Goal


class Question(BaseStep):
    """The agent asks back."""

    kind: Literal["question"] = "question"
    choices: tuple[str, ...] = ()


class Answer(BaseStep):
    """The last step of every run."""

    kind: Literal["answer"] = "answer"
    data: dict[str, Any] = Field(default_factory=dict)


Step = Annotated[
    Understood
    | Look
    | Grounding
    | Retrieved
    | Graphed
    | Constrained
    | Planned
    | Thought
    | Approval
    | Action
    | Observation
    | Reflection
    | Remembered
    | ModelCall
    | Refused
    | Fallback
    | Named
    | SubGoal
    | Question
    | Answer,
    Field(discriminator="kind"),
]
"""Any step of a run."""
