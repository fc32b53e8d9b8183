"""HAA-RAG from 116 to 100,000 entries: latency, memory, and recall against exact scoring of everything.

    python -m bench.kb_scale --sizes 116,1000,10000,100000 --out runs/kb_scale.json

Synthetic entries are the shipped ones with jittered pictures, fragilities and now and then another category. Latency is
processor time of `retrieve_haarag`, for queries of known categories and for queries that need the fallback to all entries.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
import tracemalloc
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.kb_eval import ranking
from kb.errors import BadInputError, RagVlmError
from kb.experience import Experience
from kb.store import ExperienceStore, new_store
from kb.taxonomy import taxonomy
from tools.context import ToolContext
from tools.retrieve_haarag import RetrieveArgs, retrieve_haarag

Array = NDArray[np.float64]

SIZES = (116, 1000, 10_000, 100_000)
JITTER = 0.03
"""Standard deviation of what is added to each number of a unit embedding."""
ASTRAY = 0.1
"""Share of synthetic entries that get another entry's category."""


def synthetic(shipped: Sequence[Experience], count: int, rng: np.random.Generator) -> list[Experience]:
    """`count` entries made of the shipped ones; the first are the shipped ones themselves."""
    entries = list(shipped[:count])
    for number in range(len(entries), count):
        base = shipped[int(rng.integers(len(shipped)))]
        vector = np.asarray(base.embedding) + rng.normal(0.0, JITTER, len(base.embedding))
        vector /= np.linalg.norm(vector)
        fragility = float(np.clip(base.affordance.fragility + rng.normal(0.0, 0.1), 0.0, 1.0))
        category = shipped[int(rng.integers(len(shipped)))].category if rng.random() < ASTRAY else base.category
        entries.append(
            base.model_copy(
                update={
                    "id": f"s{number:06d}",
                    "category": category,
                    "affordance": base.affordance.model_copy(update={"fragility": fragility}),
                    "embedding": tuple(vector.round(6).tolist()),
                    "success": bool(rng.random() < 0.75),
                }
            )
        )
    return entries


def queries(shipped: Sequence[Experience], count: int, rng: np.random.Generator, *, known: bool) -> list[RetrieveArgs]:
    """Queries like an entry, with another picture; unknown ones have no category."""
    found: list[RetrieveArgs] = []
    for _ in range(count):
        base = shipped[int(rng.integers(len(shipped)))]
        vector = np.asarray(base.embedding) + rng.normal(0.0, JITTER, len(base.embedding))
        category = base.category if known else "unknown"
        found.append(
            RetrieveArgs(
                category=category,
                affordance=base.affordance,
                embedding=tuple((vector / np.linalg.norm(vector)).tolist()),
            )
        )
    return found


def exact(args: RetrieveArgs, store: ExperienceStore, vectors: Array) -> list[str]:
    """Ids of the three best by scoring every entry in double precision."""
    table, query = store.table(), np.asarray(args.embedding)
    rng = np.random.default_rng(0)
    scores = ranking.make_scores(table, taxonomy(), args.category, args.affordance, vectors @ query, rng)
    top = ranking.haa(scores)[:3].tolist()
    if not any(table.success[row] for row in top):
        return []
    return [table.entries[row].id for row in top]


def measure(size: int, count: int = 200, *, memory: bool = True) -> dict[str, Any]:
    """Latency [ms], memory [MB] (slow to measure: 0 without `memory`) and recall at one size."""
    rng = np.random.default_rng(size)
    shipped = ExperienceStore.open()
    if memory:
        tracemalloc.start()
    store = new_store(synthetic(shipped.all(), size, rng), embedder=shipped.embedder_name, dim=shipped.header.dim)
    entries_mb = tracemalloc.get_traced_memory()[0] / 1e6
    began = time.process_time()
    table = store.table()
    build_s = time.process_time() - began
    table_mb = tracemalloc.get_traced_memory()[0] / 1e6 - entries_mb
    tracemalloc.stop()
    vectors = np.array([entry.embedding for entry in table.entries])
    vectors /= np.linalg.norm(vectors, axis=1, keepdims=True)
    row: dict[str, Any] = {"entries": size, "entries_mb": entries_mb, "table_mb": table_mb, "table_s": build_s}
    context = ToolContext(store=store)
    for name, known in (("known", True), ("fallback", False)):
        asked = queries(shipped.all(), count, rng, known=known)
        retrieve_haarag(asked[0], context)
        times: list[float] = []
        hits: list[float] = []
        for args in asked:
            began = time.process_time()
            found = retrieve_haarag(args, context)
            times.append(1000.0 * (time.process_time() - began))
            wanted = exact(args, store, vectors)
            if wanted:
                hits.append(len(set(wanted) & {item.experience.id for item in found.top}) / 3)
        p50, p99 = np.percentile(times, (50, 99))
        row |= {f"{name}_p50_ms": float(p50), f"{name}_p99_ms": float(p99), f"{name}_recall_at_3": float(np.mean(hits))}
    return row


def say(line: str) -> None:
    """One line on standard output, at once."""
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


def main(arguments: Sequence[str] | None = None) -> int:
    """Entry point of `python -m bench.kb_scale`."""
    parser = argparse.ArgumentParser(prog="python -m bench.kb_scale", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--sizes", default=",".join(map(str, SIZES)))
    parser.add_argument("--queries", type=int, default=200)
    parser.add_argument("--out", type=Path)
    given = parser.parse_args(arguments)
    try:
        sizes = [int(word) for word in given.sizes.split(",")]
    except ValueError as error:
        raise BadInputError(str(error), where="--sizes", choices=("whole numbers with commas",)) from error
    rows = [measure(size, given.queries) for size in sizes]
    say("| entries | p50 ms | p99 ms | recall@3 | p50 ms, all admitted | p99 ms | recall@3 | entries MB | columns MB |")
    say("|---:|---:|---:|---:|---:|---:|---:|---:|---:|")
    for row in rows:
        cells = [f"{row['entries']}"]
        for name in ("known", "fallback"):
            cells += [
                f"{row[f'{name}_p50_ms']:.2f}",
                f"{row[f'{name}_p99_ms']:.2f}",
                f"{row[f'{name}_recall_at_3']:.4f}",
            ]
        say("| " + " | ".join([*cells, f"{row['entries_mb']:.0f}", f"{row['table_mb']:.0f}"]) + " |")
    if given.out is not None:
        given.out.write_text(json.dumps(rows, indent=2) + "\n")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except RagVlmError as error:
        sys.exit(f"kb_scale: error: {error}")
