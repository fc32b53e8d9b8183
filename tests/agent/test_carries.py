"""What would not stay where it is to be put is refused before anything moves; only what is in the hand is let go of."""

from __future__ import annotations

import pytest

from agent.carries import why_not
from agent.conversation import checked
from agent.goal import Placement, RelationWord
from agent.ground import ground_goals
from agent.language.read_command import understand
from agent.possible import EMPTY_HAND
from agent.state import State
from kb.errors import BadInputError
from kb.percept import Part, PerceivedObject, Percept
from tests.percept_fixtures import thing


def rim(radius: float, wall: float = 0.003) -> Part:
    """A rim as perception reports one."""
    return Part(
        region="rim", centre=(0.5, 0.0, 0.1), axis=(0.0, 0.0, 1.0), width=wall, length=6.28 * radius, radius=radius
    )


TABLE = (
    thing("obj_0", "cup", 0.50, -0.20, parts=(rim(0.038),)),
    thing("obj_1", "vase", 0.50, 0.20, parts=(rim(0.030),)),
    thing("obj_2", "bowl", 0.40, 0.00, parts=(rim(0.058),)),
    thing("obj_3", "apple", 0.62, 0.05),
    thing("obj_4", "box", 0.60, -0.10),
    thing("obj_5", "key", 0.45, 0.30),
    thing("obj_6", "bottle", 0.55, 0.35),
)
BY_NAME = {obj.category: obj for obj in TABLE}


@pytest.mark.parametrize(
    ("what", "relation", "below", "stays"),
    [
        ("cup", "in", "vase", False),
        ("cup", "on", "vase", False),
        ("key", "in", "vase", False),
        ("apple", "on", "bottle", False),
        ("cup", "on", "apple", False),
        ("cup", "in", "box", False),
        ("cup", "on", "box", True),
        ("apple", "in", "bowl", True),
        ("cup", "in", "bowl", True),
        ("box", "in", "cup", False),
        ("key", "in", "cup", True),
    ],
)
def test_only_what_would_stay_is_put_there(what: str, relation: RelationWord, below: str, stays: bool) -> None:
    """By the opening as measured: a cup fits no vase, nothing stands on a ball, the bowl takes what fits."""
    problem = why_not(BY_NAME[what], Placement(kind="on", relation=relation), BY_NAME[below])
    assert (problem is None) == stays


def grounded(said: str, *objects: PerceivedObject) -> str | None:
    """The refusal of an instruction over the usual table, or None if it begins."""
    got = understand(said)
    assert got.goals, (got.refusal, got.question)
    state = State(
        instruction=said,
        goals=got.goals,
        agenda=(0,),
        percept=Percept(look=0, perception="rgbd", objects=objects or TABLE),
        last_target="obj_0",
    )
    update = ground_goals(state).update
    return update.get("answer") if update.get("refused") else None


@pytest.mark.parametrize(
    "said", ["put the cup into the vase", "pick up the apple and put it into the vase", "put the cup on the bottle"]
)
def test_what_would_fall_is_refused_before_anything_moves(said: str) -> None:
    """Also where an earlier part of the instruction could be done; the refusal names what is in the way."""
    answer = grounded(said)
    assert answer is not None
    assert "vase" in answer or "bottle" in answer


@pytest.mark.parametrize(
    "said", ["put the apple into the bowl", "put the cup on the box", "put the apple next to the vase"]
)
def test_what_stays_is_begun(said: str) -> None:
    """Bowls, boxes and places beside a thing are what they were."""
    assert grounded(said) is None


@pytest.mark.parametrize("said", ["drop it", "let go", "put it down", "set it down", "release it", "release the cup"])
def test_an_empty_hand_lets_go_of_nothing(said: str) -> None:
    """With nothing in the hand it is said, and what was spoken of last is not taken up."""
    assert grounded(said) == EMPTY_HAND


def test_what_is_picked_first_can_be_put_down_after() -> None:
    """In "pick up the cup and put it down" the hand is not empty when it comes to that; "put it in the bin" is a task."""
    assert grounded("pick up the cup and put it down") is None
    assert grounded("pick up the cup and drop it") is None
    assert grounded("move the cup aside") is None


@pytest.mark.parametrize(
    "said",
    ["move the cup 5 cm to the right", "move the cup two centimetres left", "put the cup 10 cm left of the vase"],
)
def test_a_length_is_no_name(said: str) -> None:
    """Moving by a length is declined with what is possible; "cup 5 cm" is nothing that is looked for."""
    assert "by a length" in (understand(said).refusal or "")


def test_the_table_is_no_part_of_a_name() -> None:
    """Everything is taken off the table: a thing of no known kind is called as it was said without it."""
    reference = understand("pick up the plush off the table").goals[0].reference
    assert reference is not None
    assert reference.words == "the plush"


@pytest.mark.parametrize("said", ["", " ", "\u200b\u200d", "\ufeff \u2060", None])
def test_what_cannot_be_seen_is_no_instruction(said: str | None) -> None:
    """Characters without width are as empty as none, and None is bad input, too."""
    with pytest.raises(BadInputError):
        checked(said)  # pyright: ignore[reportArgumentType]
