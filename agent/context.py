"""What is injected into every node and never checkpointed: tools, brain, world, clock, and who listens."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from agent.brain import Brain
from agent.brains.rules import RulesBrain
from agent.draws import draws
from agent.events import BaseStep
from agent.safety.limits import BrainLimits
from agent.world_handle import WatchedRobot, WorldHandle
from kb.percept import PerceivedObject
from kb.switches import Switches
from kb.vocabulary import FailureType
from memory import EpisodicMemory
from tools.context import ToolContext


class Timed:
    """A block whose wall time is added to those of its stage [s]."""

    __slots__ = ("_clock", "_stage", "_start", "_times")

    def __init__(self, clock: Callable[[], float], stage: str, times: dict[str, float]) -> None:
        self._clock, self._stage, self._times = clock, stage, times
        self._start = 0.0

    def __enter__(self) -> None:
        self._start = self._clock()

    def __exit__(self, *_: object) -> None:
        self._times[self._stage] = self._times.get(self._stage, 0.0) + self._clock() - self._start


@dataclass
class AgentContext:
    """Run-scoped dependencies of the nodes."""

    tools: ToolContext
    brain: Brain
    world: WorldHandle
    scene: str = ""
    """Scene as it was asked for: a built-in name or a path."""
    seed: int = 0
    start_memory: EpisodicMemory | None = None
    """Episodic memory from earlier sessions."""
    approve: bool = False
    """Ask before every motion (LangGraph interrupt)."""
    dry_run: bool = False
    """Understand, look and plan; move nothing."""
    emit: Callable[[BaseStep], None] = field(default=lambda _step: None)
    """Told every step as it happens."""
    clock: Callable[[], float] = time.perf_counter
    rules: Brain = field(default_factory=RulesBrain)
    """Decides where another brain's word does not count."""
    limits: BrainLimits = field(default_factory=BrainLimits)
    names_objects: bool = False
    """The brain names what is seen (`--perception vlm`)."""
    aloud: bool = False
    """Tell what a model says while it says it (`agent.events.Saying`); faces want that, records do not."""
    mail: Callable[[], tuple[str, ...]] = field(default=lambda: ())
    """What a person has said since the last call, while the robot was at work (a conversation)."""
    thread: str = "here"
    """Name of the conversation."""
    folder: Path | None = None
    """Folder of the session, for pictures; None where nothing is kept."""
    oracle_failure: Callable[[int, PerceivedObject], FailureType | None] | None = None
    """Only for the configuration `oracle_phi`: the evaluator's own label of a motion."""

    @property
    def guarded(self) -> bool:
        """Whether the brain's words pass the gate: all but those of the rules."""
        return not isinstance(self.brain, RulesBrain)

    @property
    def switches(self) -> Switches:
        """Which components are live."""
        return self.tools.switches

    def tool(self, purpose: str, count: int) -> ToolContext:
        """The tool context for one call; its draws follow from the seed, the purpose and the count alone."""
        return self.tools.with_draws(lambda: draws(self.seed, purpose, count))

    def timed(self, stage: str, times: dict[str, float]) -> Timed:
        """Adds the wall time of a block to `times[stage]` [s]."""
        return Timed(self.clock, stage, times)

    def pictures(self) -> tuple[str, ...]:
        """Content hashes of the last look's pictures."""
        return self.tools.robot.hashes() if isinstance(self.tools.robot, WatchedRobot) else ()

    @property
    def views(self) -> tuple[Any, ...]:
        """The last look's pictures, while this process has them."""
        return self.tools.robot.views if isinstance(self.tools.robot, WatchedRobot) else ()

    @property
    def stopped(self) -> bool:
        """Whether a person has pressed stop and not released it."""
        switch: Any = self.tools.stop
        return bool(switch is not None and switch.pressed)
