"""Where conversations are kept: SQLite for threads, memory without; and which of our types a checkpoint may hold."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from kb.errors import EnvironmentFaultError

TYPES: tuple[tuple[str, str], ...] = (
    ("agent.attempt", "Attempt"),
    ("agent.attempt", "Held"),
    ("agent.attempt", "Moved"),
    ("agent.chat.call", "Call"),
    ("agent.goal", "Goal"),
    ("kb.constraint", "Constraints"),
    ("kb.experience", "Retrieval"),
    ("kb.percept", "PerceivedObject"),
    ("kb.percept", "Percept"),
    ("kb.run_result", "ModelUse"),
    ("kb.scene_graph", "SceneGraph"),
    ("kb.sensing", "CameraEvidence"),
    ("kb.sensing", "Correction"),
    ("kb.sensing", "Plan"),
    ("kb.sensing", "Sensing"),
    ("memory.episodic", "EpisodicMemory"),
    ("tools.classify_failure", "Diagnosis"),
    ("tools.planning.demand", "Demand"),
)
"""The types that stand in the state; everything inside them is plain data that pydantic validates again."""

PARTS = "parts"
"""The table of a thread's large values (`agent.thread_saver`), and where a checkpoint's metadata names them."""


def serializer() -> Any:
    """The serializer of checkpoints: LangGraph's, allowed to bring back our types and no others."""
    from langgraph.checkpoint.serde.jsonplus import JsonPlusSerializer

    return JsonPlusSerializer(allowed_msgpack_modules=[*TYPES])


def default_threads() -> Path:
    """The file that keeps threads: `$RAGVLM_HOME` or the user's data folder."""
    home = os.environ.get("RAGVLM_HOME")
    if home:
        return Path(home) / "threads.sqlite"
    base = os.environ.get("XDG_DATA_HOME") or str(Path.home() / ".local" / "share")
    return Path(base) / "ragvlm" / "threads.sqlite"


def memory_saver() -> Any:
    """A checkpointer that forgets with the process."""
    from langgraph.checkpoint.memory import InMemorySaver

    return InMemorySaver(serde=serializer())


def sqlite_saver(path: Path) -> Any:
    """A checkpointer on disk; every step is written before the next one begins.

    A killed process loses no step. A power cut loses none of a turn that was answered (`settle`), at most the last few of the
    turn in work, and never the file: the journal (WAL) is flushed to the platter once a turn, not at each of its 35 writes,
    which would take 130 ms to 500 ms a turn.

    Raises:
        EnvironmentFaultError: the folder cannot be written, or the file is no database.
    """
    import sqlite3

    from agent.thread_saver import ThreadSaver

    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        connection = sqlite3.connect(str(path), check_same_thread=False, timeout=30.0)
        saver = ThreadSaver(connection, serde=serializer())
        saver.setup()
        connection.execute("PRAGMA synchronous = NORMAL")
    except (OSError, sqlite3.Error) as error:
        raise EnvironmentFaultError(
            f"cannot keep threads in {path}: {error}", mend="set RAGVLM_HOME to a folder that can be written"
        ) from error
    return saver


def settle(saver: Any) -> None:
    """Flushes what was saved to the platter, so that a power cut does not take it (about 10 ms).

    A commit with `synchronous = FULL` flushes the whole journal, with all that was committed before it.
    """
    with saver.lock:
        saver.conn.execute("PRAGMA synchronous = FULL")
        try:
            saver.conn.execute("PRAGMA user_version = 1")  # the smallest thing that is a commit
        finally:
            saver.conn.execute("PRAGMA synchronous = NORMAL")


ENDS = 20
"""Branches of a forked conversation whose last checkpoint stays however old it is."""
KEPT = 100
"""Checkpoints kept per thread: the last few instructions, step by step; a conversation must not grow without bound."""


def prune(saver: Any, thread: str, keep: int = KEPT) -> None:
    """Forgets all but the last `keep` checkpoints of a thread and the ends of its last `ENDS` branches."""
    with saver.lock:
        old = """thread_id = :thread AND checkpoint_id NOT IN
                 (SELECT checkpoint_id FROM checkpoints WHERE thread_id = :thread ORDER BY checkpoint_id DESC LIMIT :keep)
                 AND checkpoint_id NOT IN
                 (SELECT checkpoint_id FROM checkpoints WHERE thread_id = :thread AND checkpoint_id NOT IN
                  (SELECT parent_checkpoint_id FROM checkpoints WHERE thread_id = :thread
                   AND parent_checkpoint_id IS NOT NULL) ORDER BY checkpoint_id DESC LIMIT :ends)"""
        for table in ("writes", "checkpoints"):
            saver.conn.execute(f"DELETE FROM {table} WHERE {old}", {"thread": thread, "keep": keep, "ends": ENDS})
        saver.prune_parts(thread)
        saver.conn.commit()
