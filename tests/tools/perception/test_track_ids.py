"""Ids stay with their objects over looks."""

from __future__ import annotations

from kb.affordance import AffordanceDescriptor
from kb.percept import PerceivedObject, Percept
from tools.perception.track_ids import track_ids

AFFORDANCE = AffordanceDescriptor(type="GRASPABLE_BODY", material="wood", fragility=0.0, region="body")


def _thing(x: float, y: float, category: str = "cube", side: float = 0.05, red: float = 0.5) -> PerceivedObject:
    return PerceivedObject(
        id="obj_0",
        category=category,
        confidence=1.0,
        position=(x, y, side / 2),
        yaw=0.0,
        size=(side, side, side),
        shape="box",
        affordance=AFFORDANCE,
        colour=(red, 0.2, 0.2),
    )


def _look(things: list[PerceivedObject], previous: Percept | None = None) -> Percept:
    number = 0 if previous is None else previous.look + 1
    return Percept(look=number, perception="rgbd", objects=track_ids(things, previous))


def test_first_ids_read_from_front_left_to_back_right() -> None:
    """New objects are numbered row by row from the front, each row from the left."""
    percept = _look([_thing(0.4, 0.0), _thing(0.7, -0.2), _thing(0.7, 0.2)])
    assert [obj.position[:2] for obj in percept.objects] == [(0.7, 0.2), (0.7, -0.2), (0.4, 0.0)]
    assert [obj.id for obj in percept.objects] == ["obj_0", "obj_1", "obj_2"]


def test_the_order_of_detection_does_not_matter() -> None:
    """Reversing the list of what was seen gives the same ids."""
    things = [_thing(0.4, 0.0), _thing(0.7, -0.2), _thing(0.55, 0.2)]
    forward, backward = track_ids(things, None), track_ids(things[::-1], None)
    assert forward == backward


def test_a_pushed_object_keeps_its_id_and_a_new_one_gets_a_fresh_one() -> None:
    """After a push of 4 cm, a removal and an arrival, ids follow the objects and none is given away again."""
    before = _look([_thing(0.7, 0.2), _thing(0.7, -0.2, "apple", 0.08, 0.9), _thing(0.4, 0.0)])
    after = _look([_thing(0.66, -0.2, "apple", 0.08, 0.9), _thing(0.4, 0.0), _thing(0.4, 0.3, "block", 0.04)], before)
    assert after.object("obj_1").category == "apple"
    assert after.object("obj_2").position[:2] == (0.4, 0.0)
    assert after.object("obj_3").category == "block"
    assert {obj.id for obj in after.objects} == {"obj_1", "obj_2", "obj_3"}


def test_swapped_likes_are_told_apart_by_size_and_colour() -> None:
    """A red small and a dark large cube that changed places keep their ids."""
    before = _look([_thing(0.5, 0.05, side=0.03, red=0.9), _thing(0.5, -0.05, side=0.07, red=0.1)])
    after = _look([_thing(0.5, -0.05, side=0.03, red=0.9), _thing(0.5, 0.05, side=0.07, red=0.1)], before)
    for obj in before.objects:
        assert after.object(obj.id).size == obj.size
