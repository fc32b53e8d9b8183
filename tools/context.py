"""What a tool may use besides its arguments: the robot, the knowledge base, the perceiver and the switches.

A context is injected, never checkpointed, and holds no truth about the world: of the world only the robot is in it.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
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

    def with_draws(self, draws: Callable[[], np.random.Generator]) -> ToolContext:
        """As `with_rng`, with a generator that is made when it is first asked for: few calls draw anything."""
        other = object.__new__(type(self))
        vars(other).update(vars(self))
        vars(other).pop("rng", None)
        vars(other)["_draws"] = draws
        return other

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """The generator that `with_draws` promised, kept from now on; there is no other attribute to be found here."""
            if name != "rng" or "_draws" not in vars(self):
                raise AttributeError(name)
            self.rng = vars(self)["_draws"]()
            return self.rng
