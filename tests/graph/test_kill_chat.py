"""A killed conversation goes on where it was: words, memory, world and a pending approval are all there."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

SCRIPT = Path(__file__).parent / "killed_chat.py"
ROOT = Path(__file__).parents[2]
STEPS = 36
"""Steps that the undisturbed conversation tells, at least."""


def talk(threads: Path, kill_at: str) -> tuple[int, str]:
    """Exit code and standard output of one process."""
    done = subprocess.run(
        [sys.executable, str(SCRIPT), str(threads), kill_at],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    return done.returncode, done.stdout.strip() or done.stderr[-2000:]


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> str:
    """The end of the conversation that nobody kills."""
    code, out = talk(tmp_path_factory.mktemp("calm") / "threads.sqlite", "never")
    assert code == 0, out
    return out


def check(kill_at: str, undisturbed: str, folder: Path) -> None:
    """Kills a conversation at a point, takes it up, and compares."""
    threads = folder / "threads.sqlite"
    code, out = talk(threads, kill_at)
    assert code == -9, out
    code, out = talk(threads, "never")
    assert code == 0, out
    assert out == undisturbed


def moments(count: int, seed: int) -> list[str]:
    """Steps drawn at random."""
    return [str(n) for n in np.random.default_rng(seed).choice(STEPS, size=count, replace=False)]


@pytest.mark.slow
@pytest.mark.parametrize("kill_at", moments(3, 11))
def test_killed_conversation_goes_on_exactly(kill_at: str, undisturbed: str, tmp_path: Path) -> None:
    """After kill -9 the conversation ends with the very words, memory, grasps and world of the undisturbed one."""
    check(kill_at, undisturbed, tmp_path)


@pytest.mark.long
@pytest.mark.parametrize("kill_at", moments(20, 12))
def test_killed_at_twenty_moments(kill_at: str, undisturbed: str, tmp_path: Path) -> None:
    """The same at twenty random steps."""
    check(kill_at, undisturbed, tmp_path)
