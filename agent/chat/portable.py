"""A whole session as one bounded file: checkpoints (conversation, memory, world, pictures' hashes) and its folder."""

from __future__ import annotations

import json
import re
import sqlite3
import zipfile
from pathlib import Path
from typing import Any

from agent.chat.session_lock import SessionLock
from agent.chat.sessions import folder_of, list_sessions, threads_file
from agent.checkpoint import PARTS, sqlite_saver
from kb.errors import BadInputError, EnvironmentFaultError

FORMAT, FORMER = "ragvlm-session-2", ("ragvlm-session-1",)
"""What is written, and what is read as well: a file in which every checkpoint holds all its values itself."""
MAX_BYTES = 300_000_000
"""A session larger than this, packed or unpacked, is neither written nor read."""
MAX_FILES = 2_000
COLUMNS = {
    "checkpoints": ("checkpoint_ns", "checkpoint_id", "parent_checkpoint_id", "type", "checkpoint", "metadata"),
    "writes": ("checkpoint_ns", "checkpoint_id", "task_id", "idx", "channel", "type", "value"),
    PARTS: ("name", "type", "value"),
}
"""Tables of the checkpointer and their columns besides the thread's name."""
TYPES = ("msgpack", "json", "null", "bytes", "empty", None)
"""How values may be serialised; nothing that could run code when it is read."""
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}")


def export_session(thread: str, file: Path, threads: str | Path | None = None) -> int:
    """Writes a session to a file, all of it or nothing; returns the file's size [bytes].

    Raises:
        BadInputError: no such session, or one that is too large.
        EnvironmentFaultError: the file cannot be written.
    """
    known = [info.thread for info in list_sessions(threads)]
    if thread not in known:
        raise BadInputError(f"there is no session {thread!r}", where="export", choices=known)
    part = file.with_name(file.name + ".part")
    try:
        with zipfile.ZipFile(part, "w", zipfile.ZIP_DEFLATED, compresslevel=3) as packed:
            packed.writestr("session.json", json.dumps({"format": FORMAT, "thread": thread}))
            packed.writestr("checkpoints.sqlite", _rows_of(thread, threads_file(threads)))
            for extra in sorted(folder_of(thread, threads).glob("*")):
                if extra.is_file() and extra.name != "lock":
                    packed.write(extra, f"files/{extra.name}")
        size = part.stat().st_size
        with zipfile.ZipFile(part) as packed:
            _refuse_huge(packed, part)
        part.replace(file)
    except (OSError, sqlite3.Error) as error:
        raise EnvironmentFaultError(f"cannot write {file}: {error}", mend="name a file that can be written") from error
    finally:
        part.unlink(missing_ok=True)
    return size


def import_session(
    file: Path, thread: str | None = None, threads: str | Path | None = None, *, free_name: bool = False
) -> str:
    """Reads a session from a file, under its own name or another; returns the name.

    Args:
        file: What `export_session` wrote.
        thread: Another name.
        threads: File that keeps threads.
        free_name: Where the name is taken, take the next free one like it.

    Raises:
        BadInputError: not such a file, a damaged one, or a name that is taken.
        EnvironmentFaultError: it cannot be kept here.
    """
    try:
        with zipfile.ZipFile(file) as packed:
            _refuse_huge(packed, file)
            card = json.loads(packed.read("session.json"))
            name = thread or str(card.get("thread", ""))
            if card.get("format") not in (FORMAT, *FORMER) or NAME.fullmatch(name) is None:
                raise BadInputError("this is not a session of this version", where=str(file), choices=(FORMAT,))
            rows = _read_rows(packed.read("checkpoints.sqlite"), file)
            extras = {item: packed.read(item) for item in packed.namelist() if item.startswith("files/")}
    except FileNotFoundError:
        raise BadInputError(f"the file {file} does not exist", where="import") from None
    except (zipfile.BadZipFile, KeyError, ValueError, OSError, AttributeError) as error:
        raise BadInputError(f"this is not an exported session ({error})", where=str(file)) from error
    taken = [info.thread for info in list_sessions(threads)]
    if free_name:
        name = next(free for free in (name, *(f"{name[:58]}-{n}" for n in range(2, 10_000))) if free not in taken)
    if name in taken:
        raise BadInputError(f"there is a session {name!r} already; delete it or give another name", where="import")
    _write(name, rows, extras, threads)
    return name


