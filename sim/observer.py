"""The observer: records the truth of every motion and says afterwards what happened.

It stands beside the world and is asked by whoever writes the result; robot, tools, memory and agent never see it.
"""

from __future__ import annotations

import io
import json
import struct
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import mujoco
import numpy as np
from numpy.typing import ArrayLike

from kb.base import Vec3
from kb.run_result import ConstraintRecord
from kb.verdict import ObservedAttempt
from kb.vocabulary import ConstraintKind
from sim.judge import judge, unmoved
from sim.local_width import local_width
from sim.pose import Array, point_in_world, rotation_of
from sim.recording import Recording
from sim.track import Layout, Track, compact, join, layout_of
from sim.verdict_constraints import Trial, measure, required_targets
from sim.verdict_damage import damages
from sim.verdict_events import WidthAt
from sim.verdict_grip import Grip, grips
from sim.verdict_place import LANE, in_bin, lane_centre
from sim.world import World

MEANT_DISTANCE = 0.10
"""A perceived object farther than this from every true one is none of them [m]."""
SAME_CATEGORY = 0.03
"""Advantage of an object of the perceived category in that comparison [m]."""

ADVANCE = 0.008
"""How far beyond the stopped tool point the width is looked for [m]: fingertips reach 9 mm beyond it."""


