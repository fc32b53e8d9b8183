"""Empty, filled or stacked, from the hollow's depth and from what the object stands on."""

from __future__ import annotations

from kb.percept import Part
from kb.vocabulary import ObjectState
from tools.perception.measure import Measured

FULL_DEPTH = 0.845
"""A hollow whose floor lies less than this share of its room below the rim is filled (perception.md: empty vessels
measured 0.88 and more, filled ones 0.81 and less)."""

FULL_STEMMED = 0.68
"""The same for what stands on a stem, whose room is less well known: empty 0.85 and more, filled 0.6."""


def state_of(
    measured: Measured, parts: tuple[Part, ...], *, stands_on_object: bool, holds_object: bool, contents_seen: bool
) -> ObjectState:
    """The physical state of an object.

    Args:
        measured: Its measurements.
        parts: Its parts; a stem takes its length off the room that could be filled.
        stands_on_object: Something other than the table is under it.
        holds_object: Something stands on it or in it, so that its floor is not seen.
        contents_seen: Pieces of another colour lie inside its rim.
    """
    if stands_on_object:
        return "stacked"
    if measured.hollow <= 0 or (holds_object and not contents_seen):
        return "empty"
    height = measured.top - measured.base
    stem = next((part for part in parts if part.region == "stem"), None)
    room = height if stem is None else measured.top - (stem.centre[2] + stem.length / 2)
    depth = measured.hollow * height / max(room, 1e-3)
    return "filled" if contents_seen or depth < (FULL_DEPTH if stem is None else FULL_STEMMED) else "empty"
