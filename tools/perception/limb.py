"""A foot of a strange thing that the pictures show apart from it: its root is hidden below the body."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tools.perception.blob import Blob
from tools.perception.piece_facts import same_colour
from tools.perception.segment import chromaticity

Array = NDArray[np.float64]

LARGEST, SHARE, GAP = 0.040, 0.10, 0.020
"""Largest extent of a foot [m], its share of the body's points, and its distance from them [m]."""


def is_limb(small: Blob, body: Blob) -> bool:
    """Whether a small blob on the table is a foot of the body beside it; both fit no category, and have one colour."""
    if len(small.xyz) > SHARE * len(body.xyz) or float(np.ptp(small.xyz, axis=0).max()) > LARGEST:
        return False
    if nearest(small.xyz, body.xyz, GAP) > GAP:
        return False
    one, two = (chromaticity(np.median(blob.rgb, axis=0)[None])[0] for blob in (small, body))
    return same_colour(one, two)


def nearest(few: Array, many: Array, within: float) -> float:
    """Smallest distance between points (N, 3) and (M, 3) [m]; infinite if it is more than `within` [m]."""
    near = many[np.all((many > few.min(axis=0) - within) & (many < few.max(axis=0) + within), axis=1)]
    if not len(near):
        return float("inf")
    return float(np.sqrt(min(((near - point) ** 2).sum(axis=1).min() for point in few)))
