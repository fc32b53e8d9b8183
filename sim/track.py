"""What the observer keeps of one motion: poses and contact forces of everything, in rows of 20 ms.

Forces are the peaks and means within a row, so that nothing short is lost; poses are those at the row's end. Two forms
of every contact force are kept because damage asks for the peak (of the 10-ms mean) and impulse for the mean.
"""

from __future__ import annotations

import io
from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from kb.sensing import Phase
from sim.placed import PlacedScene
from sim.pose import Array, rotation_of
from sim.recording import Recording
from sim.world_index import WorldIndex

ROW_STEPS = 10
"""Physics steps per row: 20 ms."""
WINDOW_STEPS = 5
"""Width of the sliding mean of forces: 10 ms (benchmark.md section 1)."""
PHASES: tuple[Phase, ...] = (
    "plan",
    "transit",
    "approach",
    "close",
    "lift",
    "hold",
    "shake",
    "carry",
    "set_down",
    "release",
    "retreat",
    "home",
)
Floats = NDArray[np.float32]


@dataclass(frozen=True)
class Layout:
    """Which objects and pairs the columns of a track belong to; the same for every track of a world."""

    objects: tuple[str, ...]
    """Scene ids of the movable objects (N)."""
    pairs: tuple[tuple[str, str], ...]
    """Pairs of things whose contact is sensed (P); the second may be part of the set-up."""
    containers: tuple[str, ...]
    """Scene ids of containers with contents (C)."""

    def column(self, name: str) -> int:
        """Column of an object; ValueError if it is not movable."""
        return self.objects.index(name)


@dataclass(frozen=True)
class Track:
    """Rows of one motion (R)."""

    time: NDArray[np.float64]
    """Simulated time at the row's end [s], (R,)."""
    phase: NDArray[np.int8]
    """Index into `PHASES`, (R,)."""
    tool: Floats
    """Position (3) and quaternion (4) of the tool point, (R, 7)."""
    opening: Floats
    """Distance between the pads [m], (R,)."""
    pose: Floats
    """Position and quaternion of the objects' frames, (R, N, 7)."""
    pads: Floats
    """Peak force of the left and right pad on each object [N], (R, N, 2)."""
    robot: Floats
    """Peak force of the strongest contact of the whole robot with each object [N], (R, N)."""
    robot_mean: Floats
    """Its mean [N], (R, N)."""
    table: Floats
    """Peak force of the table on each object [N], (R, N)."""
    pair: Floats
    """Peak force between the things of each pair [N], (R, P)."""
    pair_mean: Floats
    """Its mean [N], (R, P)."""
    robot_table: Floats
    """Peak force of the robot on the table [N], (R,)."""
    falling: Floats
    """Largest downward speed of each object while nothing touched it [m/s], (R, N)."""
    content: Floats
    """Share of each container's contents that is in it, (R, C)."""

    def __len__(self) -> int:
        return len(self.time)

    @cached_property
    def tool_rotation(self) -> Array:
        """Hand-to-world rotation, (R, 3, 3); columns across, closing axis, approach."""
        return rotation_of(self.tool[:, 3:])

    @cached_property
    def rotation(self) -> Array:
        """Object-to-world rotations, (R, N, 3, 3)."""
        return rotation_of(self.pose[:, :, 3:])

    def rows(self, *phases: Phase) -> NDArray[np.int64]:
        """Numbers of the rows in any of these phases, in order."""
        codes = [PHASES.index(phase) for phase in phases]
        return np.flatnonzero(np.isin(self.phase, codes))

    def to_bytes(self) -> bytes:
        """All rows as bytes."""
        buffer = io.BytesIO()
        np.savez(buffer, **{f.name: getattr(self, f.name) for f in fields(self)})  # type: ignore[arg-type]
        return buffer.getvalue()

    @staticmethod
    def from_bytes(blob: bytes) -> Track:
        """The inverse of `to_bytes`."""
        with np.load(io.BytesIO(blob)) as arrays:
            return Track(**{f.name: arrays[f.name] for f in fields(Track)})


def layout_of(placed: PlacedScene, index: WorldIndex) -> Layout:
    """The columns of a scene's tracks, from its sensors."""
    movable = tuple(thing.id for thing in placed.objects if not thing.fixed)
    names = [thing.id for thing in placed.objects]
    pairs = tuple((a, b) for a in movable for b in names if f"truth/{a}/{b}" in index.sensors)
    return Layout(movable, pairs, tuple(group.container for group in placed.particles))


def join(tracks: list[Track]) -> Track:
    """One track of several that follow each other."""
    if len(tracks) == 1:
        return tracks[0]
    return Track(**{f.name: np.concatenate([getattr(t, f.name) for t in tracks]) for f in fields(Track)})


