"""How a conversation's state takes up what the nodes report."""

from __future__ import annotations

from typing import Any, get_args, get_type_hints

from agent.checkpoint import TYPES
from agent.state import State, add_times
from kb.base import Noun


def test_a_stage_that_timed_nothing_keeps_the_other_stages_seconds() -> None:
    """Seconds add up per stage, an empty report changes nothing (an early end still counts its look), None clears."""
    looked = add_times({}, {"perception": 0.25})
    assert add_times(looked, {}) == {"perception": 0.25}
    assert add_times(looked, {"perception": 0.5, "brain": 1.0}) == {"brain": 1.0, "perception": 0.75}
    assert add_times(looked, None) == {}


def nouns(hint: Any) -> set[tuple[str, str]]:
    """The types of ours that stand in a field of that kind."""
    if isinstance(hint, type) and issubclass(hint, Noun):
        return {(hint.__module__, hint.__name__)}
    return {found for part in get_args(hint) for found in nouns(part)}


def test_a_checkpoint_may_hold_all_that_stands_in_the_state() -> None:
    """A type that the serializer is not allowed to bring back would be lost with the next step of a kept conversation."""
    fields = get_type_hints(State)
    needed = {found for hint in fields.values() for found in nouns(hint)}
    assert needed
    assert needed <= set(TYPES)
