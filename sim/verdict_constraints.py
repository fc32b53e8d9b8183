"""Whether the constraints of a task were kept over the whole trial, by measurement (benchmark.md section 3)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from kb.vocabulary import ConstraintKind
from sim.placed import PlacedScene, Task
from sim.pose import Array, angle_between, degrees, point_in_world
from sim.track import Layout, Track
from sim.verdict_damage import contact_from, displacement, handled, tilt
from sim.verdict_grip import TOUCH, Grip

FORCE_LIMIT = 2.0
"""Contact force that a protected neighbour or an occluder may feel [N]."""
MOVE_LIMIT, TILT_LIMIT = 0.005, math.radians(5.0)
"""How far a protected neighbour may be moved [m] and tilted [rad]."""
OCCLUDER_MOVE = 0.010
"""How far the occluder may be moved for the task to succeed [m] (IT-b)."""
SPILL_LIMIT, CONTENT_TILT = 0.10, math.radians(15.0)
"""Share of the contents that may be lost, and how far their container may be tilted [rad] (S1)."""
BEND_FORCE = 35.0
"""Force at which a phone bends [N] (IT-c)."""
SUPPORT_MOVE = 0.01
"""The supporting object counts as moved from here on [m]."""
TOOL_TILT = (math.radians(30.0), math.radians(60.0))
"""Approach to a tool, off vertical [rad] (IT-d; ledger G38)."""
TOOL_ACROSS = math.radians(20.0)
"""How far the closing axis may be off the perpendicular to the shaft [rad] (IT-d)."""


@dataclass(frozen=True)
class Trial:
    """All motions of a trial, in order, with what the observer knows about them."""

    placed: PlacedScene
    layout: Layout
    motions: tuple[dict[str, Grip], ...]
    """One grip per movable object, for each motion."""
    meants: tuple[str | None, ...]
    """The object that each motion was about."""
    start: dict[str, Array]
    """Pose of each object at the start of the trial, (7,)."""
    uprights: dict[str, Array]
    damaged: frozenset[str]
    """Objects that came to harm in any of the motions."""

    @property
    def attempted(self) -> bool:
        """A hand went towards something."""
        return any(len(_track(grips).rows("approach", "close")) for grips in self.motions if grips)

    def until(self, count: int) -> Trial:
        """The trial as far as the first `count` motions."""
        return Trial(
            self.placed, self.layout, self.motions[:count], self.meants[:count], self.start, self.uprights, self.damaged
        )


def measure(kind: ConstraintKind, target: str, trial: Trial) -> tuple[bool, dict[str, Any]]:
    """Whether a constraint was satisfied, and the numbers behind it.

    Args:
        kind: The constraint.
        target: Scene id of the neighbour, occluder, supported object or container.
        trial: What happened. Without any attempt nothing is satisfied.
    """
    if target not in trial.layout.objects:
        return False, {"note": "not a movable object"}
    if kind == "collision":
        kept, numbers = _left_alone(target, trial)
        good = kept and numbers["displacement_mm"] < MOVE_LIMIT * 1e3 and numbers["tilt_deg"] < degrees(TILT_LIMIT)
    elif kind == "occlusion":
        good, numbers = _left_alone(target, trial)
    elif kind == "content":
        good, numbers = _content_kept(target, trial)
    else:
        good, numbers = _removed_first(target, trial)
    return good and trial.attempted, numbers


def _left_alone(target: str, trial: Trial) -> tuple[bool, dict[str, Any]]:
    """Contact force below the limit in every motion that was not about the target itself; with movement and tilt."""
    force, moved, tilted = 0.0, 0.0, 0.0
    for grips, meant in zip(trial.motions, trial.meants, strict=True):
        if meant == target or target not in grips or handled(grips[target], meant):
            continue
        grip = grips[target]
        force = max(force, float(contact_from(grip, trial.layout, grip.track)[0].max()))
        moved = max(moved, float(displacement(grip).max()))
        tilted = max(tilted, float(tilt(grip, trial.uprights[target]).max()))
    numbers = {"force_n": round(force, 3), "displacement_mm": round(moved * 1e3, 2), "tilt_deg": degrees(tilted)}
    return force < FORCE_LIMIT, numbers


def _content_kept(target: str, trial: Trial) -> tuple[bool, dict[str, Any]]:
    """Not more than a tenth of the contents lost; with the container's largest tilt."""
    if target not in trial.layout.containers:
        return False, {"note": "holds nothing"}
    column = trial.layout.containers.index(target)
    lost, tilted, first = 0.0, 0.0, None
    for grips in trial.motions:
        if target not in grips:
            continue
        share = grips[target].track.content[:, column]
        first = float(share[0]) if first is None else first
        lost = max(lost, (first - float(share[-1])) / max(first, 1e-9))
        # The shake is the examiner's, not the robot's: it tilts the hand by as much as the limit.
        calm = np.ones(len(grips[target].track), bool)
        calm[grips[target].track.rows("shake")] = False
        tilted = max(tilted, float(tilt(grips[target], trial.uprights[target])[calm].max(initial=0.0)))
    return lost <= SPILL_LIMIT + 1e-9, {"spilled": round(lost, 3), "tilt_deg": degrees(tilted)}


