"""How one thing was gripped, raised and held in one motion: measured from the observer's track (benchmark.md section 3)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sim.placed import PlacedObject, PlacedScene
from sim.pose import Array, point_in_body, point_in_world
from sim.track import Layout, Track

TOUCH = 0.05
"""A force above this is a contact [N]; numerical rests stay far below."""
LIFT_HEIGHT = 0.10
"""A grasp must raise the thing this far [m] (benchmark.md section 3)."""
HOLD_TIME = 2.0
"""... and hold it for this long before it is shaken [s] (benchmark.md section 3)."""
GAP = 0.06
"""Contact may vanish for this long without the hold being over [s]: a rattle, no loss."""
OFF_GROUND = 0.03
"""A thing raised this far by the hand has been taken [m]."""
ROW = 0.02
"""Duration of a row [s]: the tolerance of all times."""


@dataclass(frozen=True)
class Grip:
    """One thing in one motion. Row numbers are -1 where there is no such row."""

    track: Track
    layout: Layout
    thing: PlacedObject

    @cached_property
    def column(self) -> int:
        """Its column in the track."""
        return self.layout.column(self.thing.id)

    @cached_property
    def closed(self) -> int:
        """Last row of closing, or -1: the fingers were never closed."""
        rows = self.track.rows("close")
        return int(rows[-1]) if len(rows) else -1

    @cached_property
    def over(self) -> int:
        """Last row of the grasp itself: what follows (carrying, setting down) is another matter."""
        rows = self.track.rows("plan", "transit", "approach", "close", "lift", "hold", "shake")
        return int(rows[-1]) if len(rows) else len(self.track) - 1

    @cached_property
    def centre(self) -> Array:
        """Middle of the thing in the world [m], (R, 3)."""
        return point_in_world(self.track.pose[:, self.column], (0.0, 0.0, self.thing.size[2] / 2))

    @cached_property
    def rise(self) -> Array:
        """Height of its middle above where it started [m], (R,)."""
        return self.centre[:, 2] - self.centre[0, 2]

    @cached_property
    def touched(self) -> NDArray[np.bool_]:
        """Whether the robot touches it, (R,)."""
        return self.track.robot[:, self.column] > TOUCH

    @cached_property
    def pressed(self) -> Array:
        """Peak force of the robot on it [N], (R,).

        The largest of its strongest contact, all contacts of one pad together, and, where it is touched, what it presses
        on the table beyond its weight: a palm that comes down on a rim has many contacts, each of them weak.
        """
        table = self.track.table[:, self.column]
        down = np.where(self.touched, table - table[0], 0.0)
        pads = self.track.pads[:, self.column].max(axis=1)
        return np.maximum.reduce([self.track.robot[:, self.column], pads, down]).astype(float)

    @cached_property
    def pinched(self) -> NDArray[np.bool_]:
        """Whether both pads touch it, (R,)."""
        return self.track.pads[:, self.column].min(axis=1) > TOUCH

    @cached_property
    def gripped(self) -> bool:
        """Both pads pressed on it when closing had ended (or within 0.1 s after)."""
        if self.closed < 0:
            return False
        return bool(self.pinched[self.closed : self.closed + 5].any())

    @cached_property
    def kept(self) -> NDArray[np.bool_]:
        """After closing: touched without a break longer than `GAP`, (R,)."""
        out = np.zeros(len(self.track), bool)
        if self.closed < 0:
            return out
        missing = 0
        for row in range(self.closed, self.over + 1):
            missing = 0 if self.touched[row] else missing + 1
            if missing * ROW > GAP:
                out[row - missing + 1 : row + 1] = False
                break
            out[row] = True
        return out

    @cached_property
    def lost(self) -> int:
        """Row at which contact was lost after closing on it, or -1."""
        if not self.gripped:
            return -1
        last = int(np.flatnonzero(self.kept)[-1]) if self.kept.any() else self.closed
        return last + 1 if last < self.over else -1

    @cached_property
    def lifted(self) -> float:
        """Largest rise while the robot touched it after closing [m]."""
        rows = self.touched.copy()
        rows[: max(self.closed, 0)] = False
        return float(max(0.0, self.rise[rows].max())) if rows.any() and self.closed >= 0 else 0.0

    @cached_property
    def taken(self) -> bool:
        """The hand raised it off the ground."""
        return self.lifted >= OFF_GROUND

    @cached_property
    def held_rows(self) -> NDArray[np.int64]:
        """The first unbroken run of rows in which it is held at least 10 cm up; while it is shaken, at least 3 cm up."""
        shaken = np.zeros(len(self.track), bool)
        shaken[self.track.rows("shake")] = True
        good = self.kept & (self.rise >= np.where(shaken, OFF_GROUND, LIFT_HEIGHT))
        rows = np.flatnonzero(good)
        if not len(rows):
            return rows
        breaks = np.flatnonzero(np.diff(rows) > 1)
        return rows[: breaks[0] + 1] if len(breaks) else rows

    @cached_property
    def held(self) -> float:
        """Duration of that run [s]."""
        rows = self.held_rows
        return float(self.track.time[rows[-1]] - self.track.time[rows[0]] + ROW) if len(rows) else 0.0

    @cached_property
    def held_before_shake(self) -> float:
        """Part of it before the shake began [s]."""
        shake = self.track.rows("shake")
        rows = self.held_rows
        rows = rows[rows < shake[0]] if len(shake) else rows
        return float(self.track.time[rows[-1]] - self.track.time[rows[0]] + ROW) if len(rows) else 0.0

    @cached_property
    def survived_shake(self) -> bool:
        """A shake took place, and it was still held at its end."""
        shake = self.track.rows("shake")
        return bool(len(shake) and len(self.held_rows) and self.held_rows[-1] >= shake[-1])

    @cached_property
    def slip_path(self) -> Array:
        """Way of the thing's point at the grasp centre in the hand since closing [m], (R, 3); 0 where it is not kept.

        The point is the thing's own material at the tool point when closing had ended; an object that only turns about
        the grip does not slip.
        """
        out = np.zeros((len(self.track), 3))
        if self.closed < 0:
            return out
        pose, tool = self.track.pose[:, self.column].astype(float), self.track.tool[:, :3].astype(float)
        point = point_in_body(pose[self.closed], tool[self.closed])
        offset = point_in_world(pose, point) - tool
        way = np.einsum("rji,rj->ri", self.track.tool_rotation, offset)
        out[self.kept] = way[self.kept]
        return out

    @cached_property
    def slip(self) -> float:
        """Largest such way until it was lost or put down [m]."""
        return float(np.linalg.norm(self.slip_path, axis=1).max())

    @cached_property
    def slip_apart(self) -> tuple[float, float]:
        """Slip while it was lifted, and on from there while it was held and shaken [m]."""
        lift, later = self.track.rows("lift"), self.track.rows("hold", "shake")
        path = self.slip_path
        lift, later = lift[self.kept[lift]], later[self.kept[later]]
        during = float(np.linalg.norm(path[lift], axis=1).max()) if len(lift) else 0.0
        start = path[lift[-1]] if len(lift) else np.zeros(3)
        after = float(np.linalg.norm(path[later] - start, axis=1).max()) if len(later) else 0.0
        return during, after

    @cached_property
    def grasp_point(self) -> Array | None:
        """Tool point in the thing's own frame when closing had ended, or None."""
        if self.closed < 0:
            return None
        return point_in_body(self.track.pose[self.closed, self.column], self.track.tool[self.closed, :3])


def grips(track: Track, layout: Layout, placed: PlacedScene) -> dict[str, Grip]:
    """One `Grip` per movable object."""
    return {thing.id: Grip(track, layout, thing) for thing in placed.objects if not thing.fixed}


def object_in_hand(all_grips: dict[str, Grip]) -> str | None:
    """The thing that the hand took or, if nothing rose, gripped: the one raised most, else the one pressed hardest."""
    taken = {name: grip.lifted for name, grip in all_grips.items() if grip.taken and grip.gripped}
    taken = taken or {name: grip.lifted for name, grip in all_grips.items() if grip.taken}
    if taken:
        return max(taken, key=lambda name: taken[name])
    pressed = {
        name: float(grip.track.pads[grip.closed, grip.column].sum()) for name, grip in all_grips.items() if grip.gripped
    }
    return max(pressed, key=lambda name: pressed[name]) if pressed else None
