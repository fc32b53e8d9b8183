"""Runs every system on every query and measures it: the numbers of `ragvlm kb eval`."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.kb_eval import ranking
from bench.kb_eval.measure_ranking import Mean, means, ndcg, precision, reciprocal_rank
from bench.kb_eval.query import Query
from bench.kb_eval.relevance import FunctionalRelevance, affordance_relevant, gains
from kb.embedder import Embedder
from kb.experience import Experience
from kb.experience_table import ExperienceTable, make_table
from kb.open_embedder import embed_views
from kb.store import ExperienceStore
from kb.taxonomy import Taxonomy, TaxonomyName, taxonomy

Array = NDArray[np.float64]
Rows = NDArray[np.intp]

DRAWS = 20
"""Random rankings that are averaged per query."""
MEASURES = (
    "p_at_1", "p_at_3", "mrr", "affordance_match", "affordance_match_at_5", "r_func_p_at_1", "r_func_p_at_3",
    "r_func_mrr", "ndcg",
)  # fmt: skip


@dataclass(frozen=True)
class Sight:
    """One embedder with its vectors of the knowledge base and of the queries."""

    word: str
    """As on the command line."""
    title: str
    """As in the report."""
    table: ExperienceTable
    queries: Array
    """(Q, D); zeros where nothing was seen."""

    def cosines(self, query: int, rows: Rows) -> Array:
        """Cosines of a query with these entries."""
        return self.table.cosines(self.queries[query], rows)


def make_sight(word: str, title: str, embedder: Embedder, store: ExperienceStore, queries: Sequence[Query]) -> Sight:
    """Embeds all queries; `store` must be embedded by the same embedder."""
    store.require_embedder(embedder.name)
    vectors = np.zeros((len(queries), embedder.dim))
    seen = [number for number, query in enumerate(queries) if query.view is not None]
    if seen:
        vectors[seen] = embed_views(embedder, [view for query in queries if (view := query.view) is not None])
    return Sight(word, title, store.table(), vectors)


@dataclass(frozen=True)
class Setting:
    """What the systems are told of the queries, and which entries they may use."""

    true_descriptors: bool = False
    """True category and descriptor instead of the perceived ones."""
    leave_out: bool = False
    """Without the entries of the query's own category."""
    taxonomy: TaxonomyName = "known"


@dataclass(frozen=True)
class Judged:
    """One query against the entries that are left for it."""

    number: int
    query: Query
    rows: Rows
    scores: dict[str, ranking.Scores]
    """Per embedder."""
    relevant: NDArray[np.bool_]
    gain: Array
    """Executed success rates; NaN where not executed."""


def judge(
    queries: Sequence[Query], sights: Sequence[Sight], executed: FunctionalRelevance, setting: Setting
) -> list[Judged]:
    """Scores and relevance of every entry for every query."""
    words: Taxonomy = taxonomy(setting.taxonomy)
    found: list[Judged] = []
    for number, query in enumerate(queries):
        table = sights[0].table
        entries = table.entries
        mine = [r for r, e in enumerate(entries) if not (setting.leave_out and e.category == query.true_category)]
        rows = np.array(mine, np.intp)
        left = [entries[row] for row in mine]
        category = query.true_category if setting.true_descriptors else query.category
        affordance = query.true_affordance if setting.true_descriptors else query.affordance
        small = table if len(left) == len(entries) else make_table(left, table.vectors.shape[1])
        scores = {
            sight.word: ranking.make_scores(
                small, words, category, affordance, sight.cosines(number, rows), np.random.default_rng(query.seed)
            )
            for sight in sights
        }
        relevant = affordance_relevant(query.true_affordance, left)
        found.append(Judged(number, query, rows, scores, relevant, gains(query.model, left, executed)))
    return found


