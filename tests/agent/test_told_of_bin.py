"""What the robot says of things that its cameras cannot see: those in the bin, and what was moved before the last question."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from agent.chat import Conversation
from agent.goal import Goal
from agent.language.read_command import understand
from agent.told_of_bin import binned, contents, means_bin, not_back
from tests.planning_fixtures import percept, solid

CUBE, APPLE = solid("c", "cube", 0.5, 0.1), solid("a", "apple", 0.5, -0.1)
SEEN = percept(APPLE).model_copy(update={"bin": ((0.2, -0.7, 0.0), (0.5, -0.4, 0.15))})


def goal(words: str) -> Goal:
    """What the words ask for."""
    return understand(words).goals[0]


def last(turn: Iterator[Any]) -> str:
    """The last word of a turn."""
    return {event.kind: event for event in turn}["finished"].result.answer


def test_what_is_in_the_bin_is_told_from_memory() -> None:
    """Nothing is claimed of what cannot be seen: what was put there, that nothing was, or that there is no bin."""
    for words in ("what is in the bin?", "is the bin empty?", "is anything in the bin?"):
        assert means_bin(goal(words).reference), words
    assert not means_bin(goal("what is next to the cup?").reference)
    assert contents((CUBE,), SEEN).endswith("cube into the bin; I cannot look into it.")
    assert "put nothing into the bin" in contents((), SEEN)
    assert contents((), percept(APPLE)) == "I see no bin here."


def test_what_was_put_into_the_bin_is_not_just_absent() -> None:
    """Asked for again, it is said where it went; what was never there is left to the look."""
    assert binned(goal("pick up the cube").reference, (CUBE,)) is not None
    assert binned(goal("where is the cup?").reference, (CUBE,)) is None
    assert "is in the bin" in (not_back(goal("undo"), "c", (CUBE,)) or "")
    assert not_back(goal("undo"), "a", (CUBE,)) is None
    assert not_back(goal("put it on the left"), "c", (CUBE,)) is None


def test_undo_is_about_what_was_moved_whatever_was_asked_since() -> None:
    """A question about another thing changes what "it" is, but not what "undo" puts back."""
    with Conversation.open("clear_table", 10_003, perception="oracle", evaluator="analytic") as talk:
        last(talk.say("put the cube on the left"))
        last(talk.say("is the apple heavy?"))
        assert last(talk.undo()) == "I put the cube back where it was."


@pytest.mark.parametrize(
    "words", ["take the cube out of the bin", "get the apple from the bin", "take everything out of the bin", "empty the bin"]
)  # fmt: skip
def test_nothing_is_taken_out_of_the_bin(words: str) -> None:
    """It would be blind: the walls hide what lies there."""
    assert "out of the bin" in (understand(words).refusal or "")
