"""What a conversation tells besides the steps of the task graph: each is a typed step with one text for a person.

Faces switch on `kind`. `Explained`, `Compared` and `WhatIf` are the answer of their turn; no `Answer` follows them. Numbers stand in fields of their own, so that a face never has to read the text.
"""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from agent.events import BaseStep
from kb.base import Noun, Vec2
from kb.run_result import RunResult
from kb.sensing import Plan
from kb.vocabulary import FailureType


class Said(BaseStep):
    """What the person said, as the robot heard it (control characters made visible)."""

    kind: Literal["said"] = "said"


class Asked(BaseStep):
    """The turn waits for a person: answer with `Conversation.approve`, `reject`, `edit`, or by saying something."""

    kind: Literal["asked"] = "asked"
    plan: Plan
    """The grasp; of a placing the one with which the thing is held."""
    thought: str = ""
    clearance: float = 0.0
    motion: Literal["grasp", "place"] = "grasp"
    point: Vec2 | None = None
    """Where it would be put down [m], if that can be changed."""


class Heeded(BaseStep):
    """The person's steering was heard between two steps and now is a constraint of the grasp."""

    kind: Literal["heeded"] = "heeded"
    words: str
    demand: dict[str, Any] = Field(default_factory=dict)


class Fact(Noun):
    """One number of a grasp and where it comes from."""

    field: str
    value: Any
    sources: tuple[str, ...] = ()
    """In words, with ids and measured values."""


class Explained(BaseStep):
    """Why a grasp was chosen: every number with its source, and what was rejected."""

    kind: Literal["explained"] = "explained"
    attempt: int = -1
    """Number of the attempt in the conversation."""
    facts: tuple[Fact, ...] = ()
    constraints: tuple[str, ...] = ()
    rejected: dict[str, int] = Field(default_factory=dict)
    alternatives: tuple[tuple[str, float], ...] = ()
    """Other feasible candidates with their scores."""


class Difference(Noun):
    """One row of a comparison."""

    field: str
    first: Any
    second: Any


class Compared(BaseStep):
    """Two attempts side by side: what differed."""

    kind: Literal["compared"] = "compared"
    attempts: tuple[int, int] = (-1, -1)
    rows: tuple[Difference, ...] = ()


class Outcome(Noun):
    """How a grasp ended, by the robot's own sensing."""

    claimed: bool
    failure: FailureType | None = None
    reasons: tuple[str, ...] = ()
    load_kg: float = 0.0
    held_s: float = 0.0
    peak_force_n: float = 0.0


class WhatIf(BaseStep):
    """A what-if, simulated from the saved moment before an attempt."""

    kind: Literal["whatif"] = "whatif"
    attempt: int = -1
    changes: dict[str, Any] = Field(default_factory=dict)
    real: Outcome | None = None
    simulated: Outcome | None = None
    pictures: str | None = None
    """File with both endings side by side (PNG), if the session has a folder."""


class Stopped(BaseStep):
    """The robot was stopped and stays so until it is released."""

    kind: Literal["stopped"] = "stopped"


class Noted(BaseStep):
    """Anything else that a person should know."""

    kind: Literal["noted"] = "noted"


class Refused(BaseStep):
    """The command could not be used; nothing moved. `code` as the exit code of the command line (2 or 3)."""

    kind: Literal["refused"] = "refused"
    code: int = 2


class Finished(BaseStep):
    """The turn is over; `result` as `--json` would write it."""

    kind: Literal["finished"] = "finished"
    result: RunResult
