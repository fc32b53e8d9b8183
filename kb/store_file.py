"""The file of a knowledge base: a header line, then one experience a line; read strictly, written atomically.

Knows nothing of queries, indexes or scores.
"""

from __future__ import annotations

import json
import os
import shutil
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Literal, TypeVar, cast

from pydantic import ValidationError

from kb.base import Noun
from kb.errors import BadInputError, EnvironmentFaultError
from kb.experience import Experience

_Model = TypeVar("_Model", bound=Noun)


class StoreHeader(Noun):
    """First line of the file."""

    format: Literal["ragvlm-experiences"] = "ragvlm-experiences"
    schema_version: Literal[1] = 1
    embedder: str
    """Name of the embedder of every entry."""
    dim: int
    """Length of the embeddings."""
    taxonomy: str
    """Version of the taxonomy that the categories come from."""
    entries: int | None = None
    """How many lines follow, so that a file cut off between two lines is noticed; written by every save."""


def write_store(path: Path, header: StoreHeader, entries: Iterable[Experience]) -> None:
    """Writes a store's file atomically.

    Raises:
        EnvironmentFaultError: if the folder or file cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
        try:
            with os.fdopen(handle, "w", encoding="utf-8") as file:
                file.write(text_of_store(header, entries))
                file.flush()
                os.fsync(file.fileno())
            if path.exists():
                shutil.copymode(path, name)
            os.replace(name, path)
        except BaseException:
            Path(name).unlink(missing_ok=True)
            raise
    except OSError as error:
        mend = "give a path that can be written"
        raise EnvironmentFaultError(f"cannot write the knowledge base {path}: {error.strerror}", mend=mend) from error


def text_of_store(header: StoreHeader, entries: Iterable[Experience]) -> str:
    """The file's text: a header line, then one experience a line."""
    rows = [json.dumps(entry.model_dump(mode="json"), ensure_ascii=False) for entry in entries]
    first = header.model_copy(update={"entries": len(rows)})
    lines = [json.dumps(first.model_dump(mode="json"), ensure_ascii=False), *rows]
    return "\n".join(lines) + "\n"


def parse_store(text: str, where: str) -> tuple[StoreHeader, list[Experience]]:
    """Header and entries of a file's text; `where` names the file.

    Raises:
        BadInputError: if a line is damaged or of another version, with the line's number.
    """
    lines = text.splitlines()
    if not lines or not lines[0].strip():
        raise BadInputError("the knowledge base is empty", where=f"{where}:1")
    first = _json(lines[0], f"{where}:1")
    if first.get("format") != "ragvlm-experiences":
        raise BadInputError("this is no knowledge base of ours: the header is missing", where=f"{where}:1")
    if first.get("schema_version") != 1:
        found = first.get("schema_version")
        raise BadInputError(f"schema version {found!r} is not supported", where=f"{where}:1", choices=["1"])
    header = _model(StoreHeader, first, f"{where}:1")
    entries: list[Experience] = []
    seen: dict[str, int] = {}
    for number, line in enumerate(lines[1:], start=2):
        if not line.strip():
            continue
        entry = _model(Experience, _json(line, f"{where}:{number}"), f"{where}:{number}")
        check_entry(entry, header, f"{where}:{number}")
        if entry.id in seen:
            raise BadInputError(
                f"experience {entry.id!r} stands already in line {seen[entry.id]}", where=f"{where}:{number}"
            )
        seen[entry.id] = number
        entries.append(entry)
    if header.entries is not None and header.entries != len(entries):
        what = f"the knowledge base is cut off or damaged: {len(entries)} experiences instead of {header.entries}"
        raise BadInputError(what, where=f"{where}:{len(lines)}")
    return header.model_copy(update={"entries": None}), entries


def _json(line: str, where: str) -> dict[str, Any]:
    try:
        value = json.loads(line)
    except json.JSONDecodeError as error:
        raise BadInputError(f"damaged line ({error.msg} at column {error.colno})", where=where) from error
    if not isinstance(value, dict):
        raise BadInputError("damaged line (not an object)", where=where)
    return cast(dict[str, Any], value)


def _model(model: type[_Model], value: dict[str, Any], where: str) -> _Model:
    try:
        return model.model_validate(value)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        field = ".".join(str(part) for part in first["loc"])
        raise BadInputError(f"{field}: {first['msg']}", where=where) from error


def check_entry(entry: Experience, header: StoreHeader, where: str | None = None) -> None:
    """Raises `BadInputError` if an experience does not fit a store of this header."""
    if entry.embedder != header.embedder:
        what = (
            f"experience {entry.id!r} was embedded with {entry.embedder!r}, the knowledge base with {header.embedder!r}"
        )
        raise BadInputError(what, where=where, choices=[header.embedder])
    if len(entry.embedding) != header.dim:
        what = f"experience {entry.id!r} has {len(entry.embedding)} embedding numbers instead of {header.dim}"
        raise BadInputError(what, where=where)
    if not 0 <= entry.n_success <= entry.n_trials:
        raise BadInputError(
            f"experience {entry.id!r}: {entry.n_success} successes of {entry.n_trials} trials", where=where
        )
