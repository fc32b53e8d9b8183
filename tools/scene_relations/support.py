"""Vertical relations: resting on, lying above, being inside (ledger G6, G7)."""

from __future__ import annotations

from kb.percept import PerceivedObject
from kb.priors import prior
from kb.vocabulary import UNKNOWN_CATEGORY
from tools.scene_relations.solid import Solid, largest
from tools.scene_relations.surface_gap import overlap_share

REST_TOLERANCE = 0.010
"""Largest difference of the upper object's base and the lower one's top while resting [m] (ledger G7: 1 cm)."""
OVERLAP = 0.25
"""Least share of either footprint over the other for one to be above the other."""
INSIDE_OVERLAP = 0.5
"""Least share of the inner footprint over the container's."""
CERTAIN_OVERLAP = 0.9
"""Share over a thing of unknown category from which it counts as hollow."""
SAME_GROUND = 0.003
"""What begins less than this above the base of what surrounds it stands in a ring, on the same ground [m]: a vessel has
a floor."""
INSIDE_DEPTH = 0.010
"""Depth below the container's top edge that makes a thing be inside [m]."""


def over(upper: Solid, lower: Solid) -> bool:
    """Whether the footprints overlap by `OVERLAP` of either."""
    return overlap_share(upper, lower) >= OVERLAP or overlap_share(lower, upper) >= OVERLAP


def is_above(upper: Solid, lower: Solid) -> bool:
    """ABOVE: the footprints overlap, and the upper one begins at the lower one's top or higher.

    It may begin deeper by `REST_TOLERANCE`, but not under the middle of a thin thing, so that two things are never
    above each other.
    """
    tolerance = min(REST_TOLERANCE, (lower.high - lower.low) / 2.0)
    higher = upper.low + upper.high > lower.low + lower.high
    return higher and upper.low >= lower.high - tolerance and over(upper, lower)


def rests_on(upper: Solid, lower: Solid) -> bool:
    """The upper one lies above, and its base is at the lower one's top within `REST_TOLERANCE`."""
    return upper.low <= lower.high + REST_TOLERANCE and is_above(upper, lower)


def breadth(solid: Solid) -> float:
    """Smaller half extent of the footprint [m]."""
    piece = largest(solid)
    return min(piece.half) + piece.reach()


def sticks_out(inner: Solid, outer: Solid) -> bool:
    """Whether a thing inside another one rises above its edge: the edge is no support, but it is borne all the same."""
    return inner.high >= outer.high + INSIDE_DEPTH


def is_hollow(obj: PerceivedObject) -> bool:
    """Whether things can be inside: a bowl shape, a seen rim, or a container by category; not through a neck."""
    if obj.part("neck") is not None:
        return False
    return obj.shape == "bowl" or obj.part("rim") is not None or prior(obj.category).container


def is_inside(inner: Solid, outer: Solid, outer_object: PerceivedObject) -> bool:
    """INSIDE: the slimmer inner one lies over a hollow outer one, begins below its edge and above its floor.

    Two things cannot be in one place: an unknown thing that holds nearly the whole footprint of another one must be
    hollow, whatever it looks like.
    """
    if not outer.low + SAME_GROUND <= inner.low <= outer.high - INSIDE_DEPTH or breadth(inner) >= breadth(outer):
        return False
    share = overlap_share(inner, outer)
    must_be_hollow = outer_object.category == UNKNOWN_CATEGORY and share >= CERTAIN_OVERLAP
    return must_be_hollow or (is_hollow(outer_object) and share >= INSIDE_OVERLAP)
