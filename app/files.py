"""Writing files so that a reader never sees half of one, and refusing bad targets before the robot moves."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from kb.errors import BadInputError


def write_atomically(path: Path, content: str | bytes) -> None:
    """Writes a file by renaming a finished one into place, so that it is either the old or the new content."""
    data = content.encode("utf-8") if isinstance(content, str) else content
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=".tmp")
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(data)
            os.fchmod(stream.fileno(), 0o644)
        Path(temporary).replace(path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise


def refuse_unwritable_file(path: Path, *, where: str) -> None:
    """Raises `BadInputError` if a file could not be written there. Creates nothing."""
    if path.is_dir():
        raise BadInputError(f"{path} is a folder, a file is wanted", where=where)
    if not path.parent.is_dir():
        raise BadInputError(f"the folder {path.parent} does not exist", where=where)
    if path.exists() and not os.access(path, os.W_OK):
        raise BadInputError(f"{path} is read-only", where=where)
    if not os.access(path.parent, os.W_OK | os.X_OK):
        raise BadInputError(f"the folder {path.parent} is read-only", where=where)


def refuse_unusable_folder(path: Path, *, where: str, own_files: frozenset[str]) -> None:
    """Raises `BadInputError` unless `path` is a folder that can be made, is empty, or holds an earlier record.

    Args:
        path: The folder a record is to be written to.
        where: The option that named it.
        own_files: File names by which an earlier record is recognised; such a folder is written over.
    """
    if path.exists() and not path.is_dir():
        raise BadInputError(f"{path} is a file, a folder is wanted", where=where)
    if path.is_dir():
        names = {entry.name for entry in path.iterdir()}
        if names and not names & own_files:
            raise BadInputError(f"the folder {path} is not empty and holds no earlier record", where=where)
    nearest = next(parent for parent in (path, *path.absolute().parents) if parent.exists())
    if not nearest.is_dir() or not os.access(nearest, os.W_OK | os.X_OK):
        raise BadInputError(f"{nearest} cannot be written to", where=where)
