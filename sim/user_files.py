"""Files that a scene file names: only regular files inside the scene file's own folder are ever opened."""

from __future__ import annotations

from pathlib import Path

from kb.errors import BadInputError

MAX_BYTES = 50_000_000
"""Largest mesh or MJCF file [bytes]."""


def inside(folder: Path, name: str, where: str, suffixes: tuple[str, ...] = ()) -> Path:
    """The real path of a file named relative to `folder`.

    Args:
        folder: The scene file's folder.
        name: The path as the file says it.
        where: Place for the error message.
        suffixes: Allowed endings in lower case; any if empty.

    Raises:
        BadInputError: it is absolute, leads out of the folder (by "..", or by a symbolic link), is missing, is not a
            regular file, is too big, or ends otherwise.
    """
    if not name or "\0" in name:
        raise BadInputError("a file name is empty or broken", where=where)
    path = Path(name)
    if path.is_absolute() or "\\" in name or ":" in name or ".." in path.parts:
        raise BadInputError(f"{name!r} leads out of the scene file's folder", where=where)
    if suffixes and path.suffix.lower() not in suffixes:
        raise BadInputError(f"{name!r} is not of a known kind", where=where, choices=suffixes)
    root = folder.resolve()
    try:
        real = (root / path).resolve()
        if not real.is_relative_to(root):
            raise BadInputError(f"{name!r} leads out of the scene file's folder", where=where)
        if not real.is_file():
            raise BadInputError(f"there is no file {name!r}", where=where)
        size = real.stat().st_size
    except (OSError, RuntimeError) as error:
        raise BadInputError(f"{name!r} cannot be read", where=where) from error
    if size > MAX_BYTES:
        raise BadInputError(f"{name!r} has {size / 1e6:.0f} MB, at most {MAX_BYTES / 1e6:.0f}", where=where)
    return real


def read(path: Path, where: str) -> bytes:
    """The bytes of a file that `inside` has found good."""
    try:
        return path.read_bytes()
    except OSError as error:
        raise BadInputError(f"{path.name!r} cannot be read: {error.strerror}", where=where) from error