def _refuse_huge(packed: zipfile.ZipFile, file: Path) -> None:
    total = sum(item.file_size for item in packed.infolist())
    if total > MAX_BYTES or len(packed.infolist()) > MAX_FILES:
        many = f"{total // 1_000_000} MB in {len(packed.infolist())} files"
        limits = f"{MAX_BYTES // 1_000_000} MB in {MAX_FILES} files"
        raise BadInputError(f"a session of {many} is too large, at most {limits}", where=file.name)


def _rows_of(thread: str, path: Path) -> bytes:
    """The thread's rows as a database of their own."""
    source = sqlite3.connect(f"file:{path}?mode=ro", uri=True, timeout=30.0)
    target = sqlite3.connect(":memory:")
    try:
        source.execute("BEGIN")  # one moment of all tables, also while the session is in use
        for table, columns in COLUMNS.items():
            names, marks = ", ".join(columns), ", ".join("?" for _ in columns)
            target.execute(f"CREATE TABLE {table} ({names})")
            if _has(source, table):
                rows = source.execute(f"SELECT {names} FROM {table} WHERE thread_id = ?", (thread,))
                target.executemany(f"INSERT INTO {table} VALUES ({marks})", rows)
        target.commit()
        return bytes(target.serialize())
    finally:
        source.close()
        target.close()


def _has(database: sqlite3.Connection, table: str) -> bool:
    """Whether the table is there: a file of an earlier version has no values kept apart."""
    return bool(database.execute("SELECT 1 FROM sqlite_master WHERE type = 'table' AND name = ?", (table,)).fetchall())


def _read_rows(blob: bytes, file: Path) -> dict[str, list[tuple[Any, ...]]]:
    """The rows of each table, checked."""
    database = sqlite3.connect(":memory:")
    try:
        database.deserialize(blob)
        database.execute("PRAGMA trusted_schema = OFF")
        found: dict[str, list[tuple[Any, ...]]] = {}
        for table, columns in COLUMNS.items():
            former = table == PARTS and not _has(database, table)
            rows = [] if former else database.execute(f"SELECT {', '.join(columns)} FROM {table}").fetchall()
            kind = columns.index("type")
            if any(row[kind] not in TYPES for row in rows):
                raise BadInputError("it holds values of a kind that is not read", where=str(file))
            found[table] = rows
        return found
    except sqlite3.Error as error:
        raise BadInputError(f"its checkpoints are damaged ({error})", where=str(file)) from error
    finally:
        database.close()


def _write(
    name: str, rows: dict[str, list[tuple[Any, ...]]], extras: dict[str, bytes], threads: str | Path | None
) -> None:
    folder = folder_of(name, threads)
    lock = SessionLock(folder)
    try:
        saver = sqlite_saver(threads_file(threads))
        with saver.conn:
            for table, columns in COLUMNS.items():
                marks = ", ".join("?" for _ in range(len(columns) + 1))
                names = ", ".join(("thread_id", *columns))
                saver.conn.executemany(
                    f"INSERT INTO {table} ({names}) VALUES ({marks})", [(name, *r) for r in rows[table]]
                )
        saver.conn.close()
        for item, content in extras.items():
            plain = item.removeprefix("files/")
            if NAME.fullmatch(plain) is not None and plain != "lock":
                (folder / plain).write_bytes(content)
    except (OSError, sqlite3.Error) as error:
        raise EnvironmentFaultError(
            f"cannot keep the session: {error}", mend="make room, or set RAGVLM_HOME"
        ) from error
    finally:
        lock.release()
