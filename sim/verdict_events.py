"""Anomalous events of one motion in time; the first one names the failure (physics.md: end states mislead).

An event that does no harm is no failure: labels are given only to attempts that failed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from kb.vocabulary import FailureType
from sim.pose import turn_between
from sim.quality import COMPLIANT, FIT_ALLOWANCE
from sim.track import Track
from sim.verdict_damage import Damage, contact_from
from sim.verdict_grip import OFF_GROUND, Grip

COLLISION_FORCE = 2.0
"""Contact with another object that counts as a collision [N] (benchmark.md section 3: the limit for the vase)."""
TABLE_FORCE = 5.0
"""Contact of the hand with the table that counts as arriving wrongly [N]; grazing it while gripping flat things is not."""
SLIP_LIMIT = 0.02
"""Slip in the hand that fails a grasp [m] (benchmark.md section 3)."""
LOSS_AFTER_SLIP = 25
"""Rows (0.5 s) within which a loss of contact belongs to the slip before it."""
TURNED_AWAY = np.radians(15.0)
"""Turn of an object while the fingers close on it that shows a wrong orientation [rad]."""
TIME_LIMIT = 60.0
"""Simulated time that an attempt may take [s] (benchmark.md section 3)."""


@dataclass(frozen=True)
class Event:
    """Something went wrong at a row of the track."""

    row: int
    type: FailureType
    reason: str


WidthAt = Callable[[int, float], float]
"""Width of the meant object between the fingers at a row, with the hand turned about its approach by an angle [m, rad]."""


def events(
    all_grips: dict[str, Grip], meant: str | None, in_hand: str | None, harm: list[Damage], width_at: WidthAt
) -> list[Event]:
    """All anomalous events, by row; of those in the same row the one found first here comes first."""
    found: list[Event] = []
    for name, grip in all_grips.items():
        if name != meant:
            found.extend(_collisions(grip, in_hand, meant))
    if meant is not None and meant in all_grips:
        grip = all_grips[meant]
        found.extend(_arrival(grip, width_at))
        found.extend(_closing(grip, in_hand, width_at))
        found.extend(_holding(grip))
    if all_grips:
        found.extend(_setting(next(iter(all_grips.values())).track))
    found.extend(_harm(harm, all_grips, meant))
    return sorted(found, key=lambda event: event.row)


def _collisions(grip: Grip, in_hand: str | None, meant: str | None) -> Iterator[Event]:
    """Robot, or the meant object in the hand, against another object."""
    track, name = grip.track, grip.thing.id
    force, others = contact_from(grip, grip.layout, track)
    close = track.rows("close")
    for column, other in enumerate(others):
        hit = force[:, column] > COLLISION_FORCE
        if other == "robot" and name == in_hand and len(close):
            # The hand closes on the wrong thing: before that a touch is a collision, from then on a wrong object.
            hit[close[0] :] = False
        elif other != "robot":
            if other != meant:
                continue
            hit[: max(grip.closed, 0)] = False
        rows = np.flatnonzero(hit)
        if len(rows):
            by = "the hand" if other == "robot" else other
            yield Event(int(rows[0]), "COLLISION", f"{by} hit {name} with {force[rows[0], column]:.1f} N")


def _arrival(grip: Grip, width_at: WidthAt) -> Iterator[Event]:
    """The hand pressed on the meant object before closing, harder than the abort reflex allows."""
    before = grip.track.rows("transit", "approach")
    limit = abort_limit(grip.thing.damage_force)
    hard = before[grip.pressed[before] > limit]
    if len(hard):
        row = int(hard[0])
        yield Event(row, _misfit(grip.track, row, width_at), f"pressed {limit:.0f} N on it before closing")


def _misfit(track: Track, row: int, width_at: WidthAt) -> FailureType:
    """Why a finger came down on the object: it would fit if centred, or if turned, or not at all."""
    opening = float(track.opening[row])
    here = width_at(row, 0.0)
    if here + FIT_ALLOWANCE <= opening:
        return "POSITION_ERROR"
    turned = [width_at(row, angle) for angle in np.radians([30.0, 60.0, 90.0, 120.0, 150.0])]
    best = min((width for width in turned if width > 0.0), default=here)
    if best + FIT_ALLOWANCE <= opening and best < here - 0.005:
        return "ORIENTATION"
    return "WIDTH_MISMATCH"


def _closing(grip: Grip, in_hand: str | None, width_at: WidthAt) -> Iterator[Event]:
    """The fingers closed, but not on the meant object."""
    if grip.closed < 0:
        return
    track, first = grip.track, int(grip.track.rows("close")[0])
    if in_hand is not None and in_hand != grip.thing.id:
        yield Event(first, "WRONG_OBJECT", f"the fingers closed on {in_hand}")
        return
    if grip.gripped or grip.taken:
        return
    rows = track.rows("close")
    if grip.touched[rows].any():
        rotation = track.rotation[:, grip.column]
        turned = float(turn_between(rotation[first], rotation[grip.closed]))
        if turned > TURNED_AWAY:
            yield Event(
                int(rows[-1]), "ORIENTATION", f"it turned {np.degrees(turned):.0f} degrees and left the fingers"
            )
            return
        if width_at(first, 0.0) + FIT_ALLOWANCE > float(track.opening[first]):
            yield Event(first, "WIDTH_MISMATCH", "it did not fit between the fingers")
            return
    yield Event(int(rows[-1]), "POSITION_ERROR", "the fingers closed beside it")


def _holding(grip: Grip) -> Iterator[Event]:
    """It moved in the hand or left it."""
    if grip.closed < 0:
        carried = grip.track.rows("carry", "set_down")
        if len(carried) and grip.touched[0] and not grip.touched[carried].all():
            yield Event(int(carried[np.argmin(grip.touched[carried])]), "DROP", "it was lost on the way")
        return
    if not (grip.gripped or grip.taken):
        return
    far = np.flatnonzero(np.linalg.norm(grip.slip_path, axis=1) > SLIP_LIMIT)
    slipped = int(far[0]) if len(far) else -1
    if grip.lost >= 0:
        raised = float(grip.rise[: grip.lost].max()) >= OFF_GROUND
        kind: FailureType = "DROP" if raised else "SLIP"
        if 0 <= slipped < grip.lost - LOSS_AFTER_SLIP:
            kind = "SLIP"
        row = grip.lost if slipped < 0 else min(slipped, grip.lost)
        yield Event(row, kind, "it left the hand" if raised else "the fingers slid off it")
    elif slipped >= 0:
        yield Event(slipped, "SLIP", f"it moved {grip.slip * 1e3:.0f} mm in the hand")


def _setting(track: Track) -> Iterator[Event]:
    """The hand struck the table; the time ran out."""
    rows = np.flatnonzero(track.robot_table > TABLE_FORCE)
    if len(rows):
        yield Event(int(rows[0]), "APPROACH_ANGLE", f"the hand pressed {track.robot_table[rows[0]]:.0f} N on the table")
    late = np.flatnonzero(track.time - track.time[0] > TIME_LIMIT)
    if len(late):
        yield Event(int(late[0]), "TIMEOUT", "60 s were over")


def _harm(harm: list[Damage], all_grips: dict[str, Grip], meant: str | None) -> Iterator[Event]:
    """Damage as an event: of the meant object by too much force or by falling, of another one by the hand."""
    for damage in harm:
        if damage.object != meant:
            yield Event(damage.row, "COLLISION", f"{damage.object}: {damage.cause}")
        elif damage.cause == "force":
            soft = all_grips[damage.object].thing.affordance.material in COMPLIANT
            yield Event(damage.row, "DEFORMATION" if soft else "FORCE_DAMAGE", "pressed harder than it bears")
        elif damage.cause == "drop":
            yield Event(damage.row, "DROP", "it fell")
        else:
            yield Event(damage.row, "COLLISION", "it was knocked over")


def abort_limit(damage_force: float) -> float:
    """Force on the target before closing that the abort reflex must not exceed [N] (benchmark.md section 3)."""
    return min(30.0, damage_force / 2.0)
