"""What the configurations of a trial share: the same look at the same world is rendered and perceived once.

The key of a picture is what it follows from: the positions of everything, the cameras asked, and the state of the noise
generator. The key of a percept is that picture and the arguments of `perceive`. So a hit is what computing it again
would give, bit for bit (tested), whichever configurations came before.
"""

from __future__ import annotations

import hashlib
import time
from collections.abc import Sequence
from typing import Any

import numpy as np

from kb.percept import Percept
from kb.rgbd import RgbdView

Views = tuple[RgbdView, ...]


class SharedLooks:
    """The looks of one world. `clock` runs as if nothing were shared, so that time splits stay comparable."""

    def __init__(self) -> None:
        self._views: dict[bytes, tuple[Views, float]] = {}
        self._keys: dict[int, bytes] = {}
        self._percepts: dict[tuple[str, bytes, bytes], tuple[Percept, float]] = {}
        self._saved = 0.0
        self.hits = 0
        """Percepts that were found."""

    def clock(self) -> float:
        """Time [s] that goes on by the time that sharing saved."""
        return time.perf_counter() + self._saved

    def look(self, robot: Any, qpos: bytes, rng: np.random.Generator, names: Sequence[str]) -> Views:
        """Pictures of the world in the state `qpos`, taken by the robot unless they are known."""
        key = _digest(
            qpos, repr(rng.bit_generator.state).encode(), repr(_children(rng)).encode(), *map(str.encode, names)
        )
        known = self._views.get(key)
        if known is not None:
            self._saved += known[1]
            return known[0]
        start = time.perf_counter()
        views: Views = tuple(robot.look(rng, names))
        self._views[key] = views, time.perf_counter() - start
        # The views are kept above, so that no other object can get the same id.
        self._keys[id(views)] = key
        return views

    def perceive(self, perceiver: Any, name: str, views: Views, args: Any) -> Percept:
        """What the perceiver sees in the views, computed unless it is known; only views from `look` are shared."""
        picture = self._keys.get(id(views))
        if picture is None:
            return perceiver.perceive(views, args)
        key = (name, picture, _digest(args.model_dump_json().encode()))
        known = self._percepts.get(key)
        if known is not None:
            self.hits += 1
            self._saved += known[1]
            return known[0]
        start = time.perf_counter()
        percept: Percept = perceiver.perceive(views, args)
        self._percepts[key] = percept, time.perf_counter() - start
        return percept


def _children(rng: np.random.Generator) -> object:
    """The part of a generator's state that spawning changes."""
    sequence = rng.bit_generator.seed_seq
    return (
        getattr(sequence, "spawn_key", ()),
        getattr(sequence, "n_children_spawned", 0),
        getattr(sequence, "entropy", 0),
    )


def _digest(*parts: bytes) -> bytes:
    """A digest of all parts with their lengths."""
    state = hashlib.blake2b(digest_size=20)
    for part in parts:
        state.update(len(part).to_bytes(8, "little"))
        state.update(part)
    return state.digest()


class SharingRobot:
    """A robot that takes no picture twice; everything else goes straight through."""

    def __init__(self, robot: Any, world: Any, looks: SharedLooks) -> None:
        self._robot = robot
        self._world = world
        self._looks = looks

    def look(self, rng: np.random.Generator, names: Sequence[str] = ("front", "top")) -> Views:
        """As `sim.robot.Robot.look`."""
        return self._looks.look(self._robot, self._world.data.qpos.tobytes(), rng, names)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._robot, name)


class SharingPerceiver:
    """A perceiver that thinks about no picture twice."""

    def __init__(self, perceiver: Any, name: str, looks: SharedLooks) -> None:
        self._perceiver = perceiver
        self.name = name
        self._looks = looks

    def perceive(self, views: Views, args: Any) -> Percept:
        """As the perceiver's."""
        return self._looks.perceive(self._perceiver, self.name, views, args)
