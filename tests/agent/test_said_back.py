"""How the robot says back what it was told, and that fewer things than were asked for are no success."""

from collections.abc import Iterator
from typing import Any

import pytest

from agent import build_agent
from agent.chat import Conversation
from agent.goal import Goal, Reference
from agent.language.describe import spoken
from agent.language.read_command import understand
from agent.phrases import goal_words, object_name
from kb.errors import BadInputError


@pytest.mark.parametrize(
    ("words", "back"),
    [
        ("red cup", "the red cup"),
        ("the red cup", "the red cup"),
        ("a red cup", "the red cup"),
        ("that cup", "that cup"),
        ("both cups", "both cups"),
        ("2 cups", "2 cups"),
        ("everything", "everything"),
    ],
)
def test_one_article_at_most(words: str, back: str) -> None:
    """The article is put before a bare noun alone, never before another word that stands in its place."""
    assert spoken(Reference(words=words, noun="cup")) == back


def test_a_pronoun_stands_inside_the_verb() -> None:
    """One says "pick it up" and "pick up the cup"."""
    it = Reference(words="it", pronoun=True)
    assert goal_words(Goal(kind="pick", reference=it)) == "pick it up"
    assert goal_words(Goal(kind="pick", reference=Reference(words="cup", noun="cup"))) == "pick up the cup"


def test_what_has_no_known_kind_is_an_object() -> None:
    """The category "unknown" is no name of a thing."""
    assert object_name("unknown") == "unknown object"
    assert object_name("wine_glass") == "wine glass"


def test_two_are_not_one() -> None:
    """Where two cups are asked for and there is one, nothing moves and the answer says what there is."""
    agent = build_agent("single_cup", 10_003, evaluator="analytic", perception="oracle")
    result = agent.run("pick up both cups")
    assert not result.success
    assert not result.executed
    assert result.answer.startswith("I see only one: the ")


def last(turn: Iterator[Any]) -> str:
    """The last word of a turn."""
    return {event.kind: event for event in turn}["finished"].result.answer


def test_several_things_are_one_after_the_other_for_one_hand() -> None:
    """For "pick up everything", "all of them" and "both" it asks which one first; the bare thing answers; three aren't both."""
    with Conversation.open("cup_near_vase", 10_003, perception="oracle", evaluator="analytic") as talk:
        for words in ("pick up everything", "pick up all of them", "take both"):
            asked = last(talk.say(words))
            assert "only one thing at a time. Which one first" in asked, words
            assert "the everything" not in asked
            assert "sort by size" in asked
        assert last(talk.say("the cup")) == "I hold the cup."
        assert "or the cup in my hand" in last(talk.say("put both on the left"))
    with Conversation.open("clear_table", 10_003, perception="oracle", evaluator="analytic") as talk:
        assert "more than two things" in last(talk.say("take both"))
        assert "put everything in the bin" in last(talk.say("pick up everything"))


@pytest.mark.parametrize(
    ("words", "part"),
    [
        ("drop it from 30 cm", "I do not let things fall"), ("drop the cup from a height of 30 cm", "put it back"),
        ("let it fall", "set them down gently"), ("lift it higher", "one height"), ("raise the cup by 10 cm", "one height"),
        ("hold it 20 cm above the table", "one height"),
    ],
)  # fmt: skip
def test_heights_are_declined_with_what_can_be_done(words: str, part: str) -> None:
    """Nothing is dropped or lifted to a height that was asked; what can be done instead is said."""
    assert part in (understand(words).refusal or "")


def test_sizes_and_places_are_no_heights() -> None:
    """A cube of 5 cm and the lower of two blocks are things to be taken, and "drop it" sets down."""
    for words in ("pick up the 5 cm cube", "take the lower block", "drop it", "lower it", "raise it"):
        assert understand(words).goals, words


def test_a_negative_seed_is_bad_input() -> None:
    """The Python interface refuses it by name, as the command line does."""
    with pytest.raises(BadInputError, match="seed"):
        build_agent("single_cup", -1)
