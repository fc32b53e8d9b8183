"""Jobs over worker processes of this machine; a worker that dies or hangs is replaced, and its job goes on elsewhere.

The standard pool gives up when a worker is killed and can't say what it was doing. Here every worker has a pipe of its
own, sends each row as soon as it is finished, and the parent knows which trial was in work when a pipe breaks.
"""

from __future__ import annotations

import logging
import multiprocessing
import os
import threading
import time
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess

from bench.job import Job, RowKey
from bench.row import RowLine, error_row
from kb.errors import EnvironmentFaultError

log = logging.getLogger(__name__)

LIVES = 3
"""Deaths of a worker in one and the same trial after which the trial counts as a harness error."""
DEATHS_IN_A_ROW = 10
"""Deaths without any finished row between them after which the machine is blamed."""
PATIENCE_S = 900.0
"""A worker that finishes no row for so long hangs [s]; the slowest trial takes about a minute on a busy machine."""
THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def run_in_processes(jobs: Sequence[Job], workers: int, *, patience: float = PATIENCE_S) -> Iterator[RowLine]:
    """All rows of all jobs, in the order in which they are finished; as `batches_of_processes`."""
    for rows in batches_of_processes(jobs, workers, patience=patience):
        yield from rows


def batches_of_processes(
    jobs: Sequence[Job], workers: int, *, patience: float = PATIENCE_S
) -> Iterator[Sequence[RowLine]]:
    """All rows of all jobs, those that have come since the last ones together, so that they can be written in one go.

    Args:
        jobs: What is to be run.
        workers: Number of processes, at least one.
        patience: Time without a row after which a worker is killed and replaced [s].

    Raises:
        EnvironmentFaultError: workers die whatever they do.
    """
    pool = _Pool(deque(jobs), patience)
    try:
        pool.hire(min(workers, len(jobs)))
        while pool.busy:
            yield pool.next_rows()
    finally:
        pool.dismiss()


@dataclass
class _Worker:
    process: BaseProcess
    pipe: Connection
    job: Job | None = None
    """What it is doing; the configurations of finished rows are taken off."""
    next: Job | None = None
    """What it has been given to do after that, so that it need not wait while rows are written."""
    since: float = 0.0
    """When it was last heard of [s]."""


class _Pool:
    def __init__(self, waiting: deque[Job], patience: float) -> None:
        self._waiting = waiting
        self._patience = patience
        self._workers: list[_Worker] = []
        self._deaths: dict[RowKey, int] = {}
        self._in_a_row = 0
        # "spawn": a worker starts clean, whatever threads the parent has, and inherits no open files.
        self._context = multiprocessing.get_context("spawn")

    @property
    def busy(self) -> bool:
        """Whether anything is left to do or to wait for."""
        return bool(self._waiting) or any(worker.job is not None for worker in self._workers)

    def hire(self, count: int) -> None:
        """Starts workers and gives each a job."""
        for name in THREAD_VARIABLES:
            # The processes are the parallelism; numerical libraries read this once, at their import in the child.
            os.environ[name] = "1"
        for _ in range(count):
            here, there = self._context.Pipe()
            process = self._context.Process(target=_work, args=(there,), name="ragvlm-bench", daemon=True)
            process.start()
            there.close()
            worker = _Worker(process, here)
            self._workers.append(worker)
            self._employ(worker)

    def _employ(self, worker: _Worker) -> None:
        """The worker's next job, and one ahead unless so few are left that another worker would wait for it."""
        worker.job, worker.next = worker.next or self._hand_out(worker), None
        worker.since = time.monotonic()
        if worker.job is not None and len(self._waiting) > len(self._workers):
            worker.next = self._hand_out(worker)

    def _hand_out(self, worker: _Worker) -> Job | None:
        job = self._waiting.popleft() if self._waiting else None
        if job is not None:
            with suppress(OSError):  # it is dead: the broken pipe is found when it is read
                worker.pipe.send(job)
        return job

    def next_rows(self) -> list[RowLine]:
        """Waits until somebody reports, dies or is overdue; what came of it."""
        rows = list[RowLine]()
        pipes: dict[object, _Worker] = {worker.pipe: worker for worker in self._workers if worker.job is not None}
        for ready in wait(list(pipes), timeout=1.0):  # type: ignore[arg-type]
            rows += self._hear(pipes[ready])
        for worker in list(self._workers):
            if worker.job is not None and time.monotonic() - worker.since > self._patience:
                log.warning("a worker finished nothing for %.0f s and is replaced", self._patience)
                worker.process.kill()
                worker.since = time.monotonic()
        return rows

    def _hear(self, worker: _Worker) -> Iterator[RowLine]:
        """All that it has said by now."""
        while worker.job is not None and worker.pipe.poll():
            try:
                told: RowLine | None = worker.pipe.recv()
            except (EOFError, OSError):
                yield from self._bury(worker)
                return
            worker.since = time.monotonic()
            if told is None:
                self._employ(worker)
                continue
            left = tuple(name for name in worker.job.configurations if name != told.configuration)
            worker.job = worker.job.model_copy(update={"configurations": left})
            self._in_a_row = 0
            yield told

    def _bury(self, worker: _Worker) -> Iterator[RowLine]:
        """Replaces a dead worker; what it left undone is done by another, unless it has cost too many lives."""
        worker.process.join()
        code, job = worker.process.exitcode, worker.job
        if worker.next is not None:
            self._waiting.appendleft(worker.next)
        self._workers.remove(worker)
        worker.pipe.close()
        self._in_a_row += 1
        if self._in_a_row >= DEATHS_IN_A_ROW:
            raise EnvironmentFaultError(
                f"the last {DEATHS_IN_A_ROW} workers died before they finished anything (exit code {code})",
                mend="look for a lack of memory, try --workers 1, and go on with --resume",
            )
        if job is not None and job.configurations:
            key = job.key(job.configurations[0])
            self._deaths[key] = self._deaths.get(key, 0) + 1
            log.warning("a worker died (exit code %s) in %s; it is replaced", code, key)
            if self._deaths[key] >= LIVES:
                said = f"the worker process died {LIVES} times here, last with exit code {code}"
                yield error_row(job, key[0], said).line
                job = job.model_copy(update={"configurations": job.configurations[1:]})
            if job.configurations:
                self._waiting.appendleft(job)
        if self._waiting:
            self.hire(1)

    def dismiss(self) -> None:
        """Ends all workers, whatever they do."""
        for worker in self._workers:
            worker.pipe.close()
            worker.process.terminate()
        for worker in self._workers:
            worker.process.join(5.0)
            if worker.process.is_alive():
                worker.process.kill()
                worker.process.join()
        self._workers.clear()


def _work(pipe: Connection) -> None:
    """Life of a worker: a job comes in, its rows go out, then None; it ends with its parent."""
    import signal

    # Ctrl-C goes to the whole group; the parent decides what becomes of the workers.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_follow_parent, daemon=True).start()
    from bench.run_job import run_job, tidied_here

    with tidied_here():
        while True:
            try:
                job: Job = pipe.recv()
            except (EOFError, OSError):
                return
            for row in run_job(job):
                pipe.send(row.line)
            pipe.send(None)


def _follow_parent() -> None:
    """Ends this process at once when its parent is gone, however that came: nobody would hear the rows."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)
