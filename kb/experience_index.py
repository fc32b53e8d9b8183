"""The chromadb collection behind the store: a content-addressed index in the user's cache, or in memory.

An index is built in a folder of its own and moved to its place in one step, so that processes that start together never
write one database; afterwards it is only read.
"""

from __future__ import annotations

import logging
import os
import shutil
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from kb.errors import EnvironmentFaultError
from kb.experience import Experience

log = logging.getLogger(__name__)

NAME = "experiences"
IN_MEMORY = "memory"
"""Value of `RAGVLM_CACHE` that keeps the index in memory."""
KEPT_S = 30 * 24 * 3600.0
"""Indices of other contents that were not opened for this long are removed [s]."""


def cache_folder() -> Path:
    """Folder of the indices: `$RAGVLM_CACHE/kb`, else `$XDG_CACHE_HOME/ragvlm/kb`, else `~/.cache/ragvlm/kb`."""
    chosen = os.environ.get("RAGVLM_CACHE")
    if chosen:
        return Path(chosen) / "kb"
    base = os.environ.get("XDG_CACHE_HOME")
    return (Path(base) if base else Path.home() / ".cache") / "ragvlm" / "kb"


def open_index(entries: Sequence[Experience], content: str) -> Any:
    """The collection of `entries`, whose digest is `content`.

    Raises:
        EnvironmentFaultError: if chromadb is not installed.
    """
    try:
        import chromadb
    except ImportError as error:
        raise EnvironmentFaultError("chromadb cannot be imported", mend="install the package with `make`") from error
    if entries and os.environ.get("RAGVLM_CACHE") != IN_MEMORY:
        try:
            place = _ensure(entries, cache_folder() / content)
            collection = _opened(place, len(entries))
            _prune(place)
            return collection
        except Exception as error:  # an unusable cache (read-only, full, damaged) must not stop a run
            log.info("index in memory: %s", error)
    client = chromadb.EphemeralClient(_settings())
    collection = _empty(client, f"{NAME}-{content}-{os.urandom(4).hex()}")
    _fill(collection, entries)
    return collection


def _ensure(entries: Sequence[Experience], place: Path) -> Path:
    """Builds the index at `place` unless it is there."""
    import chromadb

    if not place.exists():
        place.parent.mkdir(parents=True, exist_ok=True)
        building = Path(tempfile.mkdtemp(dir=place.parent, prefix=".building-"))
        try:
            client: Any = chromadb.PersistentClient(str(building), _settings())
            _fill(_empty(client, NAME), entries)
            client.close()
            os.rename(building, place)
        except OSError:
            shutil.rmtree(building, ignore_errors=True)
            if not place.exists():  # otherwise another process was faster, and its index is the same
                raise
    return place


def _opened(place: Path, count: int) -> Any:
    import chromadb

    collection = chromadb.PersistentClient(str(place), _settings()).get_collection(NAME, embedding_function=None)
    if collection.count() != count:
        raise OSError(f"the index {place} is incomplete")
    return collection


def _prune(place: Path) -> None:
    """Marks this index as used and removes what nobody has used for long."""
    os.utime(place)
    oldest = time.time() - KEPT_S
    for other in place.parent.iterdir():
        if other != place and other.is_dir() and other.stat().st_mtime < oldest:
            shutil.rmtree(other, ignore_errors=True)


def _settings() -> Any:
    from chromadb.config import Settings

    return Settings(anonymized_telemetry=False)


def _empty(client: Any, name: str) -> Any:
    return client.create_collection(name, embedding_function=None, metadata={"hnsw:space": "cosine"})


def _fill(collection: Any, entries: Sequence[Experience]) -> None:
    if entries:
        collection.add(
            ids=[entry.id for entry in entries],
            embeddings=np.asarray([entry.embedding for entry in entries], dtype=np.float32),
            metadatas=[
                {"category": entry.category, "type": entry.affordance.type, "success": entry.success}
                for entry in entries
            ],
        )
