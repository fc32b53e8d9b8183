"""The sessions on disk: listed, deleted, and their folders. What was said and done is in the checkpoints of the thread."""

from __future__ import annotations

import json
import shutil
import sqlite3
from pathlib import Path
from typing import Any

from agent.chat.session_lock import SessionLock
from agent.checkpoint import default_threads, sqlite_saver
from kb.base import Noun
from kb.errors import BadInputError, EnvironmentFaultError

ASKS = "asks"
"""An empty file in the folder of a session whose person is asked before every motion."""


class SessionInfo(Noun):
    """One session, as listed."""

    thread: str
    scene: str = ""
    seed: int = 0
    turns: int = 0
    steps: int = 0
    """Checkpoints kept."""
    last: str = ""
    """What was said last."""
    updated: str = ""
    """ISO time of the last checkpoint."""


def threads_file(threads: str | Path | None) -> Path:
    """The file that keeps threads."""
    return Path(threads) if threads else default_threads()


def folder_of(thread: str, threads: str | Path | None = None) -> Path:
    """Folder of a session: lock, spans, pictures."""
    return threads_file(threads).parent / "sessions" / thread


def list_sessions(threads: str | Path | None = None) -> tuple[SessionInfo, ...]:
    """All sessions, the latest first."""
    path = threads_file(threads)
    if not path.is_file():
        return ()
    rows = _read(path, "SELECT thread_id, COUNT(*), MAX(checkpoint_id) FROM checkpoints GROUP BY thread_id")
    found = [_info(str(name), int(count), folder_of(str(name), threads)) for name, count, _ in rows]
    order = {str(name): str(last) for name, _, last in rows}
    return tuple(sorted(found, key=lambda info: order[info.thread], reverse=True))


def delete_session(thread: str, threads: str | Path | None = None) -> None:
    """Forgets a session with everything that was recorded of it.

    Raises:
        BadInputError: there is no such session.
        EnvironmentFaultError: another process holds it.
    """
    path = threads_file(threads)
    known = [info.thread for info in list_sessions(threads)]
    folder = folder_of(thread, threads)
    if thread not in known:
        raise BadInputError(f"there is no session {thread!r}", where="sessions", choices=known)
    lock = SessionLock(folder)
    try:
        saver = sqlite_saver(path)
        try:
            saver.delete_thread(thread)
        finally:
            saver.conn.close()
        shutil.rmtree(folder, ignore_errors=True)
    except sqlite3.Error as error:
        raise _fault(path, error) from error
    finally:
        lock.release()


def write_card(folder: Path, card: dict[str, Any]) -> None:
    """Notes scene, seed, options and what was said last, for the list; what matters is in the checkpoints."""
    text = json.dumps(card, indent=1, sort_keys=True)
    part = folder / "session.json.part"
    part.write_text(text, encoding="utf-8")
    part.replace(folder / "session.json")


def read_card(folder: Path) -> dict[str, Any]:
    """What `write_card` noted; empty if there is nothing that can be read."""
    try:
        card = json.loads((folder / "session.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return card if isinstance(card, dict) else {}


def keep_asks(folder: Path, asks: bool) -> None:
    """Keeps with the session that its person wants to be asked before every motion; `kept_asks` tells it.

    On a full disk it holds for this process only; the checkpoints, which matter, say so themselves.
    """
    path = folder / ASKS
    try:
        if asks:
            folder.mkdir(parents=True, exist_ok=True)
            path.touch()
        else:
            path.unlink(missing_ok=True)
    except OSError:
        return


def kept_asks(folder: Path) -> bool:
    """Whether the person wanted to be asked when the session was left."""
    return (folder / ASKS).is_file()


def _info(name: str, steps: int, folder: Path) -> SessionInfo:
    card = read_card(folder)
    known = {key: card[key] for key in ("scene", "seed", "turns", "last", "updated") if key in card}
    return SessionInfo(thread=name, steps=steps, **known)


def _read(path: Path, query: str) -> list[Any]:
    try:
        connection = sqlite3.connect(f"file:{path}?mode=ro", uri=True, timeout=30.0)
        try:
            return connection.execute(query).fetchall()
        finally:
            connection.close()
    except sqlite3.Error as error:
        raise _fault(path, error) from error


def _fault(path: Path, error: Exception) -> EnvironmentFaultError:
    return EnvironmentFaultError(f"cannot use the threads in {path}: {error}", mend="give a file that can be written")
