"""A small benchmark in a process of its own that may lose its life (not a test).

`killed_benchmark.py FOLDER WORKERS VICTIM AFTER DELAY`: after AFTER rows and DELAY seconds, VICTIM ("parent", "worker" or
"nobody") dies by SIGKILL. Runs what is missing in the folder.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
from pathlib import Path

from bench.job import BenchPlan
from bench.row import RowLine
from bench.runner import run_benchmark
from bench.suite import tasks_of
from tests.bench_fixtures import ANALYTIC

PLAN = BenchPlan(
    settings=ANALYTIC,
    tasks=tasks_of("tasks", ["single_cube", "cup_near_vase"]),
    configurations=("full", "heuristic"),
    trials=3,
)
"""Twelve rows, each in a fraction of a second."""


def main(folder: str, workers: str, victim: str, after: str, delay: str) -> None:
    """Runs the plan."""
    rows = 0

    def kill() -> None:
        children = multiprocessing.active_children()
        pid = os.getpid() if victim == "parent" else children[0].pid if children else None
        if pid is not None:
            os.kill(pid, signal.SIGKILL)

    def on_row(_done: int, _all: int, _row: RowLine) -> None:
        nonlocal rows
        rows += 1
        if victim != "nobody" and rows == int(after):
            threading.Timer(float(delay), kill).start()

    run_benchmark(PLAN, Path(folder), workers=int(workers), resume=True, on_row=on_row)


if __name__ == "__main__":
    main(*sys.argv[1:])
