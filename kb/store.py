"""The store of the 116 experiences: a JSON-lines file, indexed by a chromadb collection, scored exactly by us.

The file is the truth: a header line, then one experience a line. The collection is an index of its content, kept in the
user's cache under the content's hash; where nothing can be written it lives in memory. Nothing here goes online.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kb.errors import BadInputError, EnvironmentFaultError
from kb.experience import Experience
from kb.experience_table import ExperienceTable, make_table
from kb.store_file import StoreHeader, check_entry, parse_store, text_of_store, write_store
from kb.taxonomy import taxonomy

SHIPPED = "experiences.jsonl"
SUGGESTED_MEND = "restore the file, or rebuild it with `ragvlm kb build`"


class ExperienceStore:
    """Experiences in memory, with a chromadb collection for the queries that an index serves."""

    def __init__(self, header: StoreHeader, entries: Sequence[Experience], path: Path | None = None) -> None:
        self._header = header
        self._entries = list(entries)
        self._path = path
        self._by_id = {entry.id: entry for entry in self._entries}
        self._collection: Any = None
        self._table: ExperienceTable | None = None
        for entry in self._entries:
            check_entry(entry, header)
        if len(self._by_id) != len(self._entries):
            raise BadInputError("two experiences have the same id", where=None if path is None else str(path))

    # -- reading

    @classmethod
    def open(cls, path: str | Path | None = None) -> ExperienceStore:
        """Reads a store; without a path, the one shipped with the package.

        Raises:
            BadInputError: if a file that was named does not exist or holds no text, or a line is damaged or of another
                version, with the line's number.
            EnvironmentFaultError: if the file cannot be read, or the shipped one is missing.
        """
        file = Path(str(resources.files("kb").joinpath("data", SHIPPED))) if path is None else Path(path)
        try:
            text = file.read_text(encoding="utf-8")
        except FileNotFoundError as error:
            what = f"there is no knowledge base at {file}"
            if path is None:
                raise EnvironmentFaultError(what, mend=SUGGESTED_MEND) from error
            raise BadInputError(f"{what}; make one with `ragvlm kb build --out {file}`") from error
        except UnicodeDecodeError as error:
            what = f"this is no knowledge base of ours: byte {error.start} is no text; {SUGGESTED_MEND}"
            raise BadInputError(what, where=str(file)) from error
        except OSError as error:
            raise EnvironmentFaultError(
                f"cannot read the knowledge base {file}: {error.strerror}", mend=SUGGESTED_MEND
            ) from error
        header, entries = parse_store(text, str(file))
        return cls(header, entries, file)

    @property
    def header(self) -> StoreHeader:
        return self._header

    @property
    def embedder_name(self) -> str:
        """Name of the embedder that made every embedding of the store."""
        return self._header.embedder

    @property
    def path(self) -> Path | None:
        return self._path

    def __len__(self) -> int:
        return len(self._entries)

    def all(self) -> tuple[Experience, ...]:
        """Every experience, in the order of the file."""
        return tuple(self._entries)

    def get(self, entry_id: str) -> Experience:
        """The experience of that id.

        Raises:
            BadInputError: if there is none.
        """
        if entry_id not in self._by_id:
            raise BadInputError(f"there is no experience {entry_id!r}", choices=sorted(self._by_id)[:20])
        return self._by_id[entry_id]

    def by_category(self, *categories: str) -> tuple[Experience, ...]:
        """Experiences of these categories, in the order of the file, found through the collection's metadata."""
        if not categories or not self._entries:
            return ()
        found = self.collection().get(where={"category": {"$in": list(categories)}}, include=[])
        wanted = set(found["ids"])
        return tuple(entry for entry in self._entries if entry.id in wanted)

    def query_visual(self, embedding: Sequence[float], k: int) -> tuple[tuple[Experience, float], ...]:
        """The k experiences most similar to `embedding`, with exact cosines, best first (ties: smaller id).

        The collection proposes four times as many as asked (its graph search is approximate); the order is ours.
        """
        query = self.check_query(embedding)
        if not self._entries or k <= 0:
            return ()
        wanted = min(len(self._entries), max(4 * k, 20))
        answer = self.collection().query(query_embeddings=[query.tolist()], n_results=wanted, include=[])
        scored = [(self._by_id[entry_id], self.cosine(query, entry_id)) for entry_id in answer["ids"][0]]
        return tuple(sorted(scored, key=lambda pair: (-pair[1], pair[0].id))[:k])

    def cosine(self, query: NDArray[np.float64], entry_id: str) -> float:
        """Exact cosine of a query vector and an entry's embedding; 0 for a null vector."""
        return cosine(query, np.asarray(self._by_id[entry_id].embedding))

    def check_query(self, embedding: Sequence[float]) -> NDArray[np.float64]:
        """The embedding as an array, if its length fits this store.

        Raises:
            BadInputError: if it does not.
        """
        query = np.asarray(embedding, dtype=np.float64)
        if query.shape != (self._header.dim,):
            what = f"the query has {query.size} numbers, the knowledge base's embeddings have {self._header.dim}"
            raise BadInputError(what, where=self._where())
        return query

    def require_embedder(self, name: str) -> None:
        """Refuses to compare embeddings of two embedders.

        Raises:
            EnvironmentFaultError: if `name` is not the embedder of this store.
        """
        if name != self._header.embedder:
            what = f"the knowledge base was embedded with {self._header.embedder!r}, the session uses {name!r}"
            raise EnvironmentFaultError(
                what, mend=f"rebuild it with `ragvlm kb build`, or use {self._header.embedder!r}"
            )

    # -- writing

    def add(self, entry: Experience) -> None:
        """Appends one experience; the file is replaced atomically, so a crash leaves the old or the new one.

        Raises:
            BadInputError: if its id exists or its embedding does not fit.
            EnvironmentFaultError: if the file cannot be written.
        """
        check_entry(entry, self._header)
        if entry.id in self._by_id:
            raise BadInputError(f"there is already an experience {entry.id!r}", where=self._where())
        entries = [*self._entries, entry]
        if self._path is not None:
            write_store(self._path, self._header, entries)
        self._entries, self._collection, self._table = entries, None, None
        self._by_id[entry.id] = entry

    def save(self, path: str | Path) -> None:
        """Writes the whole store to `path`, atomically."""
        write_store(Path(path), self._header, self._entries)

    # -- index

    def content_hash(self) -> str:
        """Digest of header and entries; the same content always has the same."""
        digest = hashlib.sha256(text_of_store(self._header, self._entries).encode())
        return digest.hexdigest()[:16]

    def collection(self) -> Any:
        """The chromadb collection of this content (made on first use)."""
        if self._collection is None:
            from kb.experience_index import open_index  # chromadb takes 0.7 s to import

            self._collection = open_index(self._entries, self.content_hash())
        return self._collection

    def table(self) -> ExperienceTable:
        """The scored columns as arrays (made on first use)."""
        if self._table is None:
            self._table = make_table(self._entries, self._header.dim)
        return self._table

    def _where(self) -> str | None:
        return None if self._path is None else str(self._path)


def cosine(one: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    """Cosine of two vectors (N,), in [-1, 1]; 0 if one is null."""
    lengths = float(np.linalg.norm(one) * np.linalg.norm(other))
    return 0.0 if lengths == 0.0 else float(np.clip(one @ other / lengths, -1.0, 1.0))


def new_store(entries: Iterable[Experience], *, embedder: str, dim: int, path: Path | None = None) -> ExperienceStore:
    """A store of these entries, all embedded by `embedder`."""
    header = StoreHeader(embedder=embedder, dim=dim, taxonomy=taxonomy().version)
    return ExperienceStore(header, list(entries), path)
