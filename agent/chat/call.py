"""One step of the conversation: which tool is used, with what. An utterance becomes a few of them, done in order."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from agent.goal import Goal
from kb.base import Noun
from tools.planning.demand import Demand

ToolName = Literal["task", "why", "compare", "whatif", "remember", "forget", "recall", "report", "say"]


class Call(Noun):
    """A tool call that the conversation has decided on."""

    tool: ToolName
    words: str = ""
    """What it is about, in the person's words; for a task the instruction."""
    goals: tuple[Goal, ...] = ()
    """For a task that is understood already ("do that again"); else the brain reads `words`."""
    demands: tuple[Demand, ...] = ()
    """What the person wants of the grasp."""
    values: dict[str, Any] = Field(default_factory=dict)
    """Plain arguments of the other tools (numbers of attempts, changes of a what-if)."""
