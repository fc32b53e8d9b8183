"""The trials of a benchmark on disk: one line a row, on the disk before the next one, whole or absent after any kill.

Only the parent process writes, with fsync after each call. A line that a kill cut off is taken away when the journal
is opened again, and that trial is run once more.
"""

from __future__ import annotations

import fcntl
import json
import logging
import os
import tempfile
from pathlib import Path
from types import TracebackType
from typing import IO, Any

from pydantic import ValidationError

from bench.job import RowKey, Settings
from bench.row import Row, RowLine
from kb.errors import BadInputError, EnvironmentFaultError

log = logging.getLogger(__name__)

TRIALS = "trials.jsonl"
RUN = "run.json"
"""What all rows of the folder have in common, and the sessions that wrote them."""


class Journal:
    """The open journal of one output folder; one process has it at a time."""

    def __init__(self, folder: Path, settings: Settings, *, resume: bool = False) -> None:
        """Opens or begins the journal.

        Args:
            folder: Output folder; made if it is not there.
            settings: What the rows to come have in common.
            resume: Go on with the rows that are there.

        Raises:
            BadInputError: the folder holds another run's trials, or is in use.
            EnvironmentFaultError: the folder cannot be written.
        """
        self.folder = folder
        self.done: set[RowKey] = set()
        """Keys of the rows on disk."""
        self.repaired: list[str] = []
        """What had to be mended, one sentence each."""
        self._file: IO[bytes] | None = None
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self._lock = _locked(folder)
        except OSError as error:
            raise EnvironmentFaultError(
                f"cannot write to {folder}: {error.strerror}", mend="choose another folder with --out"
            ) from error
        try:
            self._open(settings, resume)
        except BaseException:
            self.close()
            raise

    def _open(self, settings: Settings, resume: bool) -> None:
        path = self.folder / TRIALS
        if path.exists() and path.stat().st_size > 0:
            if not resume:
                raise BadInputError(
                    f"the folder {self.folder} holds the trials of another run; add --resume to go on with it, or "
                    "choose another folder",
                    where="--out",
                )
            self._check_settings(settings)
            self._read(path)
        self._earlier: list[dict[str, Any]] = self._known_run().get("sessions", []) if resume else []
        self.sessions = self._earlier
        """What each sitting did."""
        self._settings = settings
        self._write_run()
        self._file = path.open("ab")
        _sync_folder(self.folder)

    def _known_run(self) -> dict[str, Any]:
        path = self.folder / RUN
        if not path.exists():
            return {}
        try:
            return json.loads(path.read_text(encoding="utf-8"))
        except ValueError as error:
            raise BadInputError(f"it is not JSON: {error}", where=str(path)) from error

    def _check_settings(self, settings: Settings) -> None:
        """Rows of different settings can't stand in one table."""
        known, wanted = self._known_run().get("settings", {}), settings.model_dump()
        if known:  # of a folder that is older than a setting: it was run with the default
            known = {**type(settings)().model_dump(), **known}
        for name, value in wanted.items():
            if name in known and known[name] != value:
                raise BadInputError(
                    f"the trials in {self.folder} were run with {name} {known[name]}, not {value}; choose another folder",
                    where="--resume",
                )

    def _read(self, path: Path) -> None:
        """Takes in the rows on disk; broken and doubled lines are taken away with a warning."""
        kept: list[bytes] = []
        content = path.read_bytes()
        lines = content.split(b"\n")
        for number, line in enumerate(lines, 1):
            if not line:
                continue
            whole = number < len(lines)
            key = _key_of(line) if whole else None
            if key is None:
                what = "was cut off" if number >= len(lines) - 1 else "is broken"
                self.repaired.append(f"line {number} of {path} {what} and is taken away; its trial is run again")
            elif key in self.done:
                self.repaired.append(f"line {number} of {path} repeats {key} and is taken away")
            else:
                self.done.add(key)
                kept.append(line + b"\n")
        for sentence in self.repaired:  # whoever opened the journal tells them to the person
            log.info("%s", sentence)
        if b"".join(kept) != content:
            write_atomically(path, b"".join(kept))

    def append(self, *rows: RowLine) -> None:
        """Writes rows; when this returns, no kill can take them away.

        Raises:
            ValueError: a row is there already.
        """
        keys = [row.key for row in rows]
        for number, key in enumerate(keys):
            if key in self.done or key in keys[:number]:
                raise ValueError(f"the row {key} is written already")
        if not rows:
            return
        assert self._file is not None
        self._file.write(b"".join(row.text + b"\n" for row in rows))
        self._file.flush()
        os.fsync(self._file.fileno())
        self.done.update(keys)

    def note_session(self, session: dict[str, Any]) -> None:
        """Writes to run.json what this sitting has done so far (wall time, workers, command); replaces what it said before."""
        self.sessions = [*self._earlier, session]
        self._write_run()

    def _write_run(self) -> None:
        content = {"schema_version": 1, "settings": self._settings.model_dump(), "sessions": self.sessions}
        write_atomically(self.folder / RUN, json.dumps(content, indent=1).encode() + b"\n")

    def close(self) -> None:
        """Gives the folder free."""
        if self._file is not None:
            self._file.close()
            self._file = None
        self._lock.close()

    def __enter__(self) -> Journal:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def _key_of(line: bytes) -> RowKey | None:
    """Key of a line; None if it is no row."""
    try:
        return Row.model_validate_json(line).key
    except ValidationError:
        return None


def _locked(folder: Path) -> IO[bytes]:
    """The folder's lock; the kernel gives it free when the process ends, however it ends.

    Raises:
        BadInputError: another process has it.
    """
    lock = (folder / ".lock").open("ab")
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        lock.close()
        raise BadInputError(f"another benchmark is writing to {folder}", where="--out") from None
    return lock


def _sync_folder(folder: Path) -> None:
    """Makes sure that the folder's entries are on disk."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def write_atomically(path: Path, content: bytes) -> None:
    """Replaces a file by a finished one: after a kill it has the old content or the new one."""
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=".tmp")
    try:
        with os.fdopen(handle, "wb") as stream:
            os.fchmod(stream.fileno(), 0o644)
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
        Path(temporary).replace(path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise
    _sync_folder(path.parent)
