"""Laws of understanding: it never fails, never depends on case or spacing, and never moves for noise."""

from __future__ import annotations

import string

from hypothesis import given, settings
from hypothesis import strategies as st

from agent.language.read_command import understand
from agent.language.words import clean, edits, mend, vocabulary

COMMANDS = ("pick up the red cup", "put the apple in the bin", "clear the table", "where is the vase", "sort by size")


@settings(max_examples=150, deadline=None)
@given(st.text(max_size=200))
def test_any_text_gives_goals_or_a_reason(text: str) -> None:
    """Whatever is typed, there are goals, a refusal or a question, and nothing is raised."""
    got = understand(text)
    assert bool(got.goals) != bool(got.refusal or got.question)


@settings(max_examples=60, deadline=None)
@given(st.lists(st.text(alphabet="bcdfghjklmnpqrstvwxz", min_size=5, max_size=12), min_size=1, max_size=8))
def test_noise_moves_nothing(made_up: list[str]) -> None:
    """Words without vowels are no command."""
    assert not any(goal.moves for goal in understand(" ".join(made_up)).goals)


@given(st.sampled_from(COMMANDS), st.sampled_from((" ", "  ", "\t", " \n")), st.booleans())
def test_case_and_spacing_do_not_matter(command: str, space: str, upper: bool) -> None:
    """The same words mean the same goals."""
    said = command.replace(" ", space) if space != " \n" else command + space
    assert understand(said.upper() if upper else said) == understand(command)


@given(
    st.sampled_from(COMMANDS), st.sampled_from(("please {}", "could you {}?", "{}, please", "hey robot, {}", "now {}!"))
)
def test_politeness_does_not_matter(command: str, frame: str) -> None:
    """Courtesy changes nothing of what is asked."""
    assert understand(frame.format(command)).goals == understand(command).goals


@given(st.text(alphabet=string.ascii_letters + string.digits + " ,.;!?'-_/\\{}()$&|<>", max_size=120))
def test_cleaning_is_idempotent(text: str) -> None:
    """Clean text is clean."""
    assert clean(clean(text)) == clean(text)


@given(st.text(alphabet="abcde", max_size=7), st.text(alphabet="abcde", max_size=7))
def test_edit_distance_is_a_distance(a: str, b: str) -> None:
    """It is symmetric, zero only for equal words, and at most the longer length."""
    distance = edits(a, b, 20)
    assert distance == edits(b, a, 20)
    assert (distance == 0) == (a == b)
    assert distance <= max(len(a), len(b))


@given(st.sampled_from(sorted(vocabulary())))
def test_known_words_are_never_mended(word: str) -> None:
    """A word of the vocabulary stays as it is."""
    assert mend(word) == word
