"""The long-term store of memories."""

from __future__ import annotations

import os
import signal
import sqlite3
import subprocess
import sys
from pathlib import Path

import pytest

from kb.errors import BadInputError, EnvironmentFaultError
from kb.priors import prior
from memory import EpisodicMemory, MemoryItem, remember
from memory.long_term import LongTermMemory


def memory_of(*forces: float) -> EpisodicMemory:
    memory = EpisodicMemory()
    for force in forces:
        item = MemoryItem(
            category="cup",
            affordance=prior("cup").affordance,
            region="handle",
            type="pinch",
            tilt=0.1,
            force=force,
            depth=0.5,
            aperture=0.08,
            mass=0.3,
        )
        memory = remember(memory, item)
    return memory


def test_what_was_kept_is_recalled_after_reopening(tmp_path: Path) -> None:
    """A session's memory survives the process; another session's is separate."""
    with LongTermMemory(tmp_path / "deep" / "memory.sqlite") as store:
        store.keep("kitchen", memory_of(10.0, 12.5))
        store.keep("lab", memory_of(7.0))
    with LongTermMemory(tmp_path / "deep" / "memory.sqlite") as store:
        assert store.recall("kitchen") == memory_of(10.0, 12.5)
        assert store.recall("lab") == memory_of(7.0)
        assert store.recall("nowhere") == EpisodicMemory()
        assert store.sessions() == ("kitchen", "lab")


def test_keeping_merges_and_is_idempotent(tmp_path: Path) -> None:
    """Keeping parts in any order, or twice, gives their union."""
    whole = memory_of(10.0, 12.5, 9.0)
    parts = [EpisodicMemory(items=whole.items[i : i + 1]) for i in (2, 0, 1, 0)]
    with LongTermMemory(tmp_path / "m.sqlite") as store:
        for part in parts:
            store.keep("s", part)
        assert store.recall("s") == whole


def test_forgetting_leaves_other_sessions_alone(tmp_path: Path) -> None:
    """Only the named session is dropped."""
    with LongTermMemory(tmp_path / "m.sqlite") as store:
        store.keep("a", memory_of(1.5))
        store.keep("b", memory_of(2.5))
        store.forget("a")
        assert store.sessions() == ("b",)


def test_two_writers_lose_nothing(tmp_path: Path) -> None:
    """Two open stores that write in turn see each other's items."""
    whole = memory_of(10.0, 12.5)
    one, two = LongTermMemory(tmp_path / "m.sqlite"), LongTermMemory(tmp_path / "m.sqlite")
    with one, two:
        one.keep("s", EpisodicMemory(items=whole.items[:1]))
        two.keep("s", EpisodicMemory(items=whole.items[1:]))
        assert one.recall("s") == two.recall("s") == whole


def test_an_acknowledged_write_survives_a_kill(tmp_path: Path) -> None:
    """The process is killed right after `keep` returned: the memory is on disk."""
    path = tmp_path / "m.sqlite"
    code = (
        "import os, sys; from memory.long_term import LongTermMemory; from memory import EpisodicMemory; "
        "s = LongTermMemory(sys.argv[1]); s.keep('s', EpisodicMemory.model_validate_json(sys.argv[2])); "
        "os.kill(os.getpid(), 9)"
    )
    whole = memory_of(10.0, 12.5)
    done = subprocess.run([sys.executable, "-c", code, str(path), whole.model_dump_json()], check=False)
    assert done.returncode == -signal.SIGKILL
    with LongTermMemory(path) as store:
        assert store.recall("s") == whole


def test_unusable_files_are_refused_in_one_line(tmp_path: Path) -> None:
    """A file that is no database, a folder and a newer version each give the fitting error."""
    garbage = tmp_path / "garbage.sqlite"
    garbage.write_bytes(b"this is no database, and long enough to be read as one" * 40)
    for path in (garbage, tmp_path):
        with pytest.raises(EnvironmentFaultError, match="cannot use the memory file"):
            LongTermMemory(path)
    newer = tmp_path / "newer.sqlite"
    connection = sqlite3.connect(newer)
    connection.execute("PRAGMA user_version = 7")
    connection.close()
    with pytest.raises(BadInputError, match="version 7"):
        LongTermMemory(newer)


def test_a_damaged_item_is_named(tmp_path: Path) -> None:
    """An item that is no memory is reported with its session, not returned as something else."""
    path = tmp_path / "m.sqlite"
    with LongTermMemory(path) as store:
        store.keep("s", memory_of(10.0))
    connection = sqlite3.connect(path)
    connection.execute("UPDATE items SET text = '{\"category\": 3}'")
    connection.commit()
    connection.close()
    with LongTermMemory(path) as store, pytest.raises(BadInputError, match="session 's' is damaged"):
        store.recall("s")


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_read_only_folder_says_the_mend(tmp_path: Path) -> None:
    """The message tells the user to give a writable file."""
    tmp_path.chmod(0o500)
    try:
        with pytest.raises(EnvironmentFaultError, match="can be written"):
            LongTermMemory(tmp_path / "m.sqlite")
    finally:
        tmp_path.chmod(0o700)
