"""Jobs on a Dask cluster: workers anywhere that have this package installed; a killed worker's jobs go to the others.

Results come back as text, so that scheduler and client need nothing but the standard library's types. Needs the extra
`cluster`.
"""

from __future__ import annotations

import logging
from collections.abc import Iterator, Sequence
from typing import Any

from bench.job import Job
from bench.row import RowLine, error_row
from kb.errors import EnvironmentFaultError

log = logging.getLogger(__name__)

CONNECT_S = 10.0
"""How long the scheduler is waited for [s]."""
LIVES = 3
"""Deaths of workers in one and the same job after which it counts as a harness error."""


def run_on_dask(jobs: Sequence[Job], address: str, *, connect_s: float = CONNECT_S) -> Iterator[RowLine]:
    """All rows of all jobs, job by job in the order in which they are finished.

    Args:
        jobs: What is to be run.
        address: Address of the scheduler, for example tcp://127.0.0.1:8786.
        connect_s: How long the scheduler is waited for [s].

    Raises:
        EnvironmentFaultError: Dask is not installed, or no scheduler answers.
    """
    client, as_completed = _client(address, connect_s)
    try:
        futures = {client.submit(run_as_text, job.model_dump_json(), pure=False, retries=0): job for job in jobs}
        for future in as_completed(list(futures), loop=client.loop):
            job = futures.pop(future)
            if future.status == "finished":
                lines: list[tuple[Any, ...]] = future.result()
                yield from (RowLine(*line) for line in lines)
            else:
                said = f"{type(future.exception()).__name__}: {future.exception()}"
                log.warning("%s seed %d did not run: %s", job.task.name, job.seed, said)
                yield from (error_row(job, configuration, said).line for configuration in job.configurations)
            future.release()
    finally:
        client.close()


def run_as_text(job: str) -> list[tuple[Any, ...]]:
    """Runs a job on a worker: JSON in, the fields of `RowLine` out."""
    from bench.run_job import run_job

    return [tuple(row.line) for row in run_job(Job.model_validate_json(job))]


def _client(address: str, connect_s: float) -> tuple[Any, Any]:
    """A client of the scheduler, and Dask's way to wait for results."""
    try:
        import dask.config
        from distributed import Client, as_completed
    except ImportError as error:
        raise EnvironmentFaultError(
            "--dask needs the packages dask and distributed", mend="pip install 'agentic-rag-vlm[cluster]'"
        ) from error
    dask.config.set({"distributed.scheduler.allowed-failures": LIVES})
    try:
        return Client(address, timeout=connect_s, set_as_default=False), as_completed
    except (OSError, ValueError) as error:
        raise EnvironmentFaultError(
            f"no Dask scheduler answers at {address}", mend="start one with `dask scheduler`, and `dask worker ADDRESS`"
        ) from error
