"""The systems that are compared: each ranks every entry of the knowledge base for a query.

All but the random ones and BM25 multiply the score of a failed entry by 0.7, as HAA-RAG does: the systems differ in what
they know of the object, not in whether they know the outcome.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kb.affordance import AffordanceDescriptor
from kb.experience import Experience
from kb.experience_table import ExperienceTable
from kb.taxonomy import Taxonomy
from tools.retrieve_haarag import (
    FEWEST,
    K1,
    PENALTY,
    TAU_AFFORDANCE,
    TAU_GUARD,
    W_AFFORDANCE,
    W_CATEGORY,
    W_VISUAL,
    affordance_scores,
)

Array = NDArray[np.float64]
Rows = NDArray[np.intp]

BM25_K1, BM25_B = 1.5, 0.75


@dataclass(frozen=True)
class Scores:
    """What is known about every entry for one query, all (N,)."""

    category: Array
    affordance: Array
    visual: Array
    same_type: NDArray[np.bool_]
    success: NDArray[np.bool_]
    id_rank: Rows
    ties: Rows
    """A random order that breaks the ties of the simple systems: none gains from the order of the file."""

    @property
    def factor(self) -> Array:
        """1 for a success, 0.7 for a failure."""
        return np.where(self.success, 1.0, PENALTY)


@dataclass(frozen=True)
class Fusion:
    """The numbers of HAA-RAG that the sweeps change."""

    tau: float = TAU_AFFORDANCE
    category: float = W_CATEGORY
    affordance: float = W_AFFORDANCE
    visual: float = W_VISUAL


def make_scores(
    table: ExperienceTable,
    taxonomy: Taxonomy,
    category: str,
    affordance: AffordanceDescriptor,
    visual: Array,
    rng: np.random.Generator,
) -> Scores:
    """All scores of a query; `visual` are the cosines (N,), zeros without a picture; `rng` breaks ties."""
    rows = np.arange(len(table))
    per_category = np.array([taxonomy.s_cat(category, name) for name in table.categories])
    return Scores(
        category=per_category[table.category],
        affordance=affordance_scores(affordance, table, rows),
        visual=np.maximum(0.0, visual),
        same_type=table.type == table.code(affordance.type),
        success=table.success,
        id_rank=table.id_rank,
        ties=rng.permutation(len(table)),
    )


def haa(scores: Scores, fusion: Fusion | None = None) -> Rows:
    """HAA-RAG's order of all entries: what level 2 keeps, then what it drops, then what level 1 drops.

    Among what is kept the rule of ledger G14d holds: no success of another type before the best one of the type.
    """
    f = fusion or Fusion()
    n = len(scores.category)
    fused = f.category * scores.category + f.affordance * scores.affordance + f.visual * scores.visual
    stage = np.full(n, 2)
    related = np.flatnonzero(scores.category > 0.0)
    if len(related) < FEWEST:
        related = np.arange(n)
    elif len(related) > K1:
        keys = (-scores.visual[related], -scores.affordance[related], -scores.category[related])
        related = related[np.lexsort((scores.id_rank[related], *keys))[:K1]]
    stage[related] = 1
    stage[related[scores.affordance[related] >= f.tau - TAU_GUARD]] = 0
    order = _ordered(fused * scores.factor, scores, stage)
    kept = order[stage[order] == 0]
    good = [row for row in kept.tolist() if scores.success[row]]
    match = next((row for row in good if scores.same_type[row]), None)
    if match is not None and good[0] != match:
        kept = kept[kept != match]
        kept = np.insert(kept, int(np.flatnonzero(kept == good[0])[0]), match)
    return np.concatenate([kept, order[stage[order] > 0]])


def category_only(scores: Scores) -> Rows:
    """By category score alone."""
    return _plain(scores.category * scores.factor, scores)


def affordance_only(scores: Scores) -> Rows:
    """By affordance score alone, over all categories."""
    return _plain(scores.affordance * scores.factor, scores)


def visual_only(scores: Scores) -> Rows:
    """The paper's baseline: category filter, then looks; the affordance level is skipped."""
    return _plain((W_CATEGORY * scores.category + W_VISUAL * scores.visual) * scores.factor, scores, by_category=True)


def visual_without_category(scores: Scores) -> Rows:
    """By looks alone, over all categories."""
    return _plain(scores.visual * scores.factor, scores)


def random_in_category(scores: Scores, rng: np.random.Generator) -> Rows:
    """The exact category's entries in random order, then the superclass's, then the rest."""
    return np.lexsort((rng.random(len(scores.category)), -scores.category)).astype(np.intp)


def oracle(gain: Array, relevant: NDArray[np.bool_], scores: Scores) -> Rows:
    """Knows the answers: relevant entries first, the more often successful the earlier."""
    return np.lexsort((scores.id_rank, -gain, ~relevant)).astype(np.intp)


def _ordered(score: Array, scores: Scores, stage: NDArray[np.intp]) -> Rows:
    """By stage, then score; ties as in ledger G14c."""
    return np.lexsort((scores.id_rank, -scores.visual, -scores.affordance, -score, stage)).astype(np.intp)


def _plain(score: Array, scores: Scores, *, by_category: bool = False) -> Rows:
    """By score; ties at random, so that no other level has its say. With a filter, related categories come first."""
    stage = (scores.category <= 0.0) if by_category else np.zeros(len(score), np.bool_)
    return np.lexsort((scores.ties, -np.round(score, 9), stage)).astype(np.intp)


class Bm25:
    """BM25 over a few words per entry (Robertson and Zaragoza 2009, Sec. 3): what a text-only retriever would do."""

    def __init__(self, entries: Sequence[Experience]) -> None:
        self._documents = [Counter(words_of(text_of(entry.category, entry.affordance, entry))) for entry in entries]
        self._lengths = np.array([sum(document.values()) for document in self._documents], np.float64)
        seen = Counter(word for document in self._documents for word in document)
        n = len(entries)
        self._idf = {word: math.log(1.0 + (n - count + 0.5) / (count + 0.5)) for word, count in seen.items()}

    def rank(self, category: str, affordance: AffordanceDescriptor, scores: Scores) -> Rows:
        """All entries by the words that they share with the query, which asks for a success."""
        words = words_of(f"{text_of(category, affordance)} success")
        norm = BM25_K1 * (1.0 - BM25_B + BM25_B * self._lengths / max(1e-9, float(self._lengths.mean())))
        total = np.zeros(len(self._documents))
        for word in words:
            count = np.array([document[word] for document in self._documents], np.float64)
            total += self._idf.get(word, 0.0) * count * (BM25_K1 + 1.0) / (count + norm)
        return _plain(total, scores)


def text_of(category: str, affordance: AffordanceDescriptor, entry: Experience | None = None) -> str:
    """An object, or an entry, in words."""
    fragile = "fragile" if affordance.fragility >= 0.5 else "delicate" if affordance.fragility >= 0.25 else "sturdy"
    text = f"{category} {affordance.type} {affordance.material} {affordance.region} {fragile}"
    if entry is None:
        return text
    plan = entry.strategy
    return f"{text} {plan.region} {plan.type} {plan.approach} {'success' if entry.success else 'failure'}"


def words_of(text: str) -> list[str]:
    """Lower-case words; names with underscores are taken apart."""
    return re.findall(r"[a-z]+", text.lower())
