"""Which of the perceived objects a reference means: one, several (to be asked), or none (to be said)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from agent.goal import Reference, RelationWord
from agent.language import lexicon
from agent.language.describe import absent, listing, spoken
from agent.language.single_out import single_out
from kb.base import Noun
from kb.percept import PerceivedObject, Percept
from kb.vocabulary import UNKNOWN_CATEGORY
from tools.scene_relations.direction import is_behind, is_left_of

POSSIBLE = 0.10
"""Posterior from which a category may be what the person calls the object by."""
NEAR = 0.20
"""Surface distance within which things are "next to" each other [m]; the nearest counts where several are."""


class Resolution(Noun):
    """What a reference means in what is seen."""

    ids: tuple[str, ...] = ()
    """Exactly one for a thing that is clear, several for an ambiguous one or a plural, none for an absent one."""
    note: str = ""
    """What should be said along ("I take the object I don't recognise to be the teapot")."""
    problem: str | None = None
    """Why nothing fits."""

    @property
    def clear(self) -> bool:
        """Exactly one object is meant."""
        return len(self.ids) == 1


@dataclass(frozen=True)
class Scope:
    """What a reference is resolved in."""

    percept: Percept
    held: PerceivedObject | None = None
    last: str | None = None
    """Perceived id of what was dealt with last."""

    @property
    def objects(self) -> tuple[PerceivedObject, ...]:
        """Everything seen, and what is held."""
        held = () if self.held is None or any(o.id == self.held.id for o in self.percept.objects) else (self.held,)
        return (*self.percept.objects, *held)


def resolve(reference: Reference, scope: Scope) -> Resolution:
    """The objects that `reference` may mean."""
    if reference.ids:
        present = tuple(i for i in reference.ids if any(o.id == i for o in scope.objects))
        return Resolution(ids=present, problem=None if present else f"I no longer see {spoken(reference)}.")
    if reference.pronoun and not reference.noun:
        return _all_of(reference, scope) or _pronoun(scope)
    if not scope.objects:
        return Resolution(problem="I see nothing on the table.")
    found, note = _by_noun(reference, scope)
    if not found:
        return Resolution(problem=absent(reference, scope.objects))
    for keep in (_colour, _material, _shape, _state, _excluding, _other):
        found = keep(reference, found, scope)
        if not found:
            return Resolution(problem=absent(reference, scope.objects))
    if reference.relation is not None:
        found, problem = _related(reference, found, scope)
        if not found:
            return Resolution(problem=problem or absent(reference, scope.objects))
    if reference.plural and reference.extreme is None and reference.ordinal is None and reference.side is None:
        return Resolution(ids=tuple(o.id for o in found), note=note)
    found = single_out(reference, found)
    if not found:
        return Resolution(problem=absent(reference, scope.objects))
    if len(found) > 1 and reference.anyone:
        found = [min(found, key=lambda o: (math.hypot(o.position[0], o.position[1]), o.id))]
    return Resolution(ids=tuple(o.id for o in found), note=note)


def _all_of(reference: Reference, scope: Scope) -> Resolution | None:
    """For "all of them", "both": everything seen and what is held; None where no such words were said."""
    both = reference.words in lexicon.BOTH_OF
    if not (both or reference.words in lexicon.ALL_OF) or len(scope.objects) < 2:
        return None
    if both and len(scope.objects) > 2:
        return Resolution(problem=f"I see more than two things: {listing(scope.objects)}. Please name the two.")
    return Resolution(ids=tuple(o.id for o in scope.objects))


def _pronoun(scope: Scope) -> Resolution:
    if scope.held is not None:
        return Resolution(ids=(scope.held.id,))
    if scope.last is not None and any(o.id == scope.last for o in scope.objects):
        return Resolution(ids=(scope.last,))
    if len(scope.objects) == 1:
        return Resolution(ids=(scope.objects[0].id,))
    if scope.last is not None:
        return Resolution(problem=f"I no longer see what you mean. I see {listing(scope.objects)}.")
    return Resolution(problem="I don't know what you mean by that: nothing was spoken of yet.")


def _by_noun(reference: Reference, scope: Scope) -> tuple[list[PerceivedObject], str]:
    """Objects whose category posterior allows the noun; else the single unknown one, with a note."""
    objects = list(scope.objects)
    if not reference.categories and reference.known:
        return objects, ""
    wanted = set(reference.categories)
    if reference.known:
        sure = [o for o in objects if o.category in wanted]
        if sure:
            return sure, ""
        maybe = [o for o in objects if sum(o.posterior.get(c, 0.0) for c in wanted) >= POSSIBLE]
        if maybe:
            best = max(maybe, key=lambda o: sum(o.posterior.get(c, 0.0) for c in wanted))
            name = best.category.replace("_", " ")
            if best.category == UNKNOWN_CATEGORY:
                return maybe, "" if len(
                    maybe
                ) > 1 else f"I am not sure what it is, but it may be {_article(reference)}."
            return maybe, "" if len(
                maybe
            ) > 1 else f"It looks more like a {name} to me, but it may be {_article(reference)}."
        loose = set(lexicon.LOOSE.get(reference.noun or "", ()))
        akin = [o for o in objects if o.category in loose]
        if akin:
            return akin, f"I take the {akin[0].category.replace('_', ' ')} to be what you mean by {spoken(reference)}."
    unknown = [o for o in objects if o.category == UNKNOWN_CATEGORY]
    if len(unknown) == 1:
        return unknown, f"I don't recognise one object; I take it to be {spoken(reference)}."
    return unknown, ""


def _article(reference: Reference) -> str:
    noun = reference.noun or "one"
    return ("an " if noun[0] in "aeiou" else "a ") + noun


def _colour(reference: Reference, found: list[PerceivedObject], scope: Scope) -> list[PerceivedObject]:
    del scope
    if reference.colour is None:
        return found
    for name in (names := lexicon.COLOURS[reference.colour]):
        exact = [o for o in found if o.colour_name == name]
        if exact and (name == names[0] or _neighbouring(exact, reference.colour)):
            return exact
    return []


_HUES = {
    "red": (1.0, 0.0, 0.0), "orange": (1.0, 0.55, 0.1), "yellow": (1.0, 0.9, 0.1), "green": (0.2, 0.7, 0.2),
    "turquoise": (0.2, 0.8, 0.75), "blue": (0.15, 0.3, 0.9), "purple": (0.55, 0.2, 0.75), "pink": (1.0, 0.5, 0.7),
    "brown": (0.5, 0.32, 0.18), "white": (0.95, 0.95, 0.95), "grey": (0.5, 0.5, 0.5), "black": (0.05, 0.05, 0.05),
}  # fmt: skip
NEIGHBOURING = 0.45
"""Distance in colour (RGB in [0, 1]) up to which a neighbouring colour name passes for the one that was said."""


def _neighbouring(found: list[PerceivedObject], said: str) -> bool:
    """Whether the measured colour is so near the said one that another name is a matter of taste."""
    ideal = _HUES.get(lexicon.COLOURS[said][0])
    return ideal is not None and any(math.dist(o.colour, ideal) < NEIGHBOURING for o in found)


def _material(reference: Reference, found: list[PerceivedObject], scope: Scope) -> list[PerceivedObject]:
    """Material is a guess of perception: it chooses between things, but a single thing called by its name passes."""
    del scope
    if reference.material is None:
        return found
    made = [
        o
        for o in found
        if o.affordance.material == reference.material or (reference.material == "glass" and o.transparent)
    ]
    named = bool(reference.categories)
    return made or (found if named and len(found) == 1 else [])


def _shape(reference: Reference, found: list[PerceivedObject], scope: Scope) -> list[PerceivedObject]:
    """Shape chooses between things; a single thing called by its name passes, for its name says more."""
    del scope
    if reference.shape is None:
        return found
    fits = [o for o in found if o.shape in lexicon.SHAPES[reference.shape]]
    return fits or (found if reference.categories and len(found) == 1 else [])


def _state(reference: Reference, found: list[PerceivedObject], scope: Scope) -> list[PerceivedObject]:
    del scope
    if reference.state is None:
        return found
    fits = [o for o in found if (o.state == "filled") == (reference.state == "filled")]
    return fits or (found if len(found) == 1 and reference.categories else [])


def _excluding(reference: Reference, found: list[PerceivedObject], scope: Scope) -> list[PerceivedObject]:
    for refused in reference.excluding:
        pool = Scope(percept=scope.percept.model_copy(update={"objects": tuple(found)}), last=scope.last)
        # What it stands near or on may be anything seen; a superlative is meant among those that fit.
        seen = pool if refused.relation is None else scope
        out = set(resolve(refused.model_copy(update={"plural": True}), seen).ids)
        found = [o for o in found if o.id not in out]
    return found


def _other(reference: Reference, found: list[PerceivedObject], scope: Scope) -> list[PerceivedObject]:
    if not reference.other or scope.last is None:
        return found
    return [o for o in found if o.id != scope.last and (scope.held is None or o.id != scope.held.id)]


def surface_gap(a: PerceivedObject, b: PerceivedObject) -> float:
    """Horizontal distance between the footprints' circles [m]."""
    apart = math.hypot(a.position[0] - b.position[0], a.position[1] - b.position[1])
    return max(0.0, apart - (a.size[0] + a.size[1]) / 4 - (b.size[0] + b.size[1]) / 4)


