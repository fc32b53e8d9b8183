"""What lies inside a rim is contents, not an object."""

from __future__ import annotations

import numpy as np

from tools.perception.blob import CLEAR_LOSS, Blob
from tools.perception.measure import Measured

RING_INSIDE, RING_FLOOR, FEWEST_LOW = 0.7, 0.0035, 15
"""Within the first share of the radius a ring shows at least the last number of pixels lower than the second [m]."""


def is_inside(blob: Blob, holder: Measured) -> bool:
    """The blob is seen inside the rim of a round holder, and not above it."""
    if not holder.is_round or holder.radius < 0.02 or len(holder.blob.xyz) < 0.5 * len(blob.xyz):
        return False
    if holder.lost > CLEAR_LOSS and blob.all_edge():
        return False  # the slanted far side of the glass itself
    if is_ring(holder):
        return False  # it stands on the table in a ring
    if np.median(blob.xyz[:, 2]) < np.quantile(holder.blob.xyz[:, 2], 0.02):
        return False  # a wine glass's foot lies below its bowl
    reach = np.hypot(*(blob.xyz[:, :2] - holder.centre).T)
    within = np.quantile(reach, 0.95) < 0.96 * holder.radius and blob.from_top.mean() > 0.3
    return bool(within and np.quantile(blob.xyz[:, 2], 0.95) < holder.top + 0.004 and has_rim(holder))


def has_rim(holder: Measured) -> bool:
    """The holder's highest points form a ring: it has a rim and not a lid."""
    xyz = holder.blob.xyz
    high = xyz[(xyz[:, 2] > holder.top - 0.006) & holder.blob.from_top]
    if len(high) < 15:
        return False
    reach = np.hypot(*(high[:, :2] - holder.centre).T)
    return bool(np.quantile(reach, 0.3) > 0.7 * holder.radius)


def is_ring(holder: Measured) -> bool:
    """The table is seen in the middle of a round thing that stands on it: it has no floor and holds nothing."""
    if holder.lost > CLEAR_LOSS or holder.base > RING_FLOOR:
        return False
    seen = holder.blob.xyz[holder.blob.from_top]
    inner = np.concatenate([seen, holder.blob.low])
    z = inner[np.hypot(*(inner[:, :2] - holder.centre).T) < RING_INSIDE * holder.radius, 2]
    return len(z) >= FEWEST_LOW and float(np.median(z)) < RING_FLOOR