def _removed_first(target: str, trial: Trial) -> tuple[bool, dict[str, Any]]:
    """The supported object was taken away and put down unharmed before its supporter moved."""
    if not trial.motions:
        return False, {"note": "nothing was attempted"}
    supporter = supporter_of(target, trial)
    if supporter is None:
        return False, {"note": "rests on nothing movable"}
    numbers: dict[str, Any] = {"supporter": supporter, "supporter_moved": False}
    last: tuple[Grip, Grip, int] | None = None
    for grips in trial.motions:
        if target not in grips:
            continue
        below, above = grips[supporter], grips[target]
        middle = point_in_world(trial.start[supporter], (0.0, 0.0, below.thing.size[2] / 2))
        rows = np.flatnonzero(np.linalg.norm(below.centre - middle, axis=1) > SUPPORT_MOVE)
        last = (above, below, int(rows[0]) if len(rows) else len(above.track) - 1)
        if len(rows):
            numbers["supporter_moved"] = True
            break
    if last is None:
        return False, numbers
    above, below, row = last
    away = float(np.linalg.norm(above.centre[row, :2] - below.centre[row, :2]))
    numbers["distance_mm"] = round(away * 1e3, 1)
    numbers["in_hand"] = bool(above.touched[row])
    numbers["damaged"] = target in trial.damaged
    touching = _pair_force(above, supporter)[row] > TOUCH
    clear = away > (min(above.thing.size[:2]) + min(below.thing.size[:2])) / 4
    return bool(clear and not touching and not numbers["in_hand"] and not numbers["damaged"]), numbers


def supporter_of(target: str, trial: Trial) -> str | None:
    """The movable object that the target stands on at the start: it touches it and its middle is lower."""
    for grips in trial.motions:
        if target in grips:
            grip = grips[target]
            touching = [other for other in grips if other != target and _pair_force(grip, other)[0] > TOUCH]
            below = [other for other in touching if grips[other].centre[0, 2] < grip.centre[0, 2]]
            return below[0] if below else None
    return None


def _pair_force(grip: Grip, other: str) -> Array:
    for number, pair in enumerate(grip.layout.pairs):
        if set(pair) == {grip.thing.id, other}:
            return grip.track.pair[:, number].astype(float)
    return np.zeros(len(grip.track))


def task_conditions(task: Task | None, meant: str | None, trial: Trial) -> dict[str, bool]:
    """The task's conditions beyond the general definition, as far as they concern this object; name -> kept."""
    if task is None or meant is None:
        return {}
    kept: dict[str, bool] = {}
    for required in task.required:
        good, numbers = measure(required.kind, required.target, trial)
        if required.kind == "collision":
            kept[f"{required.target} left alone"] = good
        elif required.kind == "occlusion" and "displacement_mm" in numbers:
            kept[f"{required.target} not moved"] = numbers["displacement_mm"] < OCCLUDER_MOVE * 1e3
        elif required.kind == "content":
            kept[f"{required.target} kept its contents"] = good and numbers["tilt_deg"] <= degrees(CONTENT_TILT)
    grip = trial.motions[-1].get(meant)
    if grip is None:
        return kept
    if grip.thing.model == "smartphone" and meant == task.target:
        kept["not bent"] = float(grip.pressed.max()) < BEND_FORCE
    if task.side_grasp_of == meant:
        kept.update(tool_conditions(grip))
    return kept


def tool_conditions(grip: Grip) -> dict[str, bool]:
    """The side grasp of a tool: on its handle, 30 to 60 degrees off vertical, across the shaft (IT-d)."""
    handle = next((part for part in grip.thing.parts if part.region == "handle"), None)
    if grip.closed < 0 or handle is None or grip.grasp_point is None:
        return {"side grasp": False}
    track: Track = grip.track
    hand = track.tool_rotation[grip.closed]
    off_vertical = float(angle_between(hand[:, 2], np.array([0.0, 0.0, -1.0])))
    shaft = track.rotation[grip.closed, grip.column] @ np.asarray(handle.axis, float)
    off_across = abs(math.pi / 2 - float(angle_between(hand[:, 1], shaft)))
    along = abs(float((grip.grasp_point - np.asarray(handle.centre)) @ np.asarray(handle.axis)))
    return {
        "on the handle": along <= handle.length / 2,
        "30 to 60 degrees off vertical": TOOL_TILT[0] <= off_vertical <= TOOL_TILT[1],
        "across the shaft": off_across <= TOOL_ACROSS,
    }


def required_targets(task: Task | None) -> Sequence[tuple[ConstraintKind, str]]:
    """The constraints that a task requires."""
    return [] if task is None else [(required.kind, required.target) for required in task.required]


def _track(grips: dict[str, Grip]) -> Track:
    return next(iter(grips.values())).track
