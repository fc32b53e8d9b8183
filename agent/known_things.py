"""What the agent knows about things where a look alone cannot tell: from having moved them, or because it was told."""

from __future__ import annotations

from agent.attempt import Held, Moved
from agent.goal import Reference
from kb.percept import PerceivedObject, Percept
from kb.taxonomy import Taxonomy
from kb.vocabulary import UNKNOWN_CATEGORY


def called(thing: PerceivedObject, reference: Reference | None, known: Taxonomy) -> str:
    """The category under which to look for experiences with a thing.

    It is what was perceived; of a thing that fits no category, it is what the person calls it, if the taxonomy has that
    name (benchmark.md section 6).
    """
    if thing.category != UNKNOWN_CATEGORY or reference is None:
        return thing.category
    said = (*((reference.noun.replace(" ", "_"),) if reference.noun else ()), *reference.categories)
    return next((name for name in said if known.superclass(name) is not None), thing.category)


def without_held(percept: Percept, held: Held | None) -> Percept:
    """The percept without the thing in the hand, which the cameras see in the air."""
    if held is None:
        return percept
    rest = tuple(obj for obj in percept.objects if obj.id != held.object.id)
    return percept.model_copy(update={"objects": rest})


def found_again(percept: Percept, before: Percept | None, moved: Moved | None) -> Percept:
    """The percept in which the thing that was put somewhere else bears its old id again.

    Ids follow things over small displacements; what the robot itself carried away appears as new. If exactly one new
    object is of its category, that is the one.
    """
    if moved is None or before is None or any(obj.id == moved.id for obj in percept.objects):
        return percept
    known = {obj.id for obj in before.objects}
    new = [obj for obj in percept.objects if obj.id not in known and obj.category == moved.category]
    if len(new) != 1:
        return percept
    objects = tuple(o.model_copy(update={"id": moved.id}) if o.id == new[0].id else o for o in percept.objects)
    return percept.model_copy(update={"objects": objects})
