"""The runner: the same rows from every engine, and after any kill; harness errors apart; sharing changes nothing."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from agent import build_agent
from bench.cells import summarise
from bench.engines.inline import run_inline
from bench.engines.processes import run_in_processes
from bench.job import BenchPlan, Job, Settings, jobs
from bench.row import RowLine
from bench.run_job import run_job
from bench.runner import run_benchmark
from bench.suite import instruction_of, tasks_of
from bench.trial import read_trials
from tests.bench.killed_benchmark import PLAN
from tests.bench_fixtures import ANALYTIC, TIMES, job, lasting, read

SCRIPT = Path(__file__).parent / "killed_benchmark.py"
ROOT = Path(__file__).parents[2]


def in_a_process(folder: Path, workers: int, victim: str = "nobody", after: int = 0, delay: float = 0.0) -> int:
    """Exit code of the small benchmark in a process of its own."""
    done = subprocess.run(
        [sys.executable, str(SCRIPT), str(folder), str(workers), victim, str(after), str(delay)],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode in (0, -signal.SIGKILL), done.stderr[-2000:]
    return done.returncode


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the small benchmark that nobody disturbs, run in this process."""
    folder = tmp_path_factory.mktemp("calm")
    run_benchmark(PLAN, folder)
    return folder


def kills(count: int) -> list[tuple[str, int, float]]:
    """Victim, row and delay of kills drawn at random; a worker, a bench with workers and one without come in turn."""
    rng = np.random.default_rng(7)
    victims = ("worker", "parent", "parent_inline")
    return [(victims[i % 3], int(rng.integers(1, 11)), float(rng.uniform(0.0, 0.3))) for i in range(count)]


def check_kill(undisturbed: Path, folder: Path, victim: str, after: int, delay: float) -> None:
    """Runs with a kill, then resumes until all is there; the rows and the table must be the undisturbed ones."""
    workers = 1 if victim == "parent_inline" else 2
    code = in_a_process(folder, workers, victim.removesuffix("_inline"), after, delay)
    if victim == "worker":
        assert code == 0, "a worker's death must not end the benchmark"
    elif code != 0:
        assert len(read_whole(folder)) >= after
    if code != 0:
        assert in_a_process(folder, 1) == 0
    assert read(folder) == read(undisturbed)
    wanted, got = (summarise(read_trials(where / "trials.jsonl"), wall_s=0.0) for where in (undisturbed, folder))
    assert got.cells == wanted.cells


def read_whole(folder: Path) -> list[str]:
    """Lines that are complete."""
    return [line for line in (folder / "trials.jsonl").read_text().splitlines(keepends=True) if line.endswith("\n")]


@pytest.mark.parametrize(("victim", "after", "delay"), kills(3))
def test_kill_loses_and_doubles_nothing(
    undisturbed: Path, tmp_path: Path, victim: str, after: int, delay: float
) -> None:
    """After kill -9 of a worker or of the bench, the resumed folder holds the rows of an undisturbed run, each once."""
    check_kill(undisturbed, tmp_path, victim, after, delay)


@pytest.mark.long
@pytest.mark.parametrize(("victim", "after", "delay"), kills(10)[3:])
def test_kill_loses_and_doubles_nothing_ever(
    undisturbed: Path, tmp_path: Path, victim: str, after: int, delay: float
) -> None:
    """The same for the rest of ten kills."""
    check_kill(undisturbed, tmp_path, victim, after, delay)


def test_a_trial_that_kills_its_workers_is_a_harness_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """A trial in which the worker dies three times becomes a harness error; the other trials run."""
    # The child reads the scene's file by name; a scene with this task name does not exist, and the hook below dies in it.
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    monkeypatch.setattr("bench.engines.processes._work", _dies_in_trial_1)
    rows = {line.row.trial: line for line in run_in_processes([job(0), job(1), job(2)], 2)}
    assert {trial: row.harness_error is None for trial, row in rows.items()} == {0: True, 1: False, 2: True}
    assert "died 3 times" in str(rows[1].harness_error)


def _dies_in_trial_1(pipe: Any) -> None:
    """A worker that lives as the real one, but dies at the sight of trial 1."""
    import bench.run_job
    from bench.engines.processes import _work

    real = bench.run_job.run_job

    def deadly(work: Job) -> Any:
        if work.trial == 1:
            os.kill(os.getpid(), signal.SIGKILL)
        return real(work)

    bench.run_job.run_job = deadly
    _work(pipe)