def system_orders(
    item: Judged, sights: Sequence[Sight], setting: Setting, rng: np.random.Generator
) -> dict[str, list[Rows]]:
    """The ranking of every system (several of the random one) for one judged query."""
    first = item.scores[sights[0].word]
    query = item.query
    category = query.true_category if setting.true_descriptors else query.category
    affordance = query.true_affordance if setting.true_descriptors else query.affordance
    entries = [sights[0].table.entries[row] for row in item.rows.tolist()]
    orders: dict[str, list[Rows]] = {"haa": [ranking.haa(first)]}
    for sight in sights:
        scores = item.scores[sight.word]
        if sight is not sights[0]:
            orders[f"haa_{sight.word}"] = [ranking.haa(scores)]
        orders[f"visual_{sight.word}"] = [ranking.visual_only(scores)]
        orders[f"visual_without_category_{sight.word}"] = [ranking.visual_without_category(scores)]
    orders["category_only"] = [ranking.category_only(first)]
    orders["affordance_only"] = [ranking.affordance_only(first)]
    orders["bm25"] = [ranking.Bm25(entries).rank(category, affordance, first)]
    orders["random_in_category"] = [ranking.random_in_category(first, rng) for _ in range(DRAWS)]
    orders["oracle"] = [ranking.oracle(np.nan_to_num(item.gain), item.relevant, first)]
    return orders


def measure(item: Judged, order: Rows, same_type: NDArray[np.bool_]) -> dict[str, float]:
    """All measures of one ranking; those that need executions are NaN where an execution is missing."""
    functional = np.where(np.isnan(item.gain), np.nan, item.gain >= 0.7 - 1e-9)
    seen = 1.0 if item.query.seen else 0.0  # what was not seen retrieves nothing
    top = functional[order]
    unknown = bool(np.isnan(item.gain).any())
    return {
        "p_at_1": seen * precision(order, item.relevant, 1),
        "p_at_3": seen * precision(order, item.relevant, 3),
        "mrr": seen * reciprocal_rank(order, item.relevant),
        "affordance_match": seen * precision(order, same_type, 3),
        "affordance_match_at_5": seen * precision(order, same_type, 5),
        "r_func_p_at_1": seen * float(top[0]),
        "r_func_p_at_3": seen * float(top[:3].mean()),
        "r_func_mrr": float("nan") if unknown else seen * reciprocal_rank(order, functional > 0.5),
        "ndcg": float("nan") if unknown else seen * ndcg(order, item.gain),
    }


def evaluate(
    queries: Sequence[Query],
    sights: Sequence[Sight],
    executed: FunctionalRelevance,
    setting: Setting,
    rng: np.random.Generator,
    resamples: int,
) -> dict[str, dict[str, Mean]]:
    """Every system's measures over the queries."""
    columns: dict[str, dict[str, list[float]]] = defaultdict(lambda: {name: [] for name in MEASURES})
    judged = judge(queries, sights, executed, setting)
    for item in judged:
        entries = [sights[0].table.entries[row] for row in item.rows.tolist()]
        same = np.array([entry.affordance.type == item.query.true_affordance.type for entry in entries], np.bool_)
        for name, orders in system_orders(item, sights, setting, rng).items():
            rows = [measure(item, order, same) for order in orders]
            for key in MEASURES:
                columns[name][key].append(float(np.mean([row[key] for row in rows])))
    objects = [query.model for query in queries]
    return {name: means(values, objects, np.random.default_rng(0), resamples) for name, values in columns.items()}


def wanted_pairs(
    queries: Sequence[Query], sights: Sequence[Sight], executed: FunctionalRelevance, setting: Setting
) -> list[tuple[str, Experience]]:
    """Pairs of object and entry whose outcome the first three places of the systems need (the random one aside)."""
    found: list[tuple[str, Experience]] = []
    for item in judge(queries, sights, executed, setting):
        entries = [sights[0].table.entries[row] for row in item.rows.tolist()]
        for name, orders in system_orders(item, sights, setting, np.random.default_rng(0)).items():
            if name != "random_in_category":
                found += [(item.query.model, entries[row]) for order in orders for row in order[:3].tolist()]
    return found


def sweep(judged: Sequence[Judged], word: str, fusions: Sequence[ranking.Fusion]) -> list[dict[str, float]]:
    """HAA-RAG with other numbers: P@1 and MRR by label and P@1 by execution, for every fusion."""
    found: list[dict[str, float]] = []
    for fusion in fusions:
        rows = [
            measure(item, ranking.haa(item.scores[word], fusion), np.zeros(len(item.rows), np.bool_)) for item in judged
        ]
        found.append(
            {key: float(np.mean([row[key] for row in rows])) for key in ("p_at_1", "mrr", "r_func_p_at_1")}
            | {"tau": fusion.tau, "category": fusion.category, "affordance": fusion.affordance, "visual": fusion.visual}
        )
    return found
