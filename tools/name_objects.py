"""Name objects: join what a model calls the marks in a picture with what depth has measured there (ledger G7, G45).

The model names, depth measures: position, size, shape and parts stay as measured. A name must be plausible for what was
measured, a relation must hold in the measured geometry; what contradicts is dropped and counted. Where both know how
careful one must be (fragility, contents), the more careful word counts.
"""

from __future__ import annotations

from pydantic import Field

from kb.affordance import AffordanceDescriptor
from kb.base import Noun
from kb.percept import PerceivedObject, Percept
from kb.priors import prior
from kb.seen import NamedObject, SaidRelation, Seen
from kb.vocabulary import UNKNOWN_CATEGORY, Region
from tools.build_scene_graph import SceneGraphArgs, build_scene_graph
from tools.context import ToolContext

NAME_FACTOR = 20.0
"""How much more probable a category becomes because the model names it: a model that is right nineteen times in twenty."""
FLOOR = 0.002
"""Probability that a category has at least, however the measured statistics see it: they are no proof."""


class NameArgs(Noun):
    """Arguments of `name_objects`."""

    percept: Percept
    seen: Seen


class NamedPercept(Noun):
    """The percept with the names that count."""

    percept: Percept
    relations: tuple[SaidRelation, ...] = ()
    """Relations that the model said and the geometry confirms."""
    dropped: tuple[str, ...] = Field(default=())
    """What was said and contradicts what was measured, one sentence each."""


def name_objects(args: NameArgs, context: ToolContext) -> NamedPercept:
    """The percept with a model's names joined to the measured objects.

    Args:
        args: The measured percept, and what the model said about its marks.
        context: Passed on to the scene graph, which checks the relations.

    Returns:
        The percept, labelled "vlm", and what was dropped because measuring contradicts it.
    """
    said = {item.id: item for item in args.seen.objects}
    dropped: list[str] = []
    objects: list[PerceivedObject] = []
    for thing in args.percept.objects:
        name = said.get(thing.id)
        joined = thing if name is None else _joined(thing, name)
        if name is not None and name.category not in (joined.category, UNKNOWN_CATEGORY):
            dropped.append(f"{thing.id} was called {name.category}, and is measured as {thing.category}")
        objects.append(joined)
    percept = args.percept.model_copy(update={"objects": tuple(objects), "perception": "vlm"})
    graph = build_scene_graph(SceneGraphArgs(percept=percept, target=None), context)
    held = {(edge.source, edge.relation, edge.target) for edge in graph.edges}
    kept = tuple(r for r in args.seen.relations if (r.source, r.relation, r.target) in held)
    dropped += [f"{r.source} {r.relation} {r.target} does not hold" for r in args.seen.relations if r not in kept]
    return NamedPercept(percept=percept, relations=kept, dropped=tuple(dropped))


def _joined(thing: PerceivedObject, said: NamedObject) -> PerceivedObject:
    """The object under the most probable name, with the more careful of both words on fragility and contents."""
    posterior = joined_posterior(thing, said.category)
    category = max(posterior, key=lambda name: (posterior[name], name == thing.category))
    expected = prior(category)
    fragility = max(thing.affordance.fragility, expected.affordance.fragility)
    affordance = thing.affordance if category == thing.category else expected.affordance
    if category == UNKNOWN_CATEGORY:
        fragility = max(thing.affordance.fragility, said.fragility)
        affordance = AffordanceDescriptor(
            type=said.affordance, material=said.material, fragility=fragility, region=_region(thing, said)
        )
    filled = said.state == "filled" and expected.container and thing.state == "empty"
    changed = category != thing.category
    return thing.model_copy(
        update={
            "category": category,
            "confidence": posterior[category],
            "posterior": posterior,
            "affordance": affordance.model_copy(update={"fragility": fragility}),
            "state": "filled" if filled else thing.state,
            "mass": expected.mass if changed and category != UNKNOWN_CATEGORY else thing.mass,
            "friction": expected.friction if changed and category != UNKNOWN_CATEGORY else thing.friction,
        }
    )


def joined_posterior(thing: PerceivedObject, named: str) -> dict[str, float]:
    """Probability per category after the model has spoken; sums to 1.

    A model that says "unknown" has no name for it, which says nothing against the measured ones.
    """
    measured = dict(thing.posterior) or {thing.category: 1.0}
    if named != UNKNOWN_CATEGORY:
        measured[named] = max(measured.get(named, 0.0), FLOOR) * NAME_FACTOR
    total = sum(measured.values())
    return {name: share / total for name, share in measured.items()}


def _region(thing: PerceivedObject, said: NamedObject) -> Region:
    """The region that the model means, if it was seen there at all."""
    return said.region if thing.part(said.region) is not None else thing.affordance.region