def test_what_raises_is_a_harness_error_not_a_failed_grasp(monkeypatch: pytest.MonkeyPatch) -> None:
    """An exception in one configuration is recorded in its row, and the next configuration still runs."""
    from agent import run_result

    real, calls = run_result.run_result, []

    def breaks_once(*args: Any, **kwargs: Any) -> Any:
        calls.append(1)
        if len(calls) == 1:
            raise RuntimeError("the observer\nhas lost its glasses")
        return real(*args, **kwargs)

    monkeypatch.setattr(run_result, "run_result", breaks_once)
    first, second = run_job(job(0, "single_cube", ANALYTIC, "full", "heuristic"))
    assert first.harness_error == "RuntimeError: the observer has lost its glasses"
    assert (first.success, second.harness_error) == (False, None)


def test_sharing_looks_changes_nothing() -> None:
    """A configuration's row is the same alone, after others in the same world, and in a run of its own."""
    names = ("vlm_only", "full", "no_recovery")
    settings = Settings(seed=10_004)
    together = {row.configuration: row for row in run_job(job(0, "phone_near_wine_glass", settings, *names))}
    assert together["no_recovery"].shared_steps >= 5
    (alone,) = run_job(job(0, "phone_near_wine_glass", settings, "no_recovery"))
    assert alone.shared_steps == 0
    assert lasting(alone) == lasting(together["no_recovery"])
    agent = build_agent("phone_near_wine_glass", 10_004, configuration="full")
    result = agent.run(instruction_of("phone_near_wine_glass", 10_004)).model_dump(mode="json")
    row = lasting(together["full"])
    assert {key: row[key] for key in result if key not in TIMES} == lasting(result)


def test_measuring_changes_nothing() -> None:
    """The bare-step ratio is measured without touching the outcome, and bare steps are never slower by far."""
    plain = job(0, "single_cube", Settings(seed=10_000))
    (calm,), (measured,) = run_job(plain), run_job(plain.model_copy(update={"measure": True}))
    assert lasting(calm) == lasting(measured)
    assert calm.bare_step_ratio is None
    assert measured.bare_step_ratio is not None
    assert 0.5 < measured.bare_step_ratio < 4.0


def test_jobs_hold_each_row_once() -> None:
    """Jobs cover the plan, leave out what is done, and name the seed by repetition and trial."""
    plan = BenchPlan(
        tasks=tasks_of("tasks", ["single"]),
        configurations=("full", "heuristic"),
        trials=2,
        repetitions=2,
        noises=(0.0, 2.0),
    )
    keys = [item.key(name) for item in jobs(plan) for name in item.configurations]
    assert len(keys) == len(set(keys)) == plan.rows
    done = set(keys[::3])
    left = [item.key(name) for item in jobs(plan, done) for name in item.configurations]
    assert sorted(left) == sorted(set(keys) - done)
    assert {item.seed for item in jobs(plan) if item.repetition == 1 and item.trial == 1} == {21_001}


def test_a_trial_needs_no_heavy_library() -> None:
    """What a worker does, in physics and from pixels, imports neither scipy nor matplotlib nor torch."""
    code = (
        "import sys\n"
        "from bench.run_job import run_job\n"
        "from tests.bench_fixtures import job\n"
        "rows = list(run_job(job(0, 'single_cube', Settings(seed=10_000), 'full')))\n"
        "print(rows[0].evaluator, rows[0].perception, rows[0].harness_error)\n"
        "print(*sorted({'scipy', 'matplotlib', 'torch', 'trimesh', 'chromadb'} & set(sys.modules)))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", f"from bench.job import Settings\n{code}"], cwd=ROOT, capture_output=True, text=True,
        check=True, env={**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"},
    )  # fmt: skip
    assert done.stdout.splitlines() == ["mujoco rgbd None", ""]


def test_processes_give_the_rows_of_one_process() -> None:
    """Two workers, each with its next job in hand, and this process give the same rows."""
    work = [job(trial, "single_cube", ANALYTIC, "full", "heuristic") for trial in range(8)]

    def by_key(rows: Any) -> dict[Any, Any]:
        found: list[RowLine] = list(rows)
        return {row.key: lasting(row) for row in found}

    assert by_key(run_in_processes(work, 2)) == by_key(run_inline(work))


def test_dask_survives_a_killed_worker() -> None:
    """On a cluster of two workers, one of which is killed, every trial gives its row, the same as here."""
    distributed = pytest.importorskip("distributed", reason="needs the extra cluster")
    from bench.engines.dask_cluster import run_on_dask

    work = [job(trial) for trial in range(4)]
    options: dict[str, Any] = {"n_workers": 2, "threads_per_worker": 1, "host": "127.0.0.1", "dashboard_address": None}
    with distributed.LocalCluster(**options) as cluster:
        rows: list[RowLine] = []
        for row in run_on_dask(work, cluster.scheduler_address):
            if not rows:
                os.kill(next(iter(cluster.workers.values())).pid, signal.SIGKILL)
            rows.append(row)
    assert {row.key: lasting(row) for row in rows} == {row.key: lasting(row) for row in run_inline(work)}
