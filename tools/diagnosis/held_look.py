"""A look while something is held: when it is worth its time, and what it shows.

Two things of a kind feel the same in the hand. Which of them is held shows at the places that they stood on.
"""

from __future__ import annotations

from kb.percept import PerceivedObject, Percept
from kb.sensing import PlaceEvidence, Sensing
from tools.context import ToolContext
from tools.diagnosis.claim import CLOSED_EMPTY, HEAVY, LEAST_LOAD, LIGHT, WIDTH_SURPRISE
from tools.diagnosis.places import Place, places, rests_on
from tools.perceive import PerceiveArgs, perceive

FELL = 0.05
"""A thing seen with its base at most this much higher than before is on the table, not in the hand [m]."""


def carries(sensed: Sensing) -> bool:
    """Whether fingers and wrist say at the end of the motion that something is held."""
    return sensed.stopped_by is None and sensed.aperture_end >= CLOSED_EMPTY and sensed.load_end > LEAST_LOAD


def feels_alike(sensed: Sensing, other: PerceivedObject) -> bool:
    """Whether what the hand weighs and how far it is open would suit this thing as well."""
    low, high = other.mass
    return LIGHT * low <= sensed.load_end <= HEAVY * high and sensed.aperture_closed <= max(other.size) + WIDTH_SURPRISE


def worth_a_look(sensed: Sensing, percept: Percept, target: PerceivedObject, *, sure: bool) -> bool:
    """Whether to look before the hand is emptied or success is claimed.

    Args:
        sensed: Readings of the grasp.
        percept: The look before it.
        target: What was meant.
        sure: No reading speaks against a success.

    Returns:
        False where nothing is held, and where all is well and no other thing could be mistaken for the target: that
        saves a quarter of a second.
    """
    if not carries(sensed):
        return False
    others = [thing for thing in percept.objects if thing.id != target.id]
    return not sure or any(thing.category == target.category or feels_alike(sensed, thing) for thing in others)


def look_at_places(sensed: Sensing, percept: Percept, target: PerceivedObject, context: ToolContext) -> PlaceEvidence:
    """Looks which of the places where things stood are empty now.

    The front camera alone is asked first, the other one where the target's place is hidden from it. Where several places
    are empty the table is perceived anew: what was only pushed away is still to be seen.

    Args:
        sensed: Readings of the grasp.
        percept: The look before it.
        target: What was meant.
        context: Robot, perceiver and generator (camera noise).
    """
    views = tuple(context.robot.look(context.rng, ("front",)))
    found = places(percept.objects, views, sensed.lift_height)
    if found[target.id] == "unseen":
        views += tuple(context.robot.look(context.rng, ("top",)))
        found = places(percept.objects, views, sensed.lift_height)
    others = [t for t in percept.objects if t.id != target.id and not rests_on(t, target)]
    emptied = [thing for thing in others if found[thing.id] == "empty"]
    at_target = found[target.id]
    if emptied and at_target == "empty":
        seen = perceive(PerceiveArgs(look=percept.look + 1, previous=percept), context)
        at_target = _after_all(target, at_target, seen)
        emptied = [thing for thing in emptied if not _on_the_table(thing, seen)]
    return PlaceEvidence(
        target=at_target,
        emptied=tuple(thing.id for thing in emptied),
        unseen=tuple(thing.id for thing in others if found[thing.id] == "unseen"),
    )


def _after_all(target: PerceivedObject, place: Place, seen: Percept) -> Place:
    """A target that is seen beside its place was pushed, not taken."""
    return "occupied" if _on_the_table(target, seen) else place


def _on_the_table(thing: PerceivedObject, seen: Percept) -> bool:
    """Whether a thing is seen again, and not up in the hand."""
    return any(found.id == thing.id and found.base_z < thing.base_z + FELL for found in seen.objects)
