"""Runs a benchmark: what is still missing of the plan, on the chosen engine, every row on disk as soon as it is there."""

from __future__ import annotations

import subprocess
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from bench.job import BenchPlan, Job, jobs
from bench.journal import TRIALS, Journal
from bench.row import RowLine

TOLD_EVERY_S = 10.0
"""How often the record of the sitting is brought up to date [s]."""

OnRow = Callable[[int, int, RowLine], None]
"""Told after each row: rows of the plan done, rows of the plan in all, the row."""


@dataclass(frozen=True)
class Outcome:
    """What one sitting did."""

    folder: Path
    rows: int
    """Rows of the plan."""
    ran: int
    """Rows that this sitting added."""
    harness_errors: int
    """Of those, trials that the harness could not carry out."""
    wall_s: float
    """Wall time of all sittings of the folder [s]."""
    workers: int
    repaired: tuple[str, ...] = field(default=())
    """What was mended in the journal before."""


def run_benchmark(
    plan: BenchPlan,
    folder: Path,
    *,
    workers: int = 1,
    dask: str | None = None,
    resume: bool = False,
    command: str = "",
    on_start: Callable[[int, int, Sequence[str]], None] = lambda _done, _all, _repaired: None,
    on_row: OnRow = lambda _done, _all, _row: None,
) -> Outcome:
    """Runs what is missing of the plan and appends it to the folder's trials.

    Args:
        plan: What the finished benchmark has.
        folder: Output folder.
        workers: Processes of this machine; 1 runs in this one.
        dask: Address of a Dask scheduler that runs the jobs instead.
        resume: Go on with the trials that are in the folder.
        command: What was typed, for the record.
        on_start: Told once: rows that are there, rows in all, what was mended.
        on_row: Told after each row.

    Raises:
        BadInputError: the folder can't be used.
        EnvironmentFaultError: workers or cluster are not to be had.
    """
    with Journal(folder, plan.settings, resume=resume) as journal:
        todo = jobs(plan, journal.done)
        done = plan.rows - sum(len(job.configurations) for job in todo)
        on_start(done, plan.rows, journal.repaired)
        sitting = _Sitting(journal, command, workers, dask)
        ran = errors = 0
        try:
            for rows in _rows(todo, workers, dask):
                journal.append(*rows)
                for row in rows:
                    ran += 1
                    errors += row.harness_error is not None
                    sitting.tell(ran)
                    on_row(done + ran, plan.rows, row)
        finally:
            sitting.tell(ran, last=True)
        return Outcome(
            folder=folder,
            rows=plan.rows,
            ran=ran,
            harness_errors=errors,
            wall_s=sum(float(sitting["wall_s"]) for sitting in journal.sessions),
            workers=workers,
            repaired=tuple(journal.repaired),
        )


class _Sitting:
    """Keeps the folder's record of this sitting up to date, so that a kill loses little of the wall time."""

    def __init__(self, journal: Journal, command: str, workers: int, dask: str | None) -> None:
        self._journal = journal
        self._known: dict[str, Any] = {
            "command": command,
            "commit": _commit(),
            "workers": workers,
            "engine": f"dask {dask}" if dask else "processes" if workers > 1 else "inline",
        }
        self._start = time.perf_counter()
        self._told = -TOLD_EVERY_S

    def tell(self, rows: int, *, last: bool = False) -> None:
        """Writes the record if it is time, or the last one."""
        spent = time.perf_counter() - self._start
        if not last and spent - self._told < TOLD_EVERY_S:
            return
        self._told = spent
        now = time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime())
        self._journal.note_session({**self._known, "rows": rows, "wall_s": round(spent, 3), "finished": now})


def _commit() -> str | None:
    """The commit of the code that runs, with a plus if files were changed since; None outside a repository."""
    here = Path(__file__).parent
    try:
        said = [
            subprocess.run(["git", *words], cwd=here, capture_output=True, text=True, timeout=10.0, check=True).stdout
            for words in (("rev-parse", "HEAD"), ("status", "--porcelain", "--untracked-files=no"))
        ]
    except (OSError, subprocess.SubprocessError):
        return None
    return said[0].strip() + ("+" if said[1].strip() else "")


def _rows(todo: Sequence[Job], workers: int, dask: str | None) -> Iterator[Sequence[RowLine]]:
    """The rows of the jobs, from the engine that fits: those together that are written together."""
    if not todo:
        return iter(())
    if dask is not None:
        from bench.engines.dask_cluster import run_on_dask

        return ((row,) for row in run_on_dask(todo, dask))
    if workers > 1:
        from bench.engines.processes import batches_of_processes

        return batches_of_processes(todo, workers)
    from bench.engines.inline import run_inline

    return ((row,) for row in run_inline(todo))


def trials_file(folder: Path) -> Path:
    """Where the rows are."""
    return folder / TRIALS
