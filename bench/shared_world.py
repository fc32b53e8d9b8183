"""A world that the configurations of a trial share: what is the same for several of them is computed once.

Everything here is deterministic, so that a known result is what computing it again would give, bit for bit (tested):

* a picture follows from the positions of everything, the cameras asked, and the state of the noise generator;
* a percept follows from the picture and the arguments of `perceive`;
* the world after a motion follows from the world before it, the motion and its arguments. A world before is known by its
  history: the motions since the trial's start.

Configurations that differ only in what they do after a failure thus share their first attempts.
"""

from __future__ import annotations

import dataclasses
import hashlib
import pickle
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np

from kb.percept import Percept
from kb.rgbd import RgbdView
from kb.sensing import Sensing
from sim.world import Still
from tools.open_world import OpenedWorld, packed

Views = tuple[RgbdView, ...]

MOTIONS = ("grasp", "place", "release_and_home", "go_home", "handover")
"""Methods of the robot that move it."""
NAMED = b"moment of a shared world: "
START = b"start"
"""History of the world as it was opened."""


@dataclass(frozen=True)
class _Moved:
    """What a motion gave."""

    sensing: Sensing
    after: bytes
    """Snapshot of the world after it."""
    seconds: float
    """Wall time that it took [s]."""


class SharedWorld(OpenedWorld):
    """An opened world at its start, with memory. `clock` runs as if nothing were shared, so that times stay comparable."""

    @classmethod
    def of(cls, opened: OpenedWorld, *, rehearsed: bool = True) -> SharedWorld:
        """The opened world, to be shared from now on; it must stand at its start.

        Args:
            opened: The world.
            rehearsed: Another world may be asked to go on from a moment of this one, as brains may ask and rules never do.
        """
        known = {field.name: getattr(opened, field.name) for field in dataclasses.fields(opened)}
        shared = cls(**known)
        shared._history = START
        shared._snapshots = {}
        shared._histories = {}
        shared._moments = {}
        shared._physics = {}
        shared._motions = {}
        shared._views = {}
        shared._pictures = {}
        shared._percepts = {}
        shared._saved = 0.0
        shared.blind, shared.rehearsed = False, rehearsed
        shared.shared_motions = shared.shared_looks = 0
        shared.actor = opened.robot
        shared.robot = SharingRobot(shared)
        shared._start = shared.snapshot()
        return shared

    _history: bytes | None
    """What the world has gone through; None if that is not known, and then nothing is shared."""
    _snapshots: dict[bytes, bytes]
    _histories: dict[bytes, bytes]
    _moments: dict[bytes, tuple[bytes, int, bytes, Any, Still]]
    """Name of a moment of the analytic evaluator -> history, motions, physical state (empty if not `rehearsed`), what the
    observer knows, and the state once more for a quick return."""
    _physics: dict[bytes, bytes]
    _motions: dict[bytes, _Moved]
    _views: dict[bytes, tuple[Views, float]]
    _pictures: dict[int, bytes]
    _percepts: dict[tuple[str, bytes, bytes], tuple[Percept, float]]
    _saved: float
    _start: bytes
    rehearsed: bool
    """Another world may go on from a moment of this one."""
    blind: bool
    """Looking takes no picture: the perceiver needs none."""
    shared_motions: int
    """Motions that were known."""
    shared_looks: int
    """Percepts that were known."""
    actor: Any
    """The robot that really moves."""

    def begin(self) -> None:
        """Puts the world back to its start, for the next configuration."""
        self.restore(self._start)
        self.stop.release()

    def end(self) -> None:
        """Lets go of all that is kept: the world and its robot know each other and would keep it until garbage is looked
        for."""
        for known in (self._snapshots, self._histories, self._moments, self._physics, self._motions, self._views):
            known.clear()
        self._pictures.clear()
        self._percepts.clear()

    def clock(self) -> float:
        """Time [s] that goes on by the time that sharing saved."""
        return time.perf_counter() + self._saved

    def credit(self, seconds: float) -> None:
        """Lets the clock go on by time that was saved elsewhere [s]."""
        self._saved += seconds

    # The world's own methods ---------------------------------------------------------------------------------------

    def snapshot(self) -> bytes:
        """As `OpenedWorld.snapshot`."""
        if self._history is None:
            return super().snapshot()
        if self._history not in self._snapshots:
            self._snapshots[self._history] = self._named() if self.evaluator == "analytic" else self._written()
        return self._snapshots[self._history]

    def _written(self) -> bytes:
        blob = super().snapshot()
        self._histories[_digest(blob)] = self._history or START
        return blob

    def _named(self) -> bytes:
        """A name that stands for this moment within this world: writing and packing all of it takes longer than a motion."""
        assert self._history is not None
        name = NAMED + self._history
        world = self.world
        physics = world.snapshot() if self.rehearsed else b""
        self._moments[name] = self._history, self.motions, physics, self.observer.kept(), world.still()
        return name

    def restore(self, blob: bytes) -> None:
        """As `OpenedWorld.restore`."""
        moment = self._moments.get(blob)
        if moment is None:
            super().restore(blob)
            self._history = self._histories.get(_digest(blob))
            return
        history, motions, _, known, still = moment
        self.world.be_still(still)
        self.world.attempt = motions
        self.observer.recall(known)
        self._history = history

    def physics_of(self, blob: bytes) -> bytes:  # pyright: ignore[reportIncompatibleMethodOverride]
        """As `OpenedWorld.physics_of`; only the name of a moment if it is not `rehearsed`."""
        if not self.rehearsed and blob in self._moments:
            return blob
        if blob not in self._physics:
            self._physics[blob] = (
                OpenedWorld.physics_of(blob) if blob not in self._moments else packed(*self._moments[blob][1:3])
            )
        return self._physics[blob]

    # What is shared ------------------------------------------------------------------------------------------------

    def move(self, name: str, args: tuple[Any, ...], kwargs: dict[str, Any]) -> Sensing:
        """A motion of the robot, carried out unless it is known."""
        act = getattr(self.actor, name)
        if self._history is None or self.stop.pressed:
            self._history = None
            return act(*args, **kwargs)
        history = _digest(self._history, name.encode(), pickle.dumps((args, kwargs)))
        known = self._motions.get(history)
        if known is not None:
            self.restore(known.after)
            self._history = history
            self._saved += known.seconds
            self.shared_motions += 1
            return known.sensing
        before, self._history = self._history, None
        attempt, start = self.motions, time.perf_counter()
        try:
            sensing = act(*args, **kwargs)
        except Exception:
            self._history = before if self.motions == attempt else None
            raise
        seconds = time.perf_counter() - start
        if not self.stop.pressed:
            self._history = history
            self._motions[history] = _Moved(sensing, self.snapshot(), seconds)
        return sensing

    def look(self, rng: np.random.Generator, names: Sequence[str]) -> Views:
        """Pictures, taken unless they are known."""
        data, sequence = self.world.data, cast(np.random.SeedSequence, rng.bit_generator.seed_seq)
        state = (rng.bit_generator.state, sequence.entropy, sequence.spawn_key, sequence.n_children_spawned)
        key = _digest(data.qpos.tobytes(), data.xpos.tobytes(), repr(state).encode(), repr(tuple(names)).encode())
        known = self._views.get(key)
        if self.blind:
            # All empty tuples are one object: it stands for the latest look.
            self._pictures[id(())] = key
        if known is not None:
            self._saved += known[1]
            return known[0]
        start = time.perf_counter()
        views: Views = () if self.blind else tuple(self.actor.look(rng, names))
        self._views[key] = views, time.perf_counter() - start
        # The views are kept above, so that no other object can get the same id.
        self._pictures[id(views)] = key
        return views

    def perceive(self, perceiver: Any, name: str, views: Views, args: Any) -> Percept:
        """What the perceiver sees in the views, computed unless it is known; only views from `look` are shared."""
        picture = self._pictures.get(id(views))
        if picture is None:
            return perceiver.perceive(views, args)
        key = (name, picture, _digest(args.model_dump_json().encode()))
        known = self._percepts.get(key)
        if known is not None:
            self.shared_looks += 1
            self._saved += known[1]
            return known[0]
        start = time.perf_counter()
        percept: Percept = perceiver.perceive(views, args)
        self._percepts[key] = percept, time.perf_counter() - start
        return percept


def _digest(*parts: bytes) -> bytes:
    """A digest of all parts with their lengths."""
    state = hashlib.blake2b(digest_size=20)
    for part in parts:
        state.update(len(part).to_bytes(8, "little"))
        state.update(part)
    return state.digest()


class SharingRobot:
    """The robot of a shared world: it makes no motion and takes no picture twice; all else goes straight through."""

    def __init__(self, shared: SharedWorld) -> None:
        self._shared = shared

    def look(self, rng: np.random.Generator, names: Sequence[str] = ("front", "top")) -> Views:
        """As `sim.robot.Robot.look`."""
        return self._shared.look(rng, names)

    def __getattr__(self, name: str) -> Any:
        if name in MOTIONS:
            return lambda *args, **kwargs: self._shared.move(name, args, kwargs)
        return getattr(self._shared.actor, name)


class SharingPerceiver:
    """A perceiver that thinks about no picture twice."""

    def __init__(self, perceiver: Any, name: str, shared: SharedWorld) -> None:
        self._perceiver = perceiver
        self.name = name
        self._shared = shared

    def perceive(self, views: Views, args: Any) -> Percept:
        """As the perceiver's."""
        return self._shared.perceive(self._perceiver, self.name, views, args)
