"""The motions of a conversation as a person looks back on them: forces felt, what was claimed, what the observer saw.

It is filled by the steps of the conversation and by the sensors' recordings, and kept with the session: the agent's own
state has neither force curves nor the observer's word, so that no motion can be decided by them.
"""

from __future__ import annotations

import hashlib
import json
import math
import threading
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, TypeAdapter, ValidationError

from kb.base import Finite, Noun

if TYPE_CHECKING:
    from agent.state import State

SHOWN = 24
"""Motions shown, the latest."""
KEPT, MAX_BYTES = 72, 2_000_000
"""Motions kept with the session, those of other branches too; a larger file is not one of ours [bytes]."""
CURVE_POINTS = 240
"""Most points of a force curve."""
FILE = "attempts.json"

Text = Annotated[str, Field(max_length=200)]


class Seen(Noun):
    """What the observer measured of a grasp, in centimetres, seconds, millimetres and newtons."""

    lifted: Finite
    held: Finite
    slip: Finite
    peak: Finite
    damage: tuple[Text, ...] = ()
    disturbed: tuple[Text, ...] = ()


class Row(Noun):
    """One motion."""

    motion: int
    attempt: int
    level: int
    tool: Text
    force: Finite | None = None
    """Planned force [N]."""
    state: Literal["moving", "claimed", "failed", "stopped", "done"] = "moving"
    failure: Text | None = None
    """The robot's own diagnosis."""
    observed: bool | None = None
    """The observer's word; None until the turn has ended."""
    observed_failure: Text | None = None
    correction: Text | None = None
    curve: Annotated[tuple[tuple[Finite, Finite, Finite], ...], Field(max_length=2 * CURVE_POINTS)] = ()
    """Simulated time [s], force of the fingers and of the wrist [N]."""
    phases: Annotated[tuple[tuple[Text, Finite], ...], Field(max_length=60)] = ()
    verdict: Seen | None = None
    mark: Text = ""
    """Digest of grasp and sensing: tells the same motion from another one of that number on another branch."""
    after: Text = ""
    """Mark of the motion before it."""


_ROWS: TypeAdapter[tuple[Row, ...]] = TypeAdapter(tuple[Row, ...])


class Timeline:
    """The rows, the oldest first. `tell` is called whenever they change; methods may be called from any thread."""

    def __init__(self, tell: Callable[[list[dict[str, Any]]], None] | None = None) -> None:
        self._tell = tell
        self._lock = threading.RLock()
        self._rows: list[Row] = []
        self._kept: list[Row] = []
        self._words: dict[int, tuple[Row, str]] = {}
        """The kept rows and their JSON, by the row's identity."""
        self._grasps: dict[int, Any] = {}
        self._file: Path | None = None

    @property
    def rows(self) -> list[dict[str, Any]]:
        """What is shown, as plain data."""
        return [row.model_dump(mode="json") for row in self._rows]

    def row_of(self, state: State, number: int | None = None) -> Row | None:
        """The row of an attempt of the conversation (the last one without a number), if it is known."""
        made = [a for a in state.attempts if number in (None, a.number)]
        wanted = _mark(made[-1].plan.grasp, made[-1].sensing) if made else None
        return next((row for row in reversed(self._rows) if row.mark == wanted), None)

    # A session that is taken up ------------------------------------------------------------------------------------

    def open(self, folder: Path | None, state: State, motions: int) -> None:
        """Shows the motions up to where the conversation stands.

        Args:
            folder: Folder of the session, or None where nothing is kept.
            state: As saved; its attempts are shown also where their forces were not kept.
            motions: Motions of the world so far; later ones belong to another branch.
        """
        with self._lock:
            self._file = None if folder is None else folder / FILE
            self._kept, self._words = [] if self._file is None else _read(self._file), {}
            self._grasps = {}
            self._show(_restored(self._kept, state, motions))

    def save(self) -> None:
        """Keeps the motions with the session; a disk that is full costs their forces after a restart, nothing else."""
        if self._file is None or not self._rows:
            return
        with self._lock:
            ended = [row for row in self._rows if row.state != "moving"]
            new = {(row.motion, row.mark) for row in ended}
            self._kept = [*(row for row in self._kept if (row.motion, row.mark) not in new), *ended][-KEPT:]
            # Rows never change once they are made, so each is put into words once.
            self._words = {id(row): self._words.get(id(row)) or (row, _words(row)) for row in self._kept}
            text = f"[{', '.join(words for _, words in self._words.values())}]"
        try:
            part = self._file.with_suffix(".part")
            part.write_text(text, encoding="utf-8")
            part.replace(self._file)
        except OSError:
            return

    # What happens --------------------------------------------------------------------------------------------------

    def on_step(self, step: Any) -> None:
        """Takes from a step of the conversation what belongs here."""
        take = getattr(self, f"_on_{step.kind}", None)
        if take is not None:
            with self._lock:
                take(step)

    def _on_action(self, step: Any) -> None:
        grasp = step.plan.grasp if step.plan is not None else None
        self._grasps[step.motion] = grasp
        row = Row(
            motion=step.motion, attempt=step.attempt, level=step.level, tool=step.tool,
            force=None if grasp is None else grasp.force, after=self._rows[-1].mark if self._rows else "",
        )  # fmt: skip
        self._show([*self._rows, row])

    def _on_observation(self, step: Any) -> None:
        """Of the grasp in work, also when what it left in the hand was put back before it was judged."""
        moving = [i for i, row in enumerate(self._rows) if row.state == "moving"]
        if not moving:
            return
        grasps = [i for i in moving if self._rows[i].tool == "execute_grasp"]
        judged = (grasps or moving)[-1]
        # What was put back in between has no observation of its own; it follows the grasp that is judged now.
        rows = [row.model_copy(update={"state": "done"}) if i in moving else row for i, row in enumerate(self._rows)]
        row, stopped = rows[judged], step.sensing is not None and step.sensing.stopped_by == "stop"
        rows[judged] = row.model_copy(
            update={
                "state": "stopped" if stopped else "claimed" if step.claimed else "failed", "failure": step.failure,
                "mark": "" if step.sensing is None else _mark(self._grasps.get(row.motion), step.sensing),
            }
        )  # fmt: skip
        for i in (i for i in moving if i > judged):
            rows[i] = rows[i].model_copy(update={"after": rows[i - 1].mark, "mark": f"{rows[i - 1].mark}+"})
        self._show(rows)
        self.save()

    def _on_reflection(self, step: Any) -> None:
        if step.correction is not None:
            grasps = [i for i, row in enumerate(self._rows) if row.tool == "execute_grasp"]
            self._change(grasps[-1] if grasps else None, correction=step.correction.rule)

    def _on_finished(self, step: Any) -> None:
        records = [record for goal in step.result.goals for record in goal.attempts]
        # The last grasps on the timeline are those of this turn; placings carry no record of their own.
        grasps = (
            [i for i, row in enumerate(self._rows) if row.tool == "execute_grasp"][-len(records) :] if records else []
        )
        for index, record in zip(grasps, records, strict=False):
            observed = {"observed": bool(record.success), "observed_failure": record.observed_failure}
            self._change(index, **observed, verdict=seen(record.verdict))
        self.save()

    def forces(self, samples: Sequence[dict[str, Any]]) -> None:
        """The forces sensed so far in the running motion."""
        with self._lock:
            if self._rows and samples and self._rows[-1].state == "moving":
                motion = samples[-1]["motion"]
                drawn = curve([sample for sample in samples if sample["motion"] == motion])
                grasp = self._grasps.pop(self._rows[-1].motion, None)
                self._grasps[motion] = grasp
                self._change(len(self._rows) - 1, motion=motion, **drawn)

    def _change(self, index: int | None, **changes: Any) -> None:
        if index is not None:
            rows = list(self._rows)
            rows[index] = rows[index].model_copy(update=changes)
            self._show(rows)

    def _show(self, rows: list[Row]) -> None:
        self._rows = rows[-SHOWN:]
        if self._tell is not None:
            self._tell(self.rows)


