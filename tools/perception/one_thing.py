"""Whether something strange on or beside something strange is a part of it: a cap, keys, pages, a hammer's head.

What a person puts together lies askew; what is made as one has a common axis.
"""

from __future__ import annotations

import numpy as np

from tools.perception.affordance_of_unknown import is_rounded
from tools.perception.measure import Measured

LAYER = 0.004
"""What rises less than this above its support is a part of its surface [m]: no object is that thin."""
COMMON_AXIS = 0.004
"""Distance of the middles up to which two pieces have one axis [m]."""
LID, LID_OFF = 0.2, 0.35
"""What rises less than this share of the body below may lie off its axis by this share of its width: part of it is hidden."""
CAP = 0.75
"""A round cap on a body that is not round is narrower than this share of the body's narrow side."""
SQUARE, AXIS_OFF = 0.95, 0.15
"""Sides of what may be round although its outline is rough, and how far off its middle a cap sits, over its radius."""
STUB, SKEW = 0.7, 0.3
"""What sticks out of a rounded body is narrower than this share of it, and is so far off the axis of both at most, over the
distance of their middles: the box around both may stand askew."""
ALIGNED = 10.0
"""Angle up to which two pieces are parallel or square to each other [deg]."""
ALIKE, SLAB = 0.15, 2.5
"""Relative difference of lengths and heights of two slabs, and their height over their thickness."""
ABUTS = 0.012
"""Free distance of two pieces that lie end to end [m]."""
SLICE, COVERS = 0.022, 0.6
"""A flat piece up to this high [m] that covers this share of a body's top is the top of it."""


def is_part_of(upper: Measured, lower: Measured, both: Measured) -> bool:
    """Whether `upper`, which seems to lie on `lower`, is rather a part of it; both fit no category."""
    height, below = upper.top - upper.base, lower.top - lower.base
    if height < LAYER:
        return True
    square = bool(both.box.size[1] > SQUARE * both.box.size[0])
    if upper.is_round and (both.is_round or square) and both.radius > upper.radius - COMMON_AXIS and below > height:
        # The cap hides the back of what is below it; together they are round about the cap's axis.
        if float(np.hypot(*(upper.centre - both.centre))) < max(COMMON_AXIS, AXIS_OFF * both.radius):
            return True
    apart = float(np.hypot(*(upper.centre - lower.centre)))
    if apart > COMMON_AXIS:
        return _within(upper, lower) and _symmetric(upper, lower, lid=height < LID * below)
    if upper.is_round and lower.is_round:
        return upper.radius < lower.radius + COMMON_AXIS and below > 0.5 * height
    if upper.is_round:
        return 2.0 * upper.radius < CAP * float(lower.box.size[1]) and below > 1.5 * height
    share = float(np.prod(upper.box.size[:2]) / np.prod(lower.box.size[:2]))
    return height < max(SLICE, LID * below) and _within(upper, lower) and share > COVERS and below > 2.0 * height


def continues(one: Measured, two: Measured, both: Measured) -> bool:
    """Whether two pieces that touch side by side are one thing: the axis of one runs through the middle of the other."""
    if _slabs(one, two) or _stub(one, two, both):
        return True
    for first, second in ((one, two), (two, one)):
        x, _ = np.abs(first.box.local(second.box.centre[None])[0, :2])
        if first.is_round or not _symmetric(second, first):
            continue
        square = _angle(first, second) > 45.0
        half = float(second.box.size[1 if square else 0]) / 2
        # Edges are seen twice, so that the outlines overlap; but the middle of one lies beyond the end of the other.
        if -half < x - float(first.box.size[0]) / 2 - half < ABUTS:
            return True
    return False


def _slabs(one: Measured, two: Measured) -> bool:
    """Two upright slabs of the same length and height, face to face: the cover and the rest of a book."""
    if one.is_round or two.is_round or _angle(one, two) > 2.0 * ALIGNED:
        return False
    long = abs(float(one.box.size[0] / two.box.size[0]) - 1.0) < ALIKE
    high = abs((one.top - one.base) / (two.top - two.base) - 1.0) < ALIKE
    thin = max(float(one.box.size[1]), float(two.box.size[1]))
    tall = min(one.top - one.base, two.top - two.base) > SLAB * thin
    return long and high and tall and float(np.hypot(*(one.box.centre - two.box.centre)[:2])) < thin


def _stub(one: Measured, two: Measured, both: Measured) -> bool:
    """A narrow piece at the end of a rounded one, on the long axis of both: a bulb's base. A rounded body has no axis."""
    body, piece = (one, two) if one.box.size[0] > two.box.size[0] else (two, one)
    if piece.is_round or not is_rounded(body) or piece.box.size[0] > STUB * body.box.size[1]:
        return False
    (x, off_piece), (y, off_body) = (both.box.local(part.box.centre[None])[0, :2] for part in (piece, body))
    return bool(x * y < 0.0 and max(abs(off_piece), abs(off_body)) < SKEW * abs(x - y))


def _within(upper: Measured, lower: Measured) -> bool:
    """Neither of its sides is longer than the other's."""
    return bool(np.all(upper.box.size[:2] < lower.box.size[:2] + COMMON_AXIS))


def _symmetric(piece: Measured, body: Measured, *, lid: bool = False) -> bool:
    """Its middle lies on the body's long axis, and its sides are parallel to the body's."""
    if piece.is_round or body.is_round:
        return False
    off = abs(float(body.box.local(piece.box.centre[None])[0, 1]))
    angle = _angle(piece, body)
    most = max(COMMON_AXIS, LID_OFF * float(body.box.size[1])) if lid else COMMON_AXIS
    return off < most and min(angle, 90.0 - angle) < ALIGNED


def _angle(one: Measured, two: Measured) -> float:
    """Angle between the long axes [deg], in [0, 90]."""
    turn = abs(float(one.box.yaw - two.box.yaw)) % np.pi
    return float(np.degrees(min(turn, np.pi - turn)))
