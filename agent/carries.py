"""Whether what is to be put in or on another thing would stay there, by what was perceived of both."""

from __future__ import annotations

from agent.goal import Placement
from agent.language.describe import describe
from kb.percept import PerceivedObject

DEEP = 1.5
"""A hollow thing this many times as high as its opening is wide is no container: the hand cannot set anything down in it."""
WIDE_BOWL = 0.9
"""Share of a bowl's width that a thing may have at its narrower side to lie in it."""
MOUTHED = ("vase", "bottle", "wine_glass", "cup", "mug")
"""Kinds whose top is an opening, also where the rim was not seen."""
ROUND = ("apple", "tennis_ball", "banana")
"""Kinds on which nothing stays."""


def why_not(thing: PerceivedObject, placement: Placement, below: PerceivedObject) -> str | None:
    """Why `thing` would not stay in or on `below`, in one sentence, or None if it may.

    Args:
        thing: what is to be put there.
        placement: of kind "on", with the relation "in" or "on" as it was said.
        below: the thing that is to hold or carry it.
    """
    if thing.id == below.id:
        return None
    name, other = describe(thing).removeprefix("the "), describe(below).removeprefix("the ")
    if below.shape == "bowl" or below.category == "bowl":
        if thing.size[1] <= WIDE_BOWL * below.size[0]:
            return None
        return f"The {other} is {_cm(below.size[0])} wide, too small for the {name}; I leave everything as it is."
    mouth = opening(below)
    if placement.relation == "in":
        return _into(thing, name, below, other, mouth)
    if mouth is not None and (thing.size[1] > mouth or below.size[2] > DEEP * mouth):
        return (
            f"The {name} would not stay on the {other}: on top that is only an opening of about {_cm(mouth)}. "
            f"I can put it next to the {other}."
        )
    if below.shape == "sphere" or below.category in ROUND:
        return f"The {name} would not stay on the {other}, which is round. I can put it next to the {other}."
    return None


def _into(thing: PerceivedObject, name: str, below: PerceivedObject, other: str, mouth: float | None) -> str | None:
    """Why it does not go into a thing that is no bowl."""
    if mouth is None:
        return f"I see no opening in the {other} to put the {name} into. I can put it next to the {other}."
    if thing.size[0] > mouth:
        return (
            f"The {name} does not go into the {other}: the opening is about {_cm(mouth)} wide, the {name} "
            f"{_cm(thing.size[0])}. I can put it next to the {other}."
        )
    if below.size[2] > DEEP * mouth:
        return (
            f"I cannot put anything into the {other}: it is too deep and narrow for my hand, and the {name} would fall. "
            f"I can put it next to the {other}."
        )
    return None


def opening(obj: PerceivedObject) -> float | None:
    """Width of the opening on top [m], as measured or, for kinds that have one, at most; None where there is none."""
    for region in ("rim", "neck"):
        part = obj.part(region)
        if part is not None and part.radius is not None:
            wall = part.width if region == "rim" else 0.0
            return max(0.0, 2 * part.radius - 2 * wall)
    return min(obj.size[0], obj.size[1]) if obj.category in MOUTHED else None


def _cm(metres: float) -> str:
    return f"{metres * 100:.0f} cm"