def compact(recording: Recording, layout: Layout, index: WorldIndex, placed: PlacedScene) -> Track:
    """The rows of one recording, which must not be empty."""
    count = len(recording)
    starts = np.arange(0, count, ROW_STEPS)
    ends = np.minimum(starts + ROW_STEPS, count) - 1
    sensed, qpos = recording.sensordata, recording.qpos

    series = _series(sensed, layout, index)
    peak = np.maximum.reduceat(sliding_mean(series), starts, axis=0).astype(np.float32)
    total = np.add.reduceat(series, starts, axis=0)
    mean = (total / (ends - starts + 1)[:, None]).astype(np.float32)
    n = len(layout.objects)
    pads, robots, tables, pairs = slice(0, 2 * n), slice(2 * n, 3 * n), slice(3 * n, 4 * n), slice(4 * n, -1)
    addresses = [index.objects[name].qpos for name in layout.objects]
    pose = (
        np.stack([qpos[ends, a] for a in addresses if a is not None], axis=1)
        if addresses
        else np.zeros((len(ends), 0, 7))
    )
    tool = np.hstack(
        [sensed[ends, index.sensors["robot/tcp_position"]], sensed[ends, index.sensors["robot/tcp_quaternion"]]]
    )
    return Track(
        time=recording.time[ends].copy(),
        phase=np.full(len(ends), PHASES.index(recording.phase), np.int8),
        tool=tool.astype(np.float32),
        opening=sensed[ends, index.sensors["robot/opening"].start].astype(np.float32),
        pose=pose.astype(np.float32),
        pads=np.stack([peak[:, pads][:, :n], peak[:, pads][:, n:]], axis=2),
        robot=peak[:, robots].copy(),
        robot_mean=mean[:, robots].copy(),
        table=peak[:, tables].copy(),
        pair=peak[:, pairs].copy(),
        pair_mean=mean[:, pairs].copy(),
        robot_table=peak[:, -1].copy(),
        falling=_falling(recording, layout, index, starts),
        content=_content(qpos[ends], layout, index, placed),
    )


def _series(sensed: Array, layout: Layout, index: WorldIndex) -> Array:
    """Contact forces per step (T, 4 N + P + 1) [N]: left pad, right pad, robot and table on each object, pairs, robot on table.

    After the count of contacts come a force's three components; of the strongest contact, whose frame has the normal
    first, only the normal counts.
    """
    names = [f"truth/{name}/pad_left" for name in layout.objects]
    names += [f"truth/{name}/pad_right" for name in layout.objects]
    names += [f"truth/{name}/robot" for name in layout.objects]
    names += [f"truth/{name}/table" for name in layout.objects]
    names += [f"truth/{a}/{b}" for a, b in layout.pairs]
    first = np.array([index.sensors[name].start for name in [*names, "truth/table/robot"]]) + 1
    sizes = np.linalg.norm(sensed[:, first[:, None] + np.arange(3)], axis=2)
    normals = slice(2 * len(layout.objects), 3 * len(layout.objects))
    sizes[:, normals] = np.abs(sensed[:, first[normals]])
    sizes[:, -1] = np.abs(sensed[:, first[-1]])
    return sizes


def sliding_mean(series: Array) -> Array:
    """Mean over `WINDOW_STEPS` rows that end at each row (fewer at the beginning), shape as given (T, K)."""
    total = np.cumsum(series, axis=0)
    before = np.zeros_like(total)
    before[WINDOW_STEPS:] = total[:-WINDOW_STEPS]
    width = np.minimum(np.arange(1, len(series) + 1), WINDOW_STEPS)
    return (total - before) / width[:, None]


def _falling(recording: Recording, layout: Layout, index: WorldIndex, starts: NDArray[np.int64]) -> Floats:
    """Largest downward speed per row while no contact of the object was sensed."""
    speeds = np.zeros((len(starts), len(layout.objects)), np.float32)
    for column, name in enumerate(layout.objects):
        sensors = [f"truth/{name}/{part}" for part in ("robot", "table")]
        sensors += [f"truth/{a}/{b}" for a, b in layout.pairs if name in (a, b)]
        touched = (recording.sensordata[:, [index.sensors[sensor].start for sensor in sensors]] > 0).any(axis=1)
        velocity = index.objects[name].qvel
        if velocity is not None:
            down = np.where(touched, 0.0, -recording.qvel[:, velocity.start + 2])
            speeds[:, column] = np.maximum.reduceat(np.maximum(down, 0.0), starts)
    return speeds


def _content(qpos: Array, layout: Layout, index: WorldIndex, placed: PlacedScene) -> Floats:
    """Share of the particles that lie within their container's outline, from just below its base to above its rim."""
    shares = np.ones((len(qpos), len(layout.containers)), np.float32)
    for column, name in enumerate(layout.containers):
        thing = next(thing for thing in placed.objects if thing.id == name)
        address = index.objects[name].qpos
        starts = index.particles[name]
        if address is None or not len(starts):
            continue
        points = np.stack([qpos[:, start : start + 3] for start in starts], axis=1)  # (R, P, 3)
        local = np.einsum(
            "rji,rpj->rpi",
            rotation_of(qpos[:, address.start + 3 : address.stop]),
            points - qpos[:, None, address.start : address.start + 3],
        )
        radius = min(thing.size[0], thing.size[1]) / 2
        inside = (np.hypot(local[..., 0], local[..., 1]) < radius) & (local[..., 2] > -0.005)
        inside &= local[..., 2] < thing.size[2] + HEAP
        shares[:, column] = inside.mean(axis=1)
    return shares


HEAP = 0.03
"""Contents may be heaped this high above the rim [m]."""
