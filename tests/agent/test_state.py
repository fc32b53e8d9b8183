"""How a conversation's state takes up what the nodes report."""

from __future__ import annotations

from agent.state import add_times


def test_a_stage_that_timed_nothing_keeps_the_other_stages_seconds() -> None:
    """Seconds add up per stage, an empty report changes nothing (an early end still counts its look), None clears."""
    looked = add_times({}, {"perception": 0.25})
    assert add_times(looked, {}) == {"perception": 0.25}
    assert add_times(looked, {"perception": 0.5, "brain": 1.0}) == {"brain": 1.0, "perception": 0.75}
    assert add_times(looked, None) == {}
