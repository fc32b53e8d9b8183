"""Random generators by purpose and count: the same draw again after a resume, whatever happened in between."""

from __future__ import annotations

import zlib

import numpy as np


def draws(seed: int, purpose: str, count: int) -> np.random.Generator:
    """The generator of the `count`-th call for `purpose` in a run with `seed`.

    It depends on these three alone, so that a killed and resumed run, or a configuration that makes more calls of
    another kind, sees the very same numbers (common random numbers).
    """
    key = (zlib.crc32(purpose.encode()), count)
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=key))
