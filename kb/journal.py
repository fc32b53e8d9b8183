"""The journal of a learning knowledge base: one line a change, never rewritten, so every version can be had again.

A folder holds `base.jsonl` (the knowledge base it began with), `journal.jsonl` and a lock. One process writes at a time;
each first reads what the others have written. A line counts once it is on the disk with its line end: a torn last line is
a change that was never acknowledged, and the next writer cuts it off. A damaged line before the last is an error.
"""

from __future__ import annotations

import fcntl
import json
import os
import zlib
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal

from pydantic import Field, ValidationError

from kb.base import Noun
from kb.errors import BadInputError, EnvironmentFaultError
from kb.experience import Experience
from kb.lesson import Lesson

Kind = Literal["began", "lesson", "promoted", "refused", "added", "rolled_back"]

FORMAT = "ragvlm-journal-1"
BASE, JOURNAL, LOCK = "base.jsonl", "journal.jsonl", "lock"


class Change(Noun):
    """One line of the journal."""

    version: int
    """Counts from 0; the state after this change has this number."""
    kind: Kind
    says: str
    """One line for people."""
    lesson: Lesson | None = None
    entry: Experience | None = None
    """The entry that was promoted or added."""
    key: str = ""
    """Key of the lessons that a promotion or refusal is about."""
    to: int | None = None
    """Version that was gone back to."""
    facts: dict[str, Any] = Field(default_factory=dict)
    """What the decision rested on."""


class Journal:
    """The changes of one folder, kept up to date with the file."""

    def __init__(self, folder: Path) -> None:
        """Reads the journal.

        Raises:
            BadInputError: there is no journal.
            EnvironmentFaultError: an unreadable one, a damaged line or another format.
        """
        self.folder = folder
        self._path = folder / JOURNAL
        self.changes: list[Change] = []
        self._offset = 0
        self.refresh()

    def refresh(self) -> int:
        """Reads what was appended since; returns the length of the file up to the last whole line."""
        try:
            with self._path.open("rb") as stream:
                stream.seek(self._offset)
                data = stream.read()
        except (FileNotFoundError, NotADirectoryError) as error:
            what = f"there is no learning knowledge base in {self.folder}"
            mend = f"begin one with `ragvlm run ... --learn --kb {self.folder}`"
            raise BadInputError(f"{what} (no {JOURNAL}); {mend}") from error
        except OSError as error:
            mend = "make it readable, or give another folder: --kb DIR"
            raise EnvironmentFaultError(f"cannot read the journal {self._path}: {error.strerror}", mend=mend) from error
        whole = data[: data.rfind(b"\n") + 1]
        for line in whole.splitlines():
            self.changes.append(_parsed(line, self._path, len(self.changes)))
        self._offset += len(whole)
        return self._offset

    @contextmanager
    def writing(self) -> Generator[None]:
        """The only writer, with everything read that others wrote before.

        Raises:
            EnvironmentFaultError: the folder cannot be written.
        """
        with locked(self.folder):
            self.refresh()
            yield

    def append(self, change: Change) -> Change:
        """Writes a change with the next number and returns it when it is on the disk. Call inside `writing`.

        Raises:
            EnvironmentFaultError: the file cannot be written.
        """
        numbered = change.model_copy(update={"version": len(self.changes)})
        line = _line(numbered)
        try:
            with self._path.open("r+b") as stream:
                stream.truncate(self._offset)  # a torn line was never acknowledged
                stream.seek(self._offset)
                stream.write(line)
                stream.flush()
                os.fsync(stream.fileno())
        except OSError as error:
            raise _unwritable(self.folder, error) from error
        self._offset += len(line)
        self.changes.append(numbered)
        return numbered


def begin(folder: Path, base: str, says: str) -> Journal:
    """The journal of a folder; begins one with this knowledge base (text of the file) unless there is one already.

    Raises:
        EnvironmentFaultError: the folder cannot be made or written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise _unwritable(folder, error) from error
    if (folder / JOURNAL).exists():
        return Journal(folder)
    with locked(folder):
        if not (folder / JOURNAL).exists():
            _write(folder / BASE, base.encode())
            _write(folder / JOURNAL, _line(Change(version=0, kind="began", says=says, facts={"format": FORMAT})))
    return Journal(folder)


@contextmanager
def locked(folder: Path) -> Generator[None]:
    """Holds the folder's lock; waits for another writer. A killed writer's lock is free at once."""
    try:
        handle = os.open(folder / LOCK, os.O_RDWR | os.O_CREAT, 0o644)
    except OSError as error:
        raise _unwritable(folder, error) from error
    try:
        fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)


def _line(change: Change) -> bytes:
    """A change as a line: its checksum, a blank, JSON."""
    text = json.dumps(change.model_dump(mode="json", exclude_defaults=True), ensure_ascii=True, sort_keys=True)
    return f"{zlib.crc32(text.encode()):08x} {text}\n".encode()


def _parsed(line: bytes, path: Path, number: int) -> Change:
    where = f"{path}:{number + 1}"
    mend = "take the good copy from a backup, or move the folder away and begin anew"
    try:
        sum_, _, text = line.partition(b" ")
        if int(sum_, 16) != zlib.crc32(text):
            raise EnvironmentFaultError(f"{where}: the line is damaged (its checksum does not fit)", mend=mend)
        change = Change.model_validate_json(text)
    except (ValueError, ValidationError) as error:
        raise EnvironmentFaultError(f"{where}: the line is damaged or of another version", mend=mend) from error
    if change.version != number:
        raise EnvironmentFaultError(f"{where}: version {number} is missing", mend=mend)
    if number == 0 and change.facts.get("format") != FORMAT:
        found = change.facts.get("format")
        raise EnvironmentFaultError(
            f"{where}: journal format {found!r} is not {FORMAT!r}", mend="use the version that wrote it"
        )
    return change


def _write(path: Path, data: bytes) -> None:
    building = path.with_name(f".{path.name}.new")
    try:
        with building.open("wb") as stream:
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        building.replace(path)
    except OSError as error:
        raise _unwritable(path.parent, error) from error


def _unwritable(folder: Path, error: OSError) -> EnvironmentFaultError:
    what = f"the knowledge base in {folder} cannot be written: {error.strerror}"
    return EnvironmentFaultError(what, mend="give a folder that can be written: --kb DIR")
