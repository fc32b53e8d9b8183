"""What every page always knows about the robot."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from agent.chat import Conversation


@dataclass
class Status:
    """Told to all pages whenever it changes."""

    busy: bool = False
    stopped: bool = False
    asks: bool = False
    speed: float = 2.0
    replay: int | None = None
    place: str = ""
    scene: str = ""
    seed: int = 0
    thread: str | None = None
    unfinished: str | None = None
    halted_ms: float | None = None
    """From the arrival of the last stop to the halt of physics [ms]."""
    halted_at: float | None = None
    """Wall clock of that halt [s since 1970]."""


def status_of(talk: Conversation, *, busy: bool, speed: float) -> Status:
    """Where a conversation stands that has just been opened or changed as a whole."""
    opened = talk.agent.opened
    return Status(
        busy=busy, stopped=talk.stopped, asks=talk.asks, speed=speed, place=talk.place,
        scene=talk.agent.context.scene or opened.scene, seed=opened.seed, thread=talk.agent.thread,
        unfinished=talk.unfinished,
    )  # fmt: skip
