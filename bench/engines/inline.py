"""Jobs one after the other in this process: for one worker, profiling and tests."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from bench.job import Job
from bench.row import RowLine
from bench.run_job import run_job, tidied_here


def run_inline(jobs: Sequence[Job]) -> Iterator[RowLine]:
    """All rows of all jobs, in order."""
    with tidied_here():
        for job in jobs:
            for row in run_job(job):
                yield row.line