def _related(
    reference: Reference, found: list[PerceivedObject], scope: Scope
) -> tuple[list[PerceivedObject], str | None]:
    assert reference.relation is not None
    relation = reference.relation.relation
    anchors: list[PerceivedObject] = []
    by_id = {o.id: o for o in scope.objects}
    for other in reference.relation.others:
        got = resolve(other, scope)
        if not got.ids:
            return [], got.problem
        anchors += [by_id[i] for i in got.ids]
    rest = [o for o in found if all(o.id != a.id for a in anchors)]
    if relation == "between" and len(anchors) >= 2:
        return [o for o in rest if _between(o, anchors[0], anchors[1])], None
    holds = _HOLDS[relation]
    best: list[PerceivedObject] = []
    for anchor in anchors:
        fits = [o for o in rest if holds(o, anchor)]
        best += [o for o in fits if o not in best]
    if relation in ("near", "nearest_to") and len(best) > 1 and not reference.plural:
        nearest = min(best, key=lambda o: min(surface_gap(o, a) for a in anchors))
        return [nearest], None
    return best, None


_HOLDS: dict[RelationWord, Callable[[PerceivedObject, PerceivedObject], bool]] = {
    "near": lambda o, a: surface_gap(o, a) <= NEAR,
    "nearest_to": lambda o, a: True,
    "touching": lambda o, a: surface_gap(o, a) <= 0.015,
    "left_of": lambda o, a: is_left_of(o.position, a.position),
    "right_of": lambda o, a: is_left_of(a.position, o.position),
    "behind": lambda o, a: is_behind(o.position, a.position) and surface_gap(o, a) <= 2 * NEAR,
    "in_front_of": lambda o, a: is_behind(a.position, o.position) and surface_gap(o, a) <= 2 * NEAR,
    "on": lambda o, a: o.base_z > a.base_z + 0.005 and surface_gap(o, a) <= 0.02,
    "under": lambda o, a: o.base_z < a.base_z - 0.005 and surface_gap(o, a) <= 0.02,
    "in": lambda o, a: surface_gap(o, a) <= 0.0 and o.size[0] * o.size[1] < a.size[0] * a.size[1],
    "between": lambda o, a: surface_gap(o, a) <= NEAR,
}
"""Whether an object stands in a relation to an anchor, in the words of the person at the front camera (kb.viewpoint)."""


def _between(o: PerceivedObject, a: PerceivedObject, b: PerceivedObject) -> bool:
    ax, ay, bx, by = a.position[0], a.position[1], b.position[0], b.position[1]
    length = (bx - ax) ** 2 + (by - ay) ** 2
    if length < 1e-6:
        return False
    t = ((o.position[0] - ax) * (bx - ax) + (o.position[1] - ay) * (by - ay)) / length
    off = math.hypot(o.position[0] - ax - t * (bx - ax), o.position[1] - ay - t * (by - ay))
    return 0.1 < t < 0.9 and off < 0.10
