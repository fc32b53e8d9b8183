"""History H of failed attempts."""

from __future__ import annotations

from kb.grasp import Grasp
from memory import HistoryEntry, merge_history, of_goal, tried_types


def entry(goal: int, attempt: int, kind: str | None = "power") -> HistoryEntry:
    grasp = None
    if kind is not None:
        grasp = Grasp.model_validate(
            {"position": (0.5, 0, 0.1), "approach": (0, 0, -1), "yaw": 0, "aperture": 0.08, "force": 10, "type": kind}
        )
    return HistoryEntry(goal=goal, attempt=attempt, grasp=grasp, failure="SLIP")


def test_attempts_are_kept_in_order_whatever_the_order_of_merging() -> None:
    """Goals and attempts come out sorted; single entries, several and None merge alike."""
    merged = merge_history(merge_history((), [entry(1, 0), entry(0, 1)]), entry(0, 0))
    assert [(e.goal, e.attempt) for e in merged] == [(0, 0), (0, 1), (1, 0)]
    assert merge_history(merged, None) == merged


def test_a_replayed_attempt_does_not_count_twice() -> None:
    """The entry that stood first stays when a resumed run reports the attempt again."""
    first, again = entry(0, 0, "power"), entry(0, 0, "side")
    assert merge_history((first,), again) == (first,)


def test_tried_types_are_those_of_the_goal_without_repeats() -> None:
    """Types of failed grasps of one goal in order; an attempt without a grasp has none."""
    history = merge_history(
        (), [entry(0, 0, "power"), entry(0, 1, "pinch"), entry(0, 2, "power"), entry(0, 3, None), entry(1, 0, "side")]
    )
    assert tried_types(history, 0) == ("power", "pinch")
    assert [e.attempt for e in of_goal(history, 1)] == [0]
