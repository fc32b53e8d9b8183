"""Made-up experiences for tests: the composition of ledger G12 with random strategies and embeddings."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from kb.experience import Experience, Strategy
from kb.priors import prior
from kb.store import ExperienceStore, new_store

EMBEDDER = "test-8"
DIM = 8

COMPOSITION: dict[str, tuple[int, int]] = {
    "cup": (10, 3),
    "mug": (6, 2),
    "apple": (8, 2),
    "bottle": (10, 3),
    "banana": (8, 1),
    "bowl": (10, 3),
    "cube": (5, 2),
    "block": (5, 1),
    "vase": (8, 1),
    "wine_glass": (10, 3),
    "screwdriver": (10, 3),
    "smartphone": (8, 1),
    "tennis_ball": (8, 1),
    "pen": (5, 2),
    "key": (5, 1),
}
"""Category -> (entries, failures among them): 116 and 29."""


def make_experience(
    entry_id: str,
    category: str,
    *,
    success: bool = True,
    embedding: tuple[float, ...] | None = None,
    **affordance: object,
) -> Experience:
    """One experience with the category's descriptor; keyword arguments replace fields of the descriptor."""
    rng = np.random.default_rng([ord(letter) for letter in entry_id])
    vector = rng.random(DIM) if embedding is None else np.asarray(embedding)
    descriptor = prior(category).affordance.model_copy(update=affordance)
    strategy = Strategy(
        region=descriptor.region,
        type="pinch",
        approach="top",
        tilt=0.0,
        force=float(rng.uniform(5, 20)),
        force_band=(5.0, 20.0),
        aperture=0.08,
        depth=0.5,
    )
    return Experience(
        id=entry_id,
        category=category,
        affordance=descriptor,
        size=(0.08, 0.08, 0.09),
        mass=0.3,
        strategy=strategy,
        success=success,
        n_trials=10,
        n_success=10 if success else 2,
        failures={} if success else {"SLIP": 8},
        embedding=tuple(float(v) for v in vector),
        embedder=EMBEDDER,
        seeds=(0, 9),
    )


def make_entries(composition: dict[str, tuple[int, int]] | None = None) -> list[Experience]:
    """Entries of the composition; the first of each category are the failures."""
    entries: list[Experience] = []
    for category, (count, failures) in (composition or COMPOSITION).items():
        entries += [make_experience(f"{category}_{i:02d}", category, success=i >= failures) for i in range(count)]
    return entries


def make_store(entries: list[Experience] | None = None, path: Path | None = None) -> ExperienceStore:
    """A store of made-up experiences; written to `path` if one is given."""
    store = new_store(make_entries() if entries is None else entries, embedder=EMBEDDER, dim=DIM, path=path)
    if path is not None:
        store.save(path)
    return store