def _words(row: Row) -> str:
    return json.dumps(row.model_dump(mode="json", exclude_defaults=True))


def curve(samples: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Force samples thinned to what a plot can show, and where the phases begin."""
    start = samples[0]["t"]
    step = max(1, math.ceil(len(samples) / CURVE_POINTS))
    points: list[tuple[float, float, float]] = []
    for first in range(0, len(samples), step):
        part = samples[first : first + step]
        # Peaks must survive: of each group the largest value is kept.
        grip, wrist = (max(sample[key] for sample in part) for key in ("grip_n", "wrist_n"))
        points.append((round(part[0]["t"] - start, 2), round(grip, 2), round(wrist, 2)))
    phases: list[tuple[str, float]] = []
    for sample in samples:
        if not phases or phases[-1][0] != sample["phase"]:
            phases.append((sample["phase"], round(sample["t"] - start, 2)))
    return {"curve": tuple(points), "phases": tuple(phases[:60])}


def seen(verdict: Any) -> Seen | None:
    """The observer's measurements of one grasp."""
    if verdict is None:
        return None
    return Seen(
        lifted=round(verdict.lifted_m * 100, 1), held=round(verdict.held_s, 1), slip=round(verdict.slip_m * 1000, 1),
        peak=round(verdict.peak_force_n, 1), damage=tuple(verdict.damage), disturbed=tuple(verdict.disturbed),
    )  # fmt: skip


def _restored(kept: Sequence[Row], state: State, motions: int) -> list[Row]:
    """The attempts of the state with what was kept of them, and the placings that led from one to the next."""
    known = {row.mark: row for row in kept if row.mark}
    placings = {row.mark: row for row in kept if row.mark and row.tool != "execute_grasp"}
    rows: list[Row] = []
    for attempt in state.attempts:
        row = known.get(_mark(attempt.plan.grasp, attempt.sensing)) or _bare(attempt)
        before: list[Row] = []
        while (one := placings.pop(before[0].after if before else row.after, None)) is not None:
            before.insert(0, one)
        rows += [*before, row]
    while rows:
        follow = [one for one in placings.values() if one.after == rows[-1].mark and one.motion <= motions]
        if not follow:
            break
        rows.append(placings.pop(follow[-1].mark))
    return rows


def _bare(attempt: Any) -> Row:
    """An attempt of which only the agent's own record is left."""
    return Row(
        motion=attempt.motion, attempt=attempt.number, level=attempt.level, tool="execute_grasp",
        force=attempt.plan.grasp.force, state="claimed" if attempt.claimed else "failed",
        failure=None if attempt.claimed else attempt.failure, mark=_mark(attempt.plan.grasp, attempt.sensing),
    )  # fmt: skip


def _mark(grasp: Any, sensing: Any) -> str:
    text = f"{'' if grasp is None else grasp.model_dump_json()}{sensing.model_dump_json()}"
    return hashlib.blake2b(text.encode(), digest_size=12).hexdigest()


def _read(path: Path) -> list[Row]:
    """What an earlier process kept; a file that is damaged counts as none."""
    try:
        return [] if path.stat().st_size > MAX_BYTES else list(_ROWS.validate_json(path.read_bytes()))[-KEPT:]
    except (OSError, ValidationError):
        return []
