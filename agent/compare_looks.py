"""What two looks, one before and one after a motion, say about the motion (ledger G41, G46)."""

from __future__ import annotations

import math

from kb.percept import PerceivedObject, Percept
from kb.sensing import CameraEvidence

MOVED = 0.005
"""Displacements of others below this are not reported [m] (perception's own error is 2 mm median, 6 mm at the 95th
percentile, so nearer things cannot be told apart)."""
TILT_HEIGHT = 0.30
"""Relative change of height from which an object no longer stands as it stood."""


def compare_looks(before: Percept, after: Percept, target: str) -> CameraEvidence:
    """The camera's part of the evidence.

    Args:
        before: the look that the grasp was planned on.
        after: the look after the motion, with ids kept.
        target: perceived id of the target.
    """
    old = {obj.id: obj for obj in before.objects}
    new = {obj.id: obj for obj in after.objects}
    moved = {
        key: round(_distance(old[key], new[key]), 4)
        for key in old
        if key in new and key != target and _distance(old[key], new[key]) > MOVED
    }
    missing = tuple(key for key in old if key not in new and key != target)
    if target not in old or target not in new:
        return CameraEvidence(target_visible=False, others_moved=moved, missing=missing)
    return CameraEvidence(
        target_visible=True,
        target_moved=round(_distance(old[target], new[target]), 4),
        target_tilted=_tilted(old[target], new[target]),
        others_moved=moved,
        missing=missing,
    )


def _distance(a: PerceivedObject, b: PerceivedObject) -> float:
    return math.dist(a.position, b.position)


def _tilted(a: PerceivedObject, b: PerceivedObject) -> bool:
    """Whether the height changed more than it can by measuring: the object lies now, or stands up."""
    return abs(a.size[2] - b.size[2]) > max(0.02, TILT_HEIGHT * max(a.size[2], b.size[2]))
