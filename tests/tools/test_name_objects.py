"""The model names, depth measures: what the join keeps of either, and what it drops."""

from __future__ import annotations

from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from kb.percept import PerceivedObject, Percept
from kb.priors import prior
from kb.seen import NamedObject, SaidRelation, Seen
from kb.taxonomy import CATEGORIES
from kb.vocabulary import UNKNOWN_CATEGORY
from tests.percept_fixtures import percept, thing
from tests.planning_fixtures import context
from tools.name_objects import NameArgs, NamedPercept, joined_posterior, name_objects


def named(object_id: str, category: str, **changes: Any) -> NamedObject:
    """A name with harmless details."""
    fields = {"affordance": "GRASPABLE_BODY", "material": "plastic", "fragility": 0.0, "region": "body"}
    return NamedObject.model_validate({"id": object_id, "category": category} | fields | changes)


def join(seen: Percept, *objects: NamedObject, relations: tuple[SaidRelation, ...] = ()) -> NamedPercept:
    """The percept with these names."""
    return name_objects(NameArgs(percept=seen, seen=Seen(objects=objects, relations=relations)), context())


def unsure(category: str, **posterior: float) -> PerceivedObject:
    """An object that measuring is not sure about."""
    return thing("obj_0", category, 0.5, 0.0, posterior=posterior, confidence=max(posterior.values()))


@given(
    category=st.sampled_from([*CATEGORIES, UNKNOWN_CATEGORY]),
    said=st.sampled_from([*CATEGORIES, UNKNOWN_CATEGORY]),
    sure=st.floats(0.3, 1.0),
    fragility=st.floats(0.0, 1.0),
)
def test_names_never_make_less_careful_and_never_move_anything(
    category: str, said: str, sure: float, fragility: float
) -> None:
    """Position, size, shape and surface stay as measured; fragility never falls; probabilities sum to 1."""
    before = thing("obj_0", "cup", 0.5, 0.0).model_copy(
        update={
            "category": category, "confidence": sure, "posterior": {category: sure, "cup": 1 - sure},
            "affordance": prior(category).affordance,
        }
    )  # fmt: skip
    after = join(percept(before), named("obj_0", said, fragility=fragility)).percept.objects[0]
    for field in ("id", "position", "yaw", "size", "shape", "surface", "parts", "visible_fraction"):
        assert getattr(after, field) == getattr(before, field)
    assert after.affordance.fragility >= before.affordance.fragility
    assert abs(sum(joined_posterior(before, said).values()) - 1.0) < 1e-9


def test_a_plausible_name_settles_and_an_implausible_one_is_dropped_and_counted() -> None:
    """Where measuring wavers the model decides; what is surely a wine glass is not made a cube."""
    wavering = join(percept(unsure("cup", cup=0.5, mug=0.45, bowl=0.05)), named("obj_0", "mug"))
    assert (wavering.percept.objects[0].category, wavering.dropped) == ("mug", ())
    sure = join(percept(unsure("wine_glass", wine_glass=0.98, vase=0.02)), named("obj_0", "cube"))
    assert sure.percept.objects[0].category == "wine_glass"
    assert sure.dropped == ("obj_0 was called cube, and is measured as wine_glass",)
    assert sure.percept.perception == "vlm"


def test_contents_count_if_either_sees_them() -> None:
    """A cup that the model sees filled is carried as filled; a block cannot be filled; nobody empties a measured filling."""
    cup = thing("obj_0", "cup", 0.5, 0.0, posterior={"cup": 1.0})
    block = thing("obj_0", "block", 0.5, 0.0, posterior={"block": 1.0})
    assert join(percept(cup), named("obj_0", "cup", state="filled")).percept.objects[0].state == "filled"
    assert join(percept(block), named("obj_0", "block", state="filled")).percept.objects[0].state == "empty"
    full = cup.model_copy(update={"state": "filled"})
    assert join(percept(full), named("obj_0", "cup", state="empty")).percept.objects[0].state == "filled"


def test_relations_are_checked_against_the_geometry() -> None:
    """What stands beside is kept, what would have to float is dropped and counted."""
    seen = percept(thing("obj_0", "cup", 0.5, 0.0), thing("obj_1", "cube", 0.58, 0.0))
    beside = SaidRelation(source="obj_0", relation="ADJACENT_TO", target="obj_1")
    above = SaidRelation(source="obj_1", relation="ON_TOP_OF", target="obj_0")
    got = join(seen, relations=(beside, above))
    assert got.relations == (beside,)
    assert got.dropped == ("obj_1 ON_TOP_OF obj_0 does not hold",)
