"""How the robot says back what it was told, and that fewer things than were asked for are no success."""

import pytest

from agent import build_agent
from agent.goal import Goal, Reference
from agent.language.describe import spoken
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


def test_a_negative_seed_is_bad_input() -> None:
    """The Python interface refuses it by name, as the command line does."""
    with pytest.raises(BadInputError, match="seed"):
        build_agent("single_cup", -1)
