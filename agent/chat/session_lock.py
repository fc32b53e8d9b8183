"""One process at a time holds a thread: the second is told who does."""

from __future__ import annotations

import fcntl
import os
from pathlib import Path
from typing import IO

from kb.errors import EnvironmentFaultError

_HELD: dict[str, tuple[IO[str], int]] = {}
"""Lock file -> (open file, how many users in this process)."""


class SessionLock:
    """A lock on a session's folder; the system drops it when the process ends, however it ends."""

    def __init__(self, folder: Path) -> None:
        """Takes the lock; several users in one process share it.

        Raises:
            EnvironmentFaultError: another process holds it, or the folder cannot be written.
        """
        self._path = str((folder / "lock").absolute())
        self._open = True
        if self._path in _HELD:
            file, users = _HELD[self._path]
            _HELD[self._path] = (file, users + 1)
            return
        try:
            folder.mkdir(parents=True, exist_ok=True)
            file = open(self._path, "a+", encoding="ascii")
        except OSError as error:
            raise EnvironmentFaultError(
                f"cannot keep the session in {folder}: {error.strerror}",
                mend="set RAGVLM_HOME to a folder that can be written",
            ) from error
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            file.seek(0)
            holder = file.read(20).strip() or "unknown"
            file.close()
            raise EnvironmentFaultError(
                f"session {folder.name!r} is open in another process (pid {holder})",
                mend="close it there, or take another --thread",
            ) from error
        _write_pid(file)
        _HELD[self._path] = (file, 1)

    def release(self) -> None:
        """Gives the lock back; further calls do nothing."""
        if not self._open:
            return
        self._open = False
        file, users = _HELD.pop(self._path)
        if users > 1:
            _HELD[self._path] = (file, users - 1)
        else:
            file.close()


def _write_pid(file: IO[str]) -> None:
    """Says who holds the lock; on a full disk the lock holds all the same."""
    try:
        file.truncate(0)
        file.write(f"{os.getpid()}\n")
        file.flush()
    except OSError:
        return
