"""The long-term store of episodic memory: one SQLite file, for sessions that ask to remember beyond a run (ledger G22).

Plain `sqlite3` with a write-ahead log: several processes may read and write, an interrupted write leaves nothing half
done, and what `keep` returned from is on disk.
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType

from pydantic import ValidationError

from kb.errors import BadInputError, EnvironmentFaultError
from memory.episodic import EpisodicMemory, merge_memory
from memory.item import MemoryItem

SCHEMA_VERSION = 1
BUSY_S = 5.0
"""How long a writer waits for another one [s]."""

_TABLE = """
CREATE TABLE IF NOT EXISTS items (
    session TEXT NOT NULL,
    text TEXT NOT NULL,
    PRIMARY KEY (session, text)
) WITHOUT ROWID
"""


class LongTermMemory:
    """Episodic memories by session name, kept in a file. Use as a context manager, or call `close`."""

    def __init__(self, path: str | Path) -> None:
        """Opens or creates the file.

        Raises:
            EnvironmentFaultError: if it cannot be opened or is no database.
            BadInputError: if another version of the program made it.
        """
        self._path = Path(path)
        try:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            self._connection = sqlite3.connect(self._path, timeout=BUSY_S, isolation_level=None)
        except (OSError, sqlite3.Error) as error:
            raise self._fault(error) from error
        try:
            self._prepare()
        except sqlite3.Error as error:
            self._connection.close()
            raise self._fault(error) from error
        except BadInputError:
            self._connection.close()
            raise

    def _prepare(self) -> None:
        self._connection.execute("PRAGMA journal_mode = WAL")
        self._connection.execute("PRAGMA synchronous = FULL")
        with self._transaction():
            found = int(self._connection.execute("PRAGMA user_version").fetchone()[0])
            if found not in (0, SCHEMA_VERSION):
                what = f"the memory file has version {found}"
                raise BadInputError(what, where=str(self._path), choices=[str(SCHEMA_VERSION)])
            self._connection.execute(_TABLE)
            self._connection.execute(f"PRAGMA user_version = {SCHEMA_VERSION}")

    def keep(self, session: str, memory: EpisodicMemory) -> None:
        """Merges `memory` into what the session already knows; all of it or nothing.

        Raises:
            EnvironmentFaultError: if the file cannot be written.
        """
        try:
            with self._transaction():
                merged = merge_memory(self._read(session), memory)
                self._connection.execute("DELETE FROM items WHERE session = ?", (session,))
                rows = [(session, item.model_dump_json()) for item in merged.items]
                self._connection.executemany("INSERT INTO items VALUES (?, ?)", rows)
        except sqlite3.Error as error:
            raise self._fault(error) from error

    def recall(self, session: str) -> EpisodicMemory:
        """What the session knows; empty for a new one.

        Raises:
            BadInputError: if an item in the file is damaged.
        """
        try:
            return self._read(session)
        except sqlite3.Error as error:
            raise self._fault(error) from error

    def sessions(self) -> tuple[str, ...]:
        """Names of all sessions with memories, sorted."""
        rows = self._connection.execute("SELECT DISTINCT session FROM items ORDER BY session").fetchall()
        return tuple(str(row[0]) for row in rows)

    def forget(self, session: str) -> None:
        """Drops everything the session knows."""
        with self._transaction():
            self._connection.execute("DELETE FROM items WHERE session = ?", (session,))

    def close(self) -> None:
        self._connection.close()

    def __enter__(self) -> LongTermMemory:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _read(self, session: str) -> EpisodicMemory:
        rows = self._connection.execute("SELECT text FROM items WHERE session = ?", (session,)).fetchall()
        try:
            items = tuple(MemoryItem.model_validate(json.loads(row[0])) for row in rows)
        except (ValidationError, ValueError, TypeError) as error:
            raise BadInputError(f"a memory of session {session!r} is damaged", where=str(self._path)) from error
        return merge_memory(EpisodicMemory(), EpisodicMemory(items=items))

    @contextmanager
    def _transaction(self) -> Generator[None]:
        self._connection.execute("BEGIN IMMEDIATE")
        try:
            yield
        except BaseException:
            self._connection.execute("ROLLBACK")
            raise
        self._connection.execute("COMMIT")

    def _fault(self, error: Exception) -> EnvironmentFaultError:
        mend = "give a file that can be written, or delete it to start anew"
        return EnvironmentFaultError(f"cannot use the memory file {self._path}: {error}", mend=mend)
