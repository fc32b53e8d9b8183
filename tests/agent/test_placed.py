"""What the robot says of a set-down."""

from __future__ import annotations

from agent.goal import Goal, Placement, Reference
from agent.placed import placed
from kb.sensing import Sensing


def test_back_is_only_claimed_where_it_was() -> None:
    """A thing that was set down beside its old place is not claimed to be back, and the distance is said."""
    goal = Goal(kind="place", reference=Reference(pronoun=True), placement=Placement(kind="back"))
    near = placed(Sensing(phase="retreat", aimed_at=(0.51, 0.20)), goal, (0.50, 0.20))
    far = placed(Sensing(phase="retreat", aimed_at=(0.60, 0.08)), goal, (0.57, 0.21))
    assert near == (True, "I put it back where it was.")
    assert not far[0]
    assert "13 cm from where it was" in far[1]


def test_what_stops_the_arm_after_it_let_go_is_left_to_the_look() -> None:
    """No way home is no failure of the placing, no way to the place is; a person's stop always is."""
    goal = Goal(kind="place", reference=Reference(pronoun=True), placement=Placement(kind="aside"))
    assert placed(Sensing(phase="home", stopped_by="path", aimed_at=(0.5, 0.2)), goal)[0]
    assert placed(Sensing(phase="home", stopped_by="force", aimed_at=(0.5, 0.2)), goal)[0]
    assert not placed(Sensing(phase="carry", stopped_by="path"), goal)[0]
    assert not placed(Sensing(phase="home", stopped_by="stop", aimed_at=(0.5, 0.2)), goal)[0]
    assert not placed(Sensing(phase="home", lost=True, aimed_at=(0.5, 0.2)), goal)[0]