class Observer:
    """Records all motions of a world from now on."""

    def __init__(self, world: World) -> None:
        self.world = world
        self.placed = world.placed
        self.layout: Layout = layout_of(world.placed, world.index)
        self.start = self.poses()
        """Poses at the start of the trial."""
        self._pieces: dict[int, list[Track]] = {}
        self._meant: dict[int, str | None] = {}
        self._grips: dict[int, dict[str, Grip]] = {}
        self._scratch: Any = None
        """MuJoCo's data for geometry alone."""
        world.recorders.append(self)

    def on_recording(self, recording: Recording) -> None:
        """Keeps the rows of one phase of a motion."""
        if len(recording):
            self._pieces.setdefault(recording.attempt, []).append(
                compact(recording, self.layout, self.world.index, self.placed)
            )
            self._grips.pop(recording.attempt, None)

    @property
    def attempts(self) -> tuple[int, ...]:
        """Numbers of the motions that moved, in order."""
        return tuple(sorted(self._pieces))

    def poses(self) -> dict[str, Array]:
        """Where every movable object is now, position and quaternion (7,)."""
        addresses = {name: self.world.index.objects[name].qpos for name in self.layout.objects}
        return {name: self.world.data.qpos[a].copy() for name, a in addresses.items() if a is not None}

    def judge(
        self, attempt: int, meant: str | None, placement: Any = None, other: str | None = None, *, since: int = 0
    ) -> ObservedAttempt:
        """What happened in one motion.

        Args:
            attempt: Number of the motion (`World.attempt` during it).
            meant: Scene id of the object that was to be grasped or placed.
            placement: Where a placing motion was to put it: anything with `kind` ("bin", "side", "beside", "on", "back",
                "aside", "lane") and the `side`, `relation` and `lane` that the kind needs.
            other: Scene id of the placement's reference.
            since: First motion of the task: damage done before it is not held against this one.
        """
        self._meant[attempt] = meant
        if attempt not in self._pieces:
            return unmoved()
        return judge(self._trial(attempt, since), meant, self._width_of, placement, other)

    def constraints(self, inferred: Iterable[tuple[ConstraintKind, str]] = ()) -> tuple[ConstraintRecord, ...]:
        """The constraints required by the task and those inferred (kind, scene id), each measured over the whole trial."""
        required = list(required_targets(self.placed.task))
        given = list(inferred)
        trial = self._trial()
        records = []
        for kind, target in dict.fromkeys([*required, *given]):
            satisfied, measured = measure(kind, target, trial)
            records.append(
                ConstraintRecord(
                    kind=kind,
                    target=target,
                    required=(kind, target) in required,
                    inferred=(kind, target) in given,
                    satisfied=satisfied,
                    measured=measured,
                )
            )
        return tuple(records)

    def meant(self, category: str | None, position: Vec3, attempt: int | None = None) -> str | None:
        """The object that a perceived one stands for: the nearest, preferring its category; None if none is near.

        Args:
            category: As perceived.
            position: Centre of the perceived box [m].
            attempt: Compares with where things were when this motion began; now if None.
        """
        poses = self.poses()
        # A motion for which no way was found left no record: things stood then as when the next one began.
        began = None if attempt is None else min((n for n in self._pieces if n >= attempt), default=None)
        if began is not None:
            first = self._pieces[began][0].pose[0]
            poses = {name: first[column] for column, name in enumerate(self.layout.objects)}
        return self.nearest(category, position, poses)

    def nearest(self, category: str | None, position: Vec3, poses: Mapping[str, ArrayLike]) -> str | None:
        """The object nearest to a position, those of the category preferred, with everything at the given poses."""
        best, best_distance = None, MEANT_DISTANCE
        for thing in self.placed.objects:
            if thing.id not in poses:
                continue
            middle = point_in_world(poses[thing.id], (0.0, 0.0, thing.size[2] / 2))
            distance = float(np.linalg.norm(middle - np.asarray(position)))
            distance -= SAME_CATEGORY if category == thing.category else 0.0
            if distance < best_distance:
                best, best_distance = thing.id, distance
        return best

    def in_bin(self, name: str) -> bool:
        """Whether an object lies in the bin now."""
        thing = next(thing for thing in self.placed.objects if thing.id == name)
        middle = point_in_world(self.poses()[name], (0.0, 0.0, thing.size[2] / 2))
        return in_bin(middle, self.placed, thing.size[2])

    def in_lanes(self, order: Sequence[str]) -> bool:
        """Whether these objects now stand on the table each in its sorting lane, the first one in the leftmost."""
        poses = self.poses()
        lanes = [poses[name][1] - lane_centre(number, len(order)) for number, name in enumerate(order)]
        return all(
            abs(offset) <= LANE / 2 and poses[name][2] > -0.01 for offset, name in zip(lanes, order, strict=True)
        )

    def damaged(self, since: int = 0) -> tuple[str, ...]:
        """Every object that came to harm in any motion so far, from motion `since` on."""
        return tuple(sorted(self._trial(since=since).damaged))

    def state(self) -> bytes:
        """All that was recorded, as bytes."""
        header = {"meant": {str(k): v for k, v in self._meant.items()}, "attempts": list(self.attempts)}
        buffer = io.BytesIO()
        np.savez(buffer, **self.start)  # type: ignore[arg-type]
        parts = [json.dumps(header).encode(), buffer.getvalue()]
        parts += [join(self._pieces[attempt]).to_bytes() for attempt in self.attempts]
        return b"".join(struct.pack("<q", len(part)) + part for part in parts)

    def load(self, blob: bytes) -> None:
        """Puts back what `state` returned; forgets everything recorded since."""
        parts, at = [], 0
        while at < len(blob):
            (size,) = struct.unpack_from("<q", blob, at)
            parts.append(blob[at + 8 : at + 8 + size])
            at += 8 + size
        header = json.loads(parts[0])
        with np.load(io.BytesIO(parts[1])) as arrays:
            self.start = {name: arrays[name] for name in arrays.files}
        self._meant = {int(k): v for k, v in header["meant"].items()}
        self._pieces = {a: [Track.from_bytes(p)] for a, p in zip(header["attempts"], parts[2:], strict=True)}
        self._grips = {}

    def forget(self, keep: int = 0) -> None:
        """Drops what was recorded of all but the last `keep` motions: a long conversation must not grow without bound."""
        numbers = self.attempts
        for number in numbers[: len(numbers) - keep]:
            self._drop(number)

    def _drop(self, number: int) -> None:
        for record in (self._pieces, self._meant, self._grips):
            record.pop(number, None)

    def _motion(self, attempt: int) -> dict[str, Grip]:
        if attempt not in self._grips:
            pieces = self._pieces[attempt]
            pieces[:] = [join(pieces)]
            self._grips[attempt] = grips(pieces[0], self.layout, self.placed)
        return self._grips[attempt]

    def _trial(self, last: int | None = None, since: int = 0) -> Trial:
        """All motions up to `last`, or all; damaged is what came to harm from motion `since` on."""
        numbers = [number for number in self.attempts if last is None or number <= last]
        motions = tuple(self._motion(number) for number in numbers)
        meants = tuple(self._meant.get(number) for number in numbers)
        uprights = {name: rotation_of(pose[3:])[:, 2] for name, pose in self.start.items()}
        harmed = {
            damage.object
            for number, grip, meant in zip(numbers, motions, meants, strict=True)
            if number >= since
            for damage in damages(grip, uprights, meant)
        }
        return Trial(self.placed, self.layout, motions, meants, self.start, uprights, frozenset(harmed))

    def _width_of(self, grip: Grip) -> WidthAt:
        """The true width between the fingers at a row of a motion, with the hand turned about its approach."""
        self._scratch = self._scratch or mujoco.MjData(self.world.model)
        data, model, index = self._scratch, self.world.model, self.world.index.objects[grip.thing.id]

        def width_at(row: int, angle: float) -> float:
            if index.qpos is None:
                return 0.0
            data.qpos[index.qpos] = grip.track.pose[row, grip.column]
            mujoco.mj_kinematics(model, data)
            hand = grip.track.tool_rotation[row]
            cos, sin = np.cos(angle), np.sin(angle)
            turned = hand @ np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
            # Fingertips that came down on top have not yet brought the pads beside the object: look a little further.
            tool = grip.track.tool[row, :3] + ADVANCE * hand[:, 2]
            return local_width(model, data, index.geoms, tool, turned, float(grip.track.opening[row]))

        return width_at
