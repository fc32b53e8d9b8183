"""What every page always knows about the robot."""

from __future__ import annotations

from dataclasses import dataclass


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
