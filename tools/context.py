"""What a tool may use besides its arguments: the robot, the knowledge base, the perceiver and the switches.

A context is injected, never checkpointed, and holds no truth about the world: of the world only the robot is in it.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from kb.switches import Switches

if TYPE_CHECKING:
    from kb.embedder import Embedder
    from kb.store import ExperienceStore


@dataclass
class ToolContext:
    """Everything injected into tools. Each tool uses only what it needs; unused parts may stay None in tests."""

    robot: Any = None
    """`sim.robot.Robot` or anything with its methods: sensing and acting only."""
    store: ExperienceStore | None = None
    """The knowledge base of experiences."""
    perceiver: Any = None
    """Turns views into a percept: `perceive(views, args) -> Percept`."""
    embedder: Embedder | None = None
    """Turns a masked crop into a visual embedding."""
    switches: Switches = field(default_factory=Switches)
    """Which reading of the paper and which components are live."""
    rng: np.random.Generator = field(default_factory=lambda: np.random.default_rng(0))
    """Generator of the current call; the agent replaces it for every call (see `with_rng`)."""
    stop: Any = None
    """Latching stop switch of the robot, or None."""
    alternatives: int = 2
    """Feasible grasps beyond the best that a plan names, for showing and for a brain to choose from; they decide nothing."""

    def with_rng(self, rng: np.random.Generator) -> ToolContext:
        """The same context with another generator, so that a call's draws depend on its purpose and count only."""
        return dataclasses.replace(self, rng=rng)
