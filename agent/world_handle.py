"""Keeps the living world in step with the state: a node that moves first makes sure the world is where the state says.

This is what makes a killed run resume exactly and a forked one start from its own moment.
"""

from __future__ import annotations

import hashlib
from typing import Any

import numpy as np

from tools.open_world import OpenedWorld


class WorldHandle:
    """The opened world and the mark of the snapshot it corresponds to."""

    def __init__(self, opened: OpenedWorld) -> None:
        self.opened = opened
        self._start = opened.snapshot()
        self._mark: str | None = _digest(self._start)
        self._apart: OpenedWorld | None = None

    def at(self, blob: bytes) -> OpenedWorld:
        """The world exactly as in the snapshot `blob` (empty: as it was opened)."""
        wanted = blob or self._start
        mark = _digest(wanted)
        if self._mark != mark:
            self.opened.restore(wanted)
            self._mark = mark
        return self.opened

    def before(self, blob: bytes) -> bytes:
        """The snapshot that stands for the moment before a motion."""
        return blob or self._start

    def apart(self) -> OpenedWorld:
        """Another world of the same scene, for what would have happened; a stop of the real one stops it, too."""
        if self._apart is None:
            self._apart = self.opened.reopen()
        self._apart.forget()
        self._apart.stop.release()
        return self._apart

    def stop(self) -> None:
        """Stops the robot, and what is being simulated."""
        self.opened.stop.press()
        if self._apart is not None:
            self._apart.stop.press()

    def moving(self) -> None:
        """Says that a motion begins: until `moved`, no snapshot describes the world."""
        self._mark = None

    def moved(self) -> bytes:
        """The snapshot after a motion."""
        blob = self.opened.snapshot()
        self._mark = _digest(blob)
        return blob


class WatchedRobot:
    """A robot whose pictures are kept for those who show them; everything else goes straight through."""

    def __init__(self, robot: Any) -> None:
        self._robot = robot
        self.views: tuple[Any, ...] = ()
        """Pictures of the last look."""

    def look(self, *args: Any, **kwargs: Any) -> tuple[Any, ...]:
        """As `sim.robot.Robot.look`."""
        self.views = tuple(self._robot.look(*args, **kwargs))
        return self.views

    def hashes(self) -> tuple[str, ...]:
        """Name and content hash of each picture of the last look; the pictures themselves never enter the state."""
        return tuple(f"{view.name}:{_digest(_bytes(view.rgb), _bytes(view.depth))}" for view in self.views)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._robot, name)


def _digest(*blobs: Any) -> str:
    """Of all bytes one after the other."""
    made = hashlib.blake2b(digest_size=16)
    for blob in blobs:
        made.update(blob)
    return made.hexdigest()


def _bytes(picture: Any) -> memoryview:
    """The picture's bytes, without a copy."""
    return np.ascontiguousarray(picture).data.cast("B")
