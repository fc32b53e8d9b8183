"""LangGraph's SQLite checkpointer, with each large value of the state stored once instead of in every checkpoint."""

from __future__ import annotations

import hashlib
import json
import sqlite3
from collections.abc import Iterator
from typing import Any

from langgraph.checkpoint.base import CheckpointTuple
from langgraph.checkpoint.sqlite import SqliteSaver

from agent.checkpoint import PARTS

LARGE = ("world", "attempts", "messages", "percept", "before", "experiences", "shown", "memory", "held", "put_down")
"""Channels whose values are kept apart: nine tenths of a checkpoint, of which a step changes hardly any."""
CACHED = 24
"""Values kept decoded: those of the last few steps, which every look at the state asks for."""


class ThreadSaver(SqliteSaver):
    """A turn has about fifteen checkpoints of 200 kB, alike but for a few bytes; writing the same again is most of its time.

    A value is named by the hash of its bytes. It is stored before the first checkpoint that names it, so a process killed
    between the two leaves a value nobody names, which `prune_parts` removes, and never a checkpoint without its values.
    Checkpoints of earlier versions, which hold everything themselves, are read as they are.
    """

    def __init__(self, connection: sqlite3.Connection, *, serde: Any) -> None:
        super().__init__(connection, serde=serde)
        self._last: dict[str, dict[str, tuple[Any, str]]] = {}
        """By thread: the large values of the checkpoint last saved, and their names."""
        self._decoded: dict[tuple[str, str], Any] = {}

    def setup(self) -> None:
        """Makes the tables where they are missing."""
        if not self.is_setup:
            super().setup()
            self.conn.execute(
                f"CREATE TABLE IF NOT EXISTS {PARTS} (thread_id TEXT NOT NULL, name TEXT NOT NULL, type TEXT, value BLOB,"
                " PRIMARY KEY (thread_id, name)) WITHOUT ROWID"
            )
            self.conn.commit()

    def put(self, config: Any, checkpoint: Any, metadata: Any, new_versions: Any) -> Any:
        """As the library's, with the large values apart."""
        thread = str(config["configurable"]["thread_id"])
        values = dict(checkpoint["channel_values"])
        saved = {channel: self._save(thread, channel, values.pop(channel)) for channel in LARGE if channel in values}
        named: Any = {**metadata, PARTS: {channel: name for channel, (_, name) in saved.items()}}
        lighter: Any = {**checkpoint, "channel_values": values}
        placed = super().put(config, lighter, named, new_versions)
        self._last[thread] = saved  # those and no others: what no checkpoint names any more may be gone
        return placed

    def _save(self, thread: str, channel: str, value: Any) -> tuple[Any, str]:
        """Stores a value unless it is the one of the checkpoint before; what stands in the state is never changed in place."""
        last = self._last.get(thread, {}).get(channel)
        if last is not None and last[0] is value:
            return last
        kind, coded = self.serde.dumps_typed(value)
        name = hashlib.blake2b(coded, digest_size=16, person=kind.encode()[:16]).hexdigest()
        if last is None or last[1] != name:
            with self.cursor() as cursor:
                cursor.execute(f"INSERT OR IGNORE INTO {PARTS} VALUES (?, ?, ?, ?)", (thread, name, kind, coded))
        return value, name

    def get_tuple(self, config: Any) -> CheckpointTuple | None:
        """As the library's."""
        found = super().get_tuple(config)
        return None if found is None else self._whole(found)

    def list(self, config: Any, **which: Any) -> Iterator[CheckpointTuple]:
        """As the library's."""
        for found in [*super().list(config, **which)]:  # all at once: it holds the lock while it goes on
            yield self._whole(found)

    def delete_thread(self, thread_id: str) -> None:
        """As the library's, with the thread's values, in one transaction."""
        self._last.pop(thread_id, None)
        with self.cursor() as cursor:
            for table in ("writes", "checkpoints", PARTS):
                cursor.execute(f"DELETE FROM {table} WHERE thread_id = ?", (thread_id,))

    def _whole(self, found: CheckpointTuple) -> CheckpointTuple:
        """The checkpoint with its large values."""
        where: Any = found.config
        thread = where["configurable"]["thread_id"]
        metadata: Any = {**found.metadata}
        names: dict[str, str] = metadata.pop(PARTS, {})
        large = {channel: self._value(thread, name) for channel, name in names.items()}
        values = {**found.checkpoint["channel_values"], **large}
        checkpoint: Any = {**found.checkpoint, "channel_values": values}
        return found._replace(checkpoint=checkpoint, metadata=metadata)

    def _value(self, thread: str, name: str) -> Any:
        """A value by its name.

        Raises:
            sqlite3.DatabaseError: the file does not hold it.
        """
        if (thread, name) not in self._decoded:
            with self.cursor(transaction=False) as cursor:
                query = f"SELECT type, value FROM {PARTS} WHERE thread_id = ? AND name = ?"
                row = cursor.execute(query, (thread, name)).fetchone()
            if row is None:
                raise sqlite3.DatabaseError(f"a value of a checkpoint of {thread!r} is missing")
            self._decoded[thread, name] = self.serde.loads_typed(row)
            while len(self._decoded) > CACHED:
                del self._decoded[next(iter(self._decoded))]
        value = self._decoded[thread, name]
        return [*value] if isinstance(value, list) else value

    def prune_parts(self, thread: str) -> None:
        """Forgets values that no checkpoint of the thread names any more. Called with the lock held, within a transaction."""
        named = self.conn.execute("SELECT metadata FROM checkpoints WHERE thread_id = ?", (thread,))
        keep = {name for (text,) in named for name in json.loads(text or b"{}").get(PARTS, {}).values()}
        stored = {name for (name,) in self.conn.execute(f"SELECT name FROM {PARTS} WHERE thread_id = ?", (thread,))}
        old = [(thread, name) for name in stored - keep]
        self.conn.executemany(f"DELETE FROM {PARTS} WHERE thread_id = ? AND name = ?", old)
