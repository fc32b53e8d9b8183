"""A killed run goes on where it was: same grasps, same verdicts, same answer, with the physical world restored."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

SCRIPT = Path(__file__).parent / "killed_run.py"
ROOT = Path(__file__).parents[2]
INSTRUCTION = "put the apple in the bin"
STEPS = 14
"""Steps that the undisturbed run tells, at least."""


def run(threads: Path, kill_at: str) -> tuple[int, str]:
    """Exit code and standard output of one process."""
    done = subprocess.run(
        [sys.executable, str(SCRIPT), str(threads), INSTRUCTION, kill_at],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    return done.returncode, done.stdout.strip() or done.stderr[-2000:]


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> str:
    """The result of the run that nobody kills."""
    code, out = run(tmp_path_factory.mktemp("calm") / "threads.sqlite", "never")
    assert code == 0, out
    return out


def kill_points(count: int) -> list[str]:
    """Between a motion and its checkpoint, at the last step (nothing moves after it), and at steps drawn at random."""
    rng = np.random.default_rng(7)
    return ["moved", str(STEPS - 1), *(str(n) for n in rng.choice(STEPS - 1, size=count - 2, replace=False))]


def check(kill_at: str, undisturbed: str, folder: Path) -> None:
    """Kills a run at a point, takes it up, and compares."""
    threads = folder / "threads.sqlite"
    code, out = run(threads, kill_at)
    assert code == -9, out
    code, out = run(threads, "never")
    assert code == 0, out
    assert out == undisturbed


@pytest.mark.slow
@pytest.mark.parametrize("kill_at", kill_points(4))
def test_killed_run_is_resumed_exactly(kill_at: str, undisturbed: str, tmp_path: Path) -> None:
    """After kill -9 the same thread finishes with the very result of an undisturbed run."""
    check(kill_at, undisturbed, tmp_path)


@pytest.mark.long
@pytest.mark.parametrize("kill_at", [str(n) for n in range(STEPS)])
def test_killed_at_every_step(kill_at: str, undisturbed: str, tmp_path: Path) -> None:
    """The same at every step of the run."""
    check(kill_at, undisturbed, tmp_path)
