"""Names for the objects of a look: new ones from front-left to back-right, known ones keep theirs."""

from __future__ import annotations

import math

from kb.percept import PerceivedObject, Percept

REACH = 0.30
"""An object that was pushed, dropped or set down elsewhere keeps its id up to this distance [m]."""

ROW = 0.10
"""Depth of the rows in which new objects are counted [m]."""


def track_ids(seen: list[PerceivedObject], previous: Percept | None) -> tuple[PerceivedObject, ...]:
    """Gives each object its id, and returns them ordered by id.

    Objects of the look before are matched by distance, size, category and colour, cheapest pair first. Ids of objects
    that are gone are not given away again within the next look; a new object gets a fresh number.
    """
    old = previous.objects if previous is not None else ()
    pairs = sorted(
        (cost, i, j) for i, new in enumerate(seen) for j, known in enumerate(old) if (cost := _cost(new, known)) < 1.0
    )
    ids: dict[int, str] = {}
    taken: set[int] = set()
    for _, i, j in pairs:
        if i not in ids and j not in taken:
            ids[i] = old[j].id
            taken.add(j)
    fresh = 1 + max((int(known.id.removeprefix("obj_")) for known in old), default=-1)
    for i in sorted((i for i in range(len(seen)) if i not in ids), key=lambda i: _reading_order(seen[i])):
        ids[i] = f"obj_{fresh}"
        fresh += 1
    named = [obj.model_copy(update={"id": ids[i]}) for i, obj in enumerate(seen)]
    return tuple(sorted(named, key=lambda obj: int(obj.id.removeprefix("obj_"))))


def _reading_order(obj: PerceivedObject) -> tuple[int, float]:
    """Front row first (the front camera looks back at the robot, so front is large x), then from left to right."""
    return (-round(obj.position[0] / ROW), -obj.position[1])


def _cost(new: PerceivedObject, known: PerceivedObject) -> float:
    """Dissimilarity of two sightings; >= 1 means they cannot be the same object."""
    distance = math.dist(new.position, known.position)
    return 1.0 if distance > REACH else distance / REACH * 0.5 + unlike(new, known)


def unlike(new: PerceivedObject, known: PerceivedObject) -> float:
    """How different two sightings look, wherever they are: 0 for the same size, category and colour; about 1 at most."""
    size = (
        sum(
            abs(math.log(max(a, 1e-3) / max(b, 1e-3)))
            for a, b in zip(sorted(new.size), sorted(known.size), strict=True)
        )
        / 3
    )
    category = 0.0 if new.category == known.category else 0.15
    colour = math.dist(new.colour, known.colour)
    return 0.5 * min(size, 1.0) + category + 0.3 * min(colour, 1.0)
