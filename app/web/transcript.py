"""What was said and done, as the page shows it: one entry a step, kept with the session so that a reload finds it."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

from app.steps import DETAILS, LABELS
from app.verdict_block import attempt_line
from app.web.rows import is_lamp

KEPT = 400
"""Entries shown to a page that opens."""
MAX_BYTES = 2_000_000
"""Of the file: from here on it is written anew with the last `KEPT` entries."""
FILE = "transcript.jsonl"
MORE_LABELS = {
    "said": "You",
    "asked": "Approval",
    "heeded": "Heeded",
    "explained": "Why",
    "compared": "Compared",
    "whatif": "What if",
    "stopped": "Stopped",
    "noted": "Note",
    "refused": "Not done",
}


def entry_of(step: Any, *, stopped: bool = False) -> dict[str, Any] | None:
    """A step as an entry: who speaks, one sentence, and the numbers under it; None if it adds nothing.

    Args:
        step: Of the conversation.
        stopped: A person has stopped the robot; what it had reached by then is no mistake of its own.
    """
    if step.kind == "finished":
        return _verdict(step.result, stopped)
    label = LABELS[step.kind][0] if step.kind in LABELS else MORE_LABELS.get(step.kind, step.kind.capitalize())
    details = DETAILS.get(step.kind)
    first, *rest = str(step.text).splitlines() or [""]
    extra = [*rest, *((line for line in details(step) if line not in step.text) if details else ())]
    entry = {"kind": step.kind, "label": label, "text": first, "details": extra[:60]}
    if getattr(step, "pictures", None) and step.kind == "whatif":
        entry["picture"] = f"/session/{Path(step.pictures).name}"
    return entry


def _verdict(result: Any, stopped: bool) -> dict[str, Any] | None:
    """What the observer saw, beside what the robot claims; the answer itself has been said."""
    goals = [goal for goal in result.goals if goal.attempts or goal.verdict is not None]
    if not goals or not result.executed:
        return None
    stopped = stopped or any(
        attempt.evidence.get("stopped_by") == "stop" for goal in goals for attempt in goal.attempts
    )
    wrong = not stopped and any(goal.claimed != goal.success for goal in goals)
    text = f"The observer saw {'success' if result.success else 'no success'}."
    if wrong:
        text += " The robot is wrong about it."
    if result.damage_events:
        text += f" Damage events: {result.damage_events}."
    lines = [attempt_line(attempt) for goal in goals for attempt in goal.attempts]
    return {"kind": "finished", "label": "Verdict", "text": text, "details": lines[:40]}


def world_mark(state: Any) -> str:
    """Short name of the world as the last motion left it, the same in every process; empty while nothing has moved."""
    return hashlib.sha256(state.world).hexdigest()[:16] if state.world else ""


class Transcript:
    """The entries of one session, in memory and on disk."""

    def __init__(self, folder: Path | None) -> None:
        """Reads what an earlier process kept of the session in `folder`; None keeps entries in memory only."""
        self.entries: list[dict[str, Any]] = []
        self._path = None if folder is None else folder / FILE
        if self._path is not None and self._path.is_file():
            self.entries = _read(self._path)

    def lamps(self, mark: str) -> list[dict[str, Any]]:
        """The constraints as they were measured in the turn that left the world with this mark; empty if none did."""
        found = next((entry for entry in reversed(self.entries) if mark and entry.get("after") == mark), {})
        rows = found.get("lamps")
        return [row for row in rows if is_lamp(row)] if isinstance(rows, list) else []

    def add(self, entry: dict[str, Any]) -> None:
        """Appends an entry. On a full disk it is kept in memory; the checkpoints, which matter, say so themselves."""
        self.entries = [*self.entries[-KEPT + 1 :], entry]
        if self._path is None:
            return
        try:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            if self._path.is_file() and self._path.stat().st_size > MAX_BYTES:
                self._path.write_text("".join(json.dumps(e) + "\n" for e in self.entries), encoding="utf-8")
                return
            with self._path.open("a", encoding="utf-8") as stream:
                stream.write(json.dumps(entry) + "\n")
        except OSError:
            return


def _read(path: Path) -> list[dict[str, Any]]:
    """The last entries; lines that were cut off by a kill are left out."""
    try:
        with path.open("rb") as stream:
            stream.seek(max(0, path.stat().st_size - MAX_BYTES))
            lines = stream.read().decode("utf-8", errors="replace").splitlines()
    except OSError:
        return []
    entries = []
    for line in lines[-KEPT:]:
        try:
            entry = json.loads(line)
        except ValueError:
            continue
        if isinstance(entry, dict) and isinstance(entry.get("text"), str):
            entries.append(entry)
    return entries
