"""The scored columns of a knowledge base as arrays, so that scoring takes the same few steps for 116 or 100,000 entries."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kb.affordance import AffordanceDescriptor
from kb.experience import Experience

Array = NDArray[np.float64]
Rows = NDArray[np.intp]

EXACT_LIMIT = 5000
"""Up to this many entries the vectors are kept in double precision; beyond, in single, and made exact on demand."""


@dataclass(frozen=True)
class ExperienceTable:
    """One row an entry, in the order of the knowledge base."""

    entries: tuple[Experience, ...]
    categories: tuple[str, ...]
    """Category names that occur, sorted."""
    category: NDArray[np.int32]
    """Index into `categories` (N,)."""
    words: dict[str, int]
    """Code of every word of the descriptors."""
    type: NDArray[np.int32]
    material: NDArray[np.int32]
    region: NDArray[np.int32]
    fragility: Array
    success: NDArray[np.bool_]
    id_rank: Rows
    """Place of the entry's id in alphabetical order (N,)."""
    vectors: NDArray[np.float64] | NDArray[np.float32]
    """Unit embeddings (N, D); a null vector stays null."""

    def __len__(self) -> int:
        return len(self.entries)

    def code(self, word: str) -> int:
        """Code of a descriptor's word; -1 if no entry has it."""
        return self.words.get(word, -1)

    def matches(self, affordance: AffordanceDescriptor, rows: Rows) -> tuple[Rows, Rows, Rows, Array]:
        """Of these rows: same type, material, region (0 or 1 each) and 1 - |difference of fragility|."""
        return (
            (self.type[rows] == self.code(affordance.type)).astype(np.intp),
            (self.material[rows] == self.code(affordance.material)).astype(np.intp),
            (self.region[rows] == self.code(affordance.region)).astype(np.intp),
            1.0 - np.abs(affordance.fragility - self.fragility[rows]),
        )

    def cosines(self, query: Array, rows: Rows) -> Array:
        """Exact cosines of a query (D,) with these rows, in [-1, 1]; each row's value does not depend on the others."""
        if self.vectors.dtype == np.float64:
            chosen = self.vectors[rows]
        else:
            places: list[int] = rows.tolist()
            chosen = unit(np.array([self.entries[place].embedding for place in places], np.float64))
        length = float(np.linalg.norm(query))
        if length == 0.0 or len(rows) == 0:
            return np.zeros(len(rows))
        return np.clip((chosen * (query / length)).sum(axis=1), -1.0, 1.0)

    def rough_cosines(self, query: Array) -> Array:
        """Cosines of a query (D,) with every row, by one matrix product: right to about 1e-6."""
        length = float(np.linalg.norm(query))
        if length == 0.0:
            return np.zeros(len(self))
        return (self.vectors @ (query / length).astype(self.vectors.dtype)).astype(np.float64)


def make_table(entries: Sequence[Experience], dim: int) -> ExperienceTable:
    """The columns of `entries`, whose embeddings have `dim` numbers."""
    categories = tuple(sorted({entry.category for entry in entries}))
    place = {name: number for number, name in enumerate(categories)}
    words: dict[str, int] = {}

    def coded(column: list[str]) -> NDArray[np.int32]:
        return np.array([words.setdefault(word, len(words)) for word in column], np.int32)

    kind = np.float64 if len(entries) <= EXACT_LIMIT else np.float32
    vectors = np.empty((len(entries), dim), kind)
    for row, entry in enumerate(entries):
        vectors[row] = entry.embedding
    order = sorted(range(len(entries)), key=lambda row: entries[row].id)
    id_rank = np.empty(len(entries), np.intp)
    id_rank[order] = np.arange(len(entries))
    return ExperienceTable(
        entries=tuple(entries),
        categories=categories,
        category=np.array([place[entry.category] for entry in entries], np.int32),
        words=words,
        type=coded([entry.affordance.type for entry in entries]),
        material=coded([entry.affordance.material for entry in entries]),
        region=coded([entry.affordance.region for entry in entries]),
        fragility=np.array([entry.affordance.fragility for entry in entries], np.float64),
        success=np.array([entry.success for entry in entries], np.bool_),
        id_rank=id_rank,
        vectors=unit(vectors),
    )


def unit(vectors: NDArray[np.floating]) -> NDArray[np.floating]:
    """Rows (N, D) scaled to length 1; null rows stay null."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    vectors /= np.where(lengths == 0.0, 1.0, lengths).astype(vectors.dtype)
    return vectors
