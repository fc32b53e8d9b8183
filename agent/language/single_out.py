"""Singles one thing out by superlative, ordinal, side or gradable adjective, as the person sees the table (kb.viewpoint)."""

from __future__ import annotations

from collections.abc import Callable

from agent.goal import Extreme, Reference
from kb.percept import PerceivedObject
from kb.viewpoint import BEHIND, LEFT

NOTICEABLE = 1.15
"""Ratio of sizes (or masses) from which one of two things is "the big one"."""

_MEASURE: dict[Extreme, Callable[[PerceivedObject], float]] = {
    "biggest": lambda o: o.size[0] * o.size[1] * o.size[2],
    "smallest": lambda o: -(o.size[0] * o.size[1] * o.size[2]),
    "tallest": lambda o: max(o.size),
    "shortest": lambda o: -max(o.size),
    "widest": lambda o: o.size[0] * o.size[1],
    "thinnest": lambda o: -o.size[1],
    "heaviest": lambda o: sum(o.mass),
    "lightest": lambda o: -sum(o.mass),
    "most_fragile": lambda o: o.affordance.fragility,
    "least_fragile": lambda o: -o.affordance.fragility,
    "leftmost": lambda o: leftness(o),
    "rightmost": lambda o: -leftness(o),
    "nearest": lambda o: -farness(o),
    "farthest": lambda o: farness(o),
    "middle": lambda o: 0.0,
}
_QUALITY: dict[str, Extreme] = {
    "big": "biggest", "small": "smallest", "tall": "tallest", "short": "shortest", "fragile": "most_fragile",
    "heavy": "heaviest", "light": "lightest",
}  # fmt: skip
_SIDE: dict[str, Extreme] = {"left": "leftmost", "right": "rightmost", "front": "nearest", "back": "farthest"}


def single_out(reference: Reference, found: list[PerceivedObject]) -> list[PerceivedObject]:
    """Superlatives, ordinals, sides and gradable adjectives."""
    if reference.side is not None and len(found) > 1:
        found = [_middle(found)] if reference.side == "middle" else [extreme_of(_SIDE[reference.side], found)]
    if reference.extreme is not None and len(found) > 1:
        return [_middle(found)] if reference.extreme == "middle" else [extreme_of(reference.extreme, found)]
    if reference.ordinal is not None:
        order = sorted(found, key=_ordinal_key(reference.ordinal_from))
        index = reference.ordinal - 1 if reference.ordinal > 0 else reference.ordinal
        return [order[index]] if -len(order) <= index < len(order) else []
    if reference.quality is not None and len(found) > 1:
        key = _MEASURE[_QUALITY[reference.quality]]
        order = sorted(found, key=key, reverse=True)
        first, second = abs(key(order[0])), abs(key(order[1]))
        clear = max(first, second) >= NOTICEABLE * min(first, second) and first != second
        return order[:1] if clear else found
    return found


def extreme_of(extreme: Extreme, found: list[PerceivedObject]) -> PerceivedObject:
    return max(found, key=_MEASURE[extreme])


def leftness(obj: PerceivedObject) -> float:
    """How far to the person's left an object stands [m]."""
    return sum(a * b for a, b in zip(obj.position, LEFT, strict=True))


def farness(obj: PerceivedObject) -> float:
    """How far from the person an object stands, along the view [m]."""
    return sum(a * b for a, b in zip(obj.position, BEHIND, strict=True))


def _middle(found: list[PerceivedObject]) -> PerceivedObject:
    order = sorted(found, key=leftness)
    return order[len(order) // 2]


def _ordinal_key(side: str) -> Callable[[PerceivedObject], float]:
    keys: dict[str, Callable[[PerceivedObject], float]] = {
        "left": lambda o: -leftness(o),
        "right": leftness,
        "front": farness,
        "back": lambda o: -farness(o),
    }
    return keys[side]
