"""What was damaged, toppled or disturbed in one motion (benchmark.md section 1). The thresholds are our proxies."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from kb.affordance import FRAGILE_NEIGHBOUR
from sim.pose import Array, angle_between
from sim.track import Layout, Track
from sim.verdict_grip import ROW, TOUCH, Grip

DROP_FRAGILITY, DROP_HEIGHT = 0.3, 0.05
"""A thing at least this fragile breaks when it falls farther than this [m]."""
DROP_SPEED = math.sqrt(2 * 9.81 * DROP_HEIGHT)
"""Speed that a free fall from `DROP_HEIGHT` ends with [m/s]."""
TOPPLE_TILT = math.radians(45.0)
"""A thing that stands more crookedly than this has toppled [rad]."""
FRAGILE_IMPULSE = 0.05
"""Contact impulse that a fragile neighbour bears [N s]."""
MOVED, TILTED = 0.005, math.radians(5.0)
"""A thing moved [m] or tilted [rad] farther than this was disturbed."""

Cause = Literal["force", "drop", "topple", "impulse"]


@dataclass(frozen=True)
class Damage:
    """One object came to harm."""

    object: str
    cause: Cause
    row: int
    by: str = ""
    """What pressed on it: "robot", "table" or another object's id."""


def peak_force(grip: Grip) -> tuple[Array, list[str]]:
    """Force between the thing and each single other body [N], (R, B), and the bodies' names."""
    track, column = grip.track, grip.column
    series = [track.pads[:, column, 0], track.pads[:, column, 1], track.robot[:, column], track.table[:, column]]
    names = ["robot", "robot", "robot", "table"]
    for number, (a, b) in enumerate(grip.layout.pairs):
        if grip.thing.id in (a, b):
            series.append(track.pair[:, number])
            names.append(b if a == grip.thing.id else a)
    return np.stack(series, axis=1).astype(float), names


def tilt(grip: Grip, upright: Array) -> Array:
    """Angle of the thing's own vertical axis to where it pointed at the start of the trial [rad], (R,)."""
    return angle_between(grip.track.rotation[:, grip.column, :, 2], upright)


def toppled(grip: Grip, upright: Array) -> int:
    """First row in which it lies more than 45 degrees off its first posture, not in the hand; or -1."""
    rows = np.flatnonzero((tilt(grip, upright) > TOPPLE_TILT) & ~grip.pinched)
    return int(rows[0]) if len(rows) else -1


def damages(all_grips: dict[str, Grip], uprights: dict[str, Array], meant: str | None) -> list[Damage]:
    """All damage of one motion, by row.

    Args:
        all_grips: One per movable object.
        uprights: Direction of each object's vertical axis at the start of the trial, (3,).
        meant: The object that was to be grasped; the impulse rule protects the others.
    """
    found: list[Damage] = []
    for name, grip in all_grips.items():
        thing = grip.thing
        force, bodies = peak_force(grip)
        rows, columns = np.nonzero(force > thing.damage_force)
        if len(rows):
            found.append(Damage(name, "force", int(rows[0]), bodies[int(columns[0])]))
        if thing.affordance.fragility >= DROP_FRAGILITY - 1e-9:
            falls = np.flatnonzero(grip.track.falling[:, grip.column] > DROP_SPEED)
            if len(falls):
                found.append(Damage(name, "drop", int(falls[0]), "table"))
        if thing.affordance.fragility >= FRAGILE_NEIGHBOUR - 1e-9:
            row = toppled(grip, uprights[name])
            if row >= 0:
                found.append(Damage(name, "topple", row))
            if name != meant and not handled(grip, meant):
                found.extend(_impulse(grip, meant))
    return sorted(found, key=lambda damage: damage.row)


def handled(grip: Grip, meant: str | None) -> bool:
    """Whether the thing was carried through the motion, or gripped in a motion of which nobody said what it was about.

    Such a thing is touched on purpose; it is no neighbour.
    """
    return bool(grip.pinched[0]) or (meant is None and (grip.gripped or grip.taken))


def disturbed(all_grips: dict[str, Grip], but: tuple[str | None, ...]) -> tuple[str, ...]:
    """Objects, except those named, that were moved more than 5 mm or tilted more than 5 degrees at any time."""
    out = []
    for name, grip in all_grips.items():
        if name in but:
            continue
        moved = displacement(grip).max() > MOVED
        if moved or tilt(grip, grip.track.rotation[0, grip.column, :, 2]).max() > TILTED:
            out.append(name)
    return tuple(out)


def displacement(grip: Grip) -> Array:
    """Way of the thing's middle since the start of the motion [m], (R,)."""
    return np.linalg.norm(grip.centre - grip.centre[0], axis=1)


def contact_from(grip: Grip, layout: Layout, track: Track, *, mean: bool = False) -> tuple[Array, list[str]]:
    """Force on the thing by robot and by other objects beyond what already rested on it [N], (R, B), and their names.

    The table and whatever the thing stands on or carries at the start press on it all the time; only the excess over
    the first row counts.
    """
    pair = track.pair_mean if mean else track.pair
    series = [track.robot_mean[:, grip.column] if mean else grip.pressed]
    names = ["robot"]
    for number, (a, b) in enumerate(layout.pairs):
        if grip.thing.id in (a, b):
            series.append(np.maximum(pair[:, number] - pair[0, number], 0.0))
            names.append(b if a == grip.thing.id else a)
    return np.stack(series, axis=1).astype(float), names


def _impulse(grip: Grip, meant: str | None) -> list[Damage]:
    """Whether robot or the meant object pressed on a fragile neighbour for more than the impulse it bears."""
    force, names = contact_from(grip, grip.layout, grip.track, mean=True)
    for column, name in enumerate(names):
        if name not in ("robot", meant):
            continue
        total = 0.0
        for row, value in enumerate(force[:, column]):
            total = total + value * ROW if value > TOUCH else 0.0
            if total > FRAGILE_IMPULSE:
                return [Damage(grip.thing.id, "impulse", row, name)]
    return []
