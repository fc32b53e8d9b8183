"""The knowledge base embedded by another embedder, from its stored reference views; the vectors are cached.

Vectors of two embedders are never compared: a store carries the name of the one that made it, and asking it with another
is refused. The cache is keyed by the embedder's name and the pictures, so a rebuilt knowledge base never finds old vectors.
"""

from __future__ import annotations

import logging
import os
import re
import tempfile
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kb.embedder import Embedder
from kb.errors import EnvironmentFaultError
from kb.experience_index import cache_folder
from kb.open_embedder import embed_views
from kb.reference_views import ReferenceView, load_views, view_key, views_digest, views_path
from kb.store import ExperienceStore
from kb.store_file import StoreHeader

log = logging.getLogger(__name__)

DECIMALS = 6
"""Decimals of the stored vectors, as in the knowledge base's file."""


def embedded_store(store: ExperienceStore, embedder: Embedder) -> ExperienceStore:
    """The same experiences with vectors of `embedder`: itself, from the cache, or embedded anew from the views.

    Raises:
        EnvironmentFaultError: if the views are missing or belong to another knowledge base.
    """
    if store.embedder_name == embedder.name:
        return store
    views = views_of(store, embedder.name)
    vectors = cached_vectors(embedder, views)
    rows: list[list[float]] = np.round(vectors, DECIMALS).tolist()
    entries = [
        entry.model_copy(update={"embedding": tuple(row), "embedder": embedder.name})
        for entry, row in zip(store.all(), rows, strict=True)
    ]
    header = StoreHeader(embedder=embedder.name, dim=embedder.dim, taxonomy=store.header.taxonomy)
    return ExperienceStore(header, entries, None)


def views_of(store: ExperienceStore, wanted: str) -> list[ReferenceView]:
    """The reference view of every entry, in the order of the store.

    Raises:
        EnvironmentFaultError: if the store has no file, or views are missing.
    """
    what = f"the knowledge base was embedded with {store.embedder_name!r}, the session uses {wanted!r}"
    named = "" if store.path is None else f" --store {store.path}"
    mend = f"make its reference views with `ragvlm kb views{named}`, or use the embedder that it was made with"
    if store.path is None or not views_path(store.path).is_file():
        raise EnvironmentFaultError(f"{what}, and it has no reference views to embed anew", mend=mend)
    stored = load_views(views_path(store.path))
    missing = [entry.id for entry in store.all() if view_key(entry) not in stored]
    if missing:
        raise EnvironmentFaultError(
            f"{what}, and {len(missing)} reference views are missing ({missing[0]}, ...)", mend=mend
        )
    return [stored[view_key(entry)] for entry in store.all()]


def cached_vectors(embedder: Embedder, views: Sequence[ReferenceView]) -> NDArray[np.float64]:
    """Vectors (N, dim) of the views, read from the cache or made and kept there."""
    file = cache_folder() / "embeddings" / f"{_plain(embedder.name)}-{views_digest(views)}.npy"
    try:
        found: NDArray[np.float64] = np.load(file, allow_pickle=False)
        if found.shape == (len(views), embedder.dim):
            return found
    except (OSError, ValueError, EOFError) as error:
        log.info("no cached vectors: %s", error)
    vectors = embed_views(embedder, views)
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=file.parent, suffix=".npy")
        with os.fdopen(handle, "wb") as stream:
            np.save(stream, vectors)
        os.replace(name, file)
    except OSError as error:  # a cache that cannot be written costs time, nothing else
        log.info("vectors are not cached: %s", error)
    return vectors


def _plain(name: str) -> str:
    return re.sub(r"[^A-Za-z0-9._-]", "-", name)
