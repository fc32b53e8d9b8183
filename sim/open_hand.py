"""How far points are from the open Panda hand, as boxes, and from plain boxes around its palm and fingers.

Coordinates are in the hand's axes about the tool point; the hand's frame is that of `sim.hand`.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sim.hand import FINGER_BOXES, FINGER_OFFSET, PALM_BOXES, TCP_OFFSET

Array = NDArray[np.float64]

_ALL = [((0.0, 0.0, c[2]), half) for c, half in PALM_BOXES]
_ALL += [((0.0, c[1], c[2] + FINGER_OFFSET), half) for c, half in FINGER_BOXES]
_MIDDLES, _HALVES = (np.array([box[k] for box in _ALL]).T[:, :, None] for k in (0, 1))
_OPENS = np.array([0.0 for _ in PALM_BOXES] + [0.5 for _ in FINGER_BOXES])[:, None]
"""The boxes in the quadrant of |x|, |y|: middles and half sizes, by axis and box (3, 5, 1) [m]."""


@lru_cache(maxsize=256)
def _stretched(aperture: float, standoff: float) -> tuple[Array, Array]:
    """Middles from the tool point and half sizes (3, 5, 1) [m] of the open hand's boxes, stretched back by `standoff`."""
    middles, halves = _MIDDLES.copy(), _HALVES.copy()
    middles[1] += _OPENS * aperture
    middles[2] = middles[2] - TCP_OFFSET - standoff / 2.0
    halves[2] += standoff / 2.0
    return middles, halves


def distances(folded: Array, aperture: float, standoff: float) -> Array:
    """Signed distance of points to the hand stretched back along its approach by `standoff`, shape (..., N).

    Coordinates |x|, |y|, z, (3, ..., N), are in the hand's axes about the tool point. The hand is its own mirror image in
    x and y, so five boxes in the quadrant of |x|, |y| stand for all eight.
    """
    middles, halves = _stretched(aperture, standoff)
    if folded.ndim > 2:
        middles, halves = middles[:, None], halves[:, None]
    outside = folded[..., None, :] - middles
    np.abs(outside, out=outside)
    outside -= halves
    return nearest(outside)


def nearest(outside: Array) -> Array:
    """Smallest signed distance (..., N) [m] to boxes from how far points are outside of them by axis, (3, ..., B, N)."""
    squared = np.maximum(outside, 0.0)
    squared *= squared
    total = squared[0] + squared[1]
    total += squared[2]
    out = np.sqrt(np.minimum.reduce(total, axis=-2))
    if out.size and not np.minimum.reduce(out, axis=None):
        # Only what is in a box, or on its face, has a depth.
        out += np.minimum(np.minimum.reduce(np.maximum.reduce(outside, axis=0), axis=-2), 0.0)
    return out


def from_boxes(outside: Array) -> Array:
    """Signed distance (B, N) [m] to each box from how far points are outside of it by axis, (3, B, N)."""
    deepest = np.maximum.reduce(outside, axis=0)
    squared = np.maximum(outside, 0.0)
    squared *= squared
    total = squared[0] + squared[1]
    total += squared[2]
    return np.where(deepest > 0.0, np.sqrt(total), deepest)


def folded_of(points: Array) -> Array:
    """Coordinates (3, ...) with x and y without their signs."""
    out = np.abs(points)
    out[2] = points[2]
    return out


def _boxed(centres_halves: Sequence[tuple[tuple[float, float, float], tuple[float, float, float]]]) -> Array:
    """Lower and upper corner (2, 3) of the box around boxes [m]."""
    corners = [(np.array(c) - half, np.array(c) + half) for c, half in centres_halves]
    return np.array([np.min([low for low, _ in corners], axis=0), np.max([high for _, high in corners], axis=0)])


_PALM, _FINGER = _boxed(PALM_BOXES), _boxed(FINGER_BOXES)
_AROUND_LOW = np.array([[-np.inf, -np.inf], [_PALM[0, 1], _FINGER[0, 1]], [_PALM[0, 2], _FINGER[0, 2] + FINGER_OFFSET]])
_AROUND_HIGH = np.array(
    [
        [_PALM[1, 0], _FINGER[1, 0]],
        [_PALM[1, 1], _FINGER[1, 1]],
        [_PALM[1, 2], _FINGER[1, 2] + FINGER_OFFSET],
    ]
)
_AROUND_OPENS = np.array([0.0, 0.5])
"""Boxes around the palm and around a finger: least and greatest |x|, |y| and z [m], one a column."""


@lru_cache(maxsize=256)
def around(aperture: float, standoff: float) -> tuple[Array, Array]:
    """Lower and upper corners (3, 2, 1) [m] about the tool point of boxes around palm and finger."""
    low, high = _AROUND_LOW.copy(), _AROUND_HIGH.copy()
    for corners in (low, high):
        corners[1] += _AROUND_OPENS * aperture
        corners[2] -= TCP_OFFSET
    low[2] -= standoff
    return low[:, :, None], high[:, :, None]
