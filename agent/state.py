"""The state of the task graph: all that a checkpoint holds, and nothing that is injected.

The world is in it as opaque bytes, pictures by their content hash; no value of the observer is ever written here.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, TypedDict

from langchain_core.messages import AnyMessage
from langgraph.graph.message import add_messages

from agent.attempt import Attempt, Held, Moved, add_attempts
from agent.chat.call import Call
from agent.goal import Goal
from kb.constraint import Constraints
from kb.experience import Retrieval
from kb.percept import PerceivedObject, Percept
from kb.run_result import Level, ModelUse
from kb.scene_graph import SceneGraph
from kb.sensing import CameraEvidence, Correction, Plan, Sensing
from memory import EpisodicMemory, merge_memory
from tools.classify_failure import Diagnosis
from tools.planning.demand import Demand


def add_times(old: dict[str, float], new: dict[str, float] | None) -> dict[str, float]:
    """Reducer of wall-clock seconds per stage; None clears. A node that timed nothing leaves all as it is."""
    if new is None:
        return {}
    if not new:
        return old
    return {key: old.get(key, 0.0) + new.get(key, 0.0) for key in sorted({*old, *new})}


def add_use(old: ModelUse, new: ModelUse | None) -> ModelUse:
    """Reducer of the model's part in a turn; None clears."""
    return ModelUse() if new is None else old.plus(new)


@dataclass
class State:
    """State of one conversation with the robot."""

    scene: str = ""
    seed: int = 0
    instruction: str = ""
    turn: int = -1
    """Number of the instruction within the conversation, from 0."""
    messages: Annotated[list[AnyMessage], add_messages] = field(default_factory=list)
    goals: tuple[Goal, ...] = ()
    """Goals of this turn: what was asked first, then sub-goals."""
    agenda: tuple[int, ...] = ()
    """Indices of goals still open, the current one last (a stack)."""
    percept: Percept | None = None
    before: Percept | None = None
    """The look before the last motion, for comparing."""
    stale: bool = True
    """The world may have changed since `percept`."""
    looks: int = 0
    pictures: tuple[str, ...] = ()
    """Content hashes of the last look's pictures."""
    experiences: Retrieval | None = None
    shown: Retrieval | None = None
    """The retrieval of this turn's first grasp, for the result."""
    graph: SceneGraph | None = None
    constraints: Constraints = field(default_factory=Constraints)
    plan: Plan | None = None
    plan_reason: str = ""
    thought: str = ""
    level: Level = 0
    sensing: Sensing | None = None
    camera: CameraEvidence | None = None
    diagnosis: Diagnosis | None = None
    correction: Correction | None = None
    attempts: Annotated[tuple[Attempt, ...], add_attempts] = ()
    """H."""
    memory: Annotated[EpisodicMemory, merge_memory] = field(default_factory=EpisodicMemory)
    """M."""
    held: Held | None = None
    last_target: str | None = None
    """Perceived id of what was dealt with last, for "it" and "the other one"."""
    world: bytes = b""
    """Opaque snapshot after the last motion; empty while nothing has moved."""
    put_down: Held | None = None
    """What was just put down and has not been looked at since."""
    moved: Moved | None = None
    """What was put somewhere last, for "it" and "undo"."""
    displaced: tuple[str, ...] = ()
    """Perceived ids of what was put somewhere in this conversation, in order, repeated."""
    in_bin: tuple[PerceivedObject, ...] = ()
    """What was put into the bin, as it should lie there."""
    motions: dict[int, int] = field(default_factory=dict)
    """Place goals of this turn: index -> number of the placing motion."""
    extra_actions: int = 0
    """Removals of other objects in this turn (ledger G52: not part of the retry budget, at most 3)."""
    relooks: int = 0
    """Looks taken again for the current goal because no grasp was found."""
    executed: bool = False
    refused: bool = False
    pending: Goal | None = None
    """The goal that the last question back was about; a bare "the red one" completes it."""
    answer: str = ""
    question: str | None = None
    times: Annotated[dict[str, float], add_times] = field(default_factory=dict)
    use: Annotated[ModelUse, add_use] = field(default_factory=ModelUse)
    """The language model's part in this turn."""
    demands: tuple[Demand, ...] = ()
    """What the person said about how to do what is in work."""
    consent: bool = False
    """The person has agreed to the placing that comes next."""
    said: str = ""
    """In a conversation: the utterance that is being dealt with; empty in a single run."""
    call: Call | None = None
    """In a conversation: the tool call in work."""
    calls: tuple[Call, ...] = ()
    """In a conversation: what the utterance asks for and is still to do."""
    hops: int = 0
    """Tool calls begun for this utterance."""
    asked: tuple[Goal, ...] = ()
    """What was asked of the task graph last, for "and the apple?"."""
    deed: tuple[Goal, ...] = ()
    """What was asked for last that moves, for "do that again"."""

    @property
    def current(self) -> int | None:
        """Index of the goal in work, or None."""
        return self.agenda[-1] if self.agenda else None

    @property
    def goal(self) -> Goal:
        """The goal in work."""
        return self.goals[self.agenda[-1]]

    def tries(self) -> tuple[Attempt, ...]:
        """The attempts made for the goal in work, in order."""
        return tuple(a for a in self.attempts if a.turn == self.turn and a.goal == self.current)


class Update(TypedDict, total=False):
    """What a node returns: any subset of the state's fields."""

    scene: str
    seed: int
    instruction: str
    turn: int
    messages: list[AnyMessage]
    goals: tuple[Goal, ...]
    agenda: tuple[int, ...]
    percept: Percept | None
    before: Percept | None
    stale: bool
    looks: int
    pictures: tuple[str, ...]
    experiences: Retrieval | None
    shown: Retrieval | None
    graph: SceneGraph | None
    constraints: Constraints
    plan: Plan | None
    plan_reason: str
    thought: str
    level: Level
    sensing: Sensing | None
    camera: CameraEvidence | None
    diagnosis: Diagnosis | None
    correction: Correction | None
    attempts: tuple[Attempt, ...]
    memory: EpisodicMemory
    held: Held | None
    last_target: str | None
    world: bytes
    put_down: Held | None
    moved: Moved | None
    displaced: tuple[str, ...]
    in_bin: tuple[PerceivedObject, ...]
    motions: dict[int, int]
    extra_actions: int
    relooks: int
    executed: bool
    refused: bool
    pending: Goal | None
    answer: str
    question: str | None
    times: dict[str, float] | None
    use: ModelUse | None
    demands: tuple[Demand, ...]
    consent: bool
    said: str
    call: Call | None
    calls: tuple[Call, ...]
    hops: int
    asked: tuple[Goal, ...]
    deed: tuple[Goal, ...]


def merged(*updates: Update) -> Update:
    """One update out of several; later ones count."""
    result = Update()
    for update in updates:
        result.update(update)
    return result
