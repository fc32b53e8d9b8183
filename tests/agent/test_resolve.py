"""References against what is seen: who is meant, who is asked about, who is absent."""

from __future__ import annotations

import pytest

from agent.goal import Reference
from agent.language.read_reference import read_reference
from agent.language.resolve import Resolution, Scope, resolve
from agent.language.words import words
from kb.percept import PerceivedObject, Percept
from tests.percept_fixtures import thing

TABLE = (
    thing("obj_0", "cup", 0.50, -0.20, colour_name="red", colour=(0.9, 0.1, 0.1)),
    thing("obj_1", "cup", 0.50, 0.20, colour_name="blue", colour=(0.1, 0.2, 0.9)),
    thing("obj_2", "vase", 0.50, 0.30, colour_name="white", colour=(0.9, 0.9, 0.9)),
    thing("obj_3", "bottle", 0.42, 0.00, colour_name="green", colour=(0.2, 0.7, 0.2)),
    thing("obj_4", "apple", 0.62, 0.05, colour_name="red", colour=(0.8, 0.2, 0.1)),
)


def meant(said: str, *objects: PerceivedObject, last: str | None = None) -> Resolution:
    """What a phrase means among objects (default: the usual table)."""
    reference = Reference(**read_reference(words(said)).found)
    return resolve(reference, Scope(percept=Percept(look=0, perception="rgbd", objects=objects or TABLE), last=last))


@pytest.mark.parametrize(
    ("said", "ids"),
    [
        ("the red cup", ("obj_0",)),
        ("the vase", ("obj_2",)),
        ("the cup next to the vase", ("obj_1",)),
        ("the cup on the left", ("obj_0",)),
        ("the rightmost cup", ("obj_1",)),
        ("the second cup from the right", ("obj_0",)),
        ("the tallest thing", ("obj_3",)),
        ("the most fragile object", ("obj_2",)),
        ("the cup that is not red", ("obj_1",)),
        ("the glass thing", ("obj_2",)),
        ("the fruit", ("obj_4",)),
        ("the object left of the bottle", ("obj_0",)),
        ("the thing in front of the bottle", ("obj_4",)),
        ("a cup", ("obj_0",)),
        ("obj_3", ("obj_3",)),
        ("the mug", ("obj_0", "obj_1")),
        ("the cup", ("obj_0", "obj_1")),
        ("everything except the cups", ("obj_2", "obj_3", "obj_4")),
    ],
)
def test_phrases_mean(said: str, ids: tuple[str, ...]) -> None:
    """A phrase that singles one thing out gives that one; an ambiguous or plural one all that fit."""
    got = meant(said)
    assert set(got.ids) == set(ids) or (said == "a cup" and len(got.ids) == 1)


@pytest.mark.parametrize(
    "said", ["the teapot", "the green cup", "the banana", "the cup behind the vase", "the third cup"]
)
def test_the_absent_is_said_with_what_is_there(said: str) -> None:
    """What does not fit is named, and what is seen instead is listed."""
    got = meant(said)
    assert got.ids == ()
    assert "I see" in (got.problem or "")
    assert "vase" in (got.problem or "")


def test_an_unknown_object_is_taken_at_the_persons_word() -> None:
    """A noun that nothing fits means the single unknown object, and the answer says so; two unknown ones are not guessed."""
    odd = thing("obj_5", "cup", 0.6, -0.1).model_copy(update={"category": "unknown", "posterior": {"unknown": 0.9}})
    got = meant("the teapot", *TABLE, odd)
    assert got.ids == ("obj_5",)
    assert "don't recognise" in got.note
    other = odd.model_copy(update={"id": "obj_6", "position": (0.4, -0.1, 0.045)})
    assert len(meant("the teapot", *TABLE, odd, other).ids) == 2


def test_a_noun_fits_what_its_posterior_allows() -> None:
    """An object that is a cup with 30 % is what "the cup" means where nothing is more of a cup."""
    doubtful = thing("obj_7", "bowl", 0.5, 0.0).model_copy(update={"posterior": {"bowl": 0.65, "cup": 0.35}})
    got = meant("the cup", doubtful, TABLE[2])
    assert got.ids == ("obj_7",)
    assert "bowl" in got.note


def test_pronouns_and_the_other_one() -> None:
    """The pronoun "it" is what was dealt with last, "the other cup" is not."""
    assert meant("it", last="obj_1").ids == ("obj_1",)
    assert meant("the other cup", last="obj_1").ids == ("obj_0",)
    assert meant("it").ids == ()
