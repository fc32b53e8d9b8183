"""Where the trials are from: command, commit, date and time of every run, as each folder's run.json tells."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bench.report.table import Table
from bench.report.value import Number

RUN = "run.json"


@dataclass(frozen=True)
class Sitting:
    """One command, with all the times that it was given again."""

    command: str
    commits: str
    """Short hashes, with a mark where files were changed since the commit."""
    finished: str
    minutes: float
    workers: str
    rows: int


def sittings(folder: Path) -> list[Sitting] | None:
    """What ran in a folder, in order; None if nothing is known."""
    path = folder / RUN
    if not path.is_file():
        return None
    known: list[dict[str, Any]] = json.loads(path.read_text(encoding="utf-8")).get("sessions", [])
    found: list[Sitting] = []
    for command in dict.fromkeys(str(one.get("command")) for one in known):
        own = [one for one in known if str(one.get("command")) == command]
        found.append(
            Sitting(
                command,
                ", ".join(dict.fromkeys(_commit(one.get("commit")) for one in own)),
                str(own[-1].get("finished")),
                sum(float(one.get("wall_s", 0.0)) for one in own) / 60,
                str(own[-1].get("workers")),
                sum(int(one.get("rows", 0)) for one in own),
            )
        )
    return found


def _commit(said: str | None) -> str:
    if said is None:
        return "unknown"
    return said[:8] + (" with uncommitted changes" if said.endswith("+") else "")


def table(folders: Sequence[Path]) -> Table | None:
    """The runs of all folders; None where none of them is known."""
    rows = tuple(
        (one.command, one.commits, one.finished, Number(one.minutes, 1), one.workers, one.rows)
        for folder in folders
        for one in sittings(folder) or ()
    )
    if not rows:
        return None
    return Table(
        "runs",
        "Where the trials are from",
        ("command", "commit", "finished", "minutes", "workers", "trials"),
        rows,
        "Trials: those that the command added to its folder. Minutes are wall time, with whatever else the machine did.",
    )
