"""What a look after a placing is taken to say."""

from __future__ import annotations

from agent.goal import Goal, Placement, Reference
from agent.seen_placed import called_as_before, seen_placed
from kb.sensing import Sensing
from tests.planning_fixtures import percept, solid


def goal(**fields: object) -> Goal:
    return Goal(kind="place", reference=Reference(pronoun=True), placement=Placement.model_validate(fields))


PUT = Sensing(phase="home", aimed_at=(0.5, 0.15))
LANE = goal(kind="lane", lane=(0, 3))


def test_a_ball_that_rolled_out_of_its_lane_is_not_claimed() -> None:
    """Seen 4 cm beyond the lane's edge the placing has failed; 2 cm inside it, it has not, even 10 cm from the aim."""
    ball = solid("t", "tennis_ball", 0.5, -0.2)
    out = seen_placed(percept(solid("t", "tennis_ball", 0.5, 0.035)), LANE, ball, PUT)
    inside = seen_placed(percept(solid("t", "tennis_ball", 0.6, 0.10)), LANE, ball, PUT)
    assert (out.well, out.fallen) == (False, False)
    assert "lane" in out.words
    assert inside.well


def test_a_thing_that_is_seen_nowhere_is_not_claimed_except_in_the_bin() -> None:
    """What rolled off the table is not there; the bin's walls hide what lies in it."""
    ball = solid("t", "tennis_ball", 0.5, -0.2)
    gone = seen_placed(percept(), LANE, ball, PUT)
    assert gone.thing is None
    assert not gone.well
    inside = percept().model_copy(update={"bin": ((0.30, 0.425, 0.0), (0.60, 0.675, 0.10))})
    assert seen_placed(inside, goal(kind="bin"), ball, PUT).well
    beside = inside.model_copy(update={"objects": percept(solid("t", "tennis_ball", 0.5, 0.2)).objects})
    assert not seen_placed(beside, goal(kind="bin"), ball, PUT).well


def test_what_lies_has_fallen() -> None:
    """A wine glass that is 7 cm high and 20 cm long after a placing fell over, and is no success where it lies."""
    glass = solid("t", "wine_glass", 0.5, -0.2)
    lying = solid("t", "wine_glass", 0.5, 0.15).model_copy(update={"size": (0.20, 0.07, 0.07)})
    seen = seen_placed(percept(lying), LANE, glass, PUT)
    assert seen.fallen
    assert not seen.well


def test_what_slipped_away_is_never_claimed_and_what_may_be_broken_is_not_taken_again() -> None:
    """A ball lost on the way is taken again, wherever it lies; a wine glass is not."""
    lost = PUT.model_copy(update={"lost": True})
    for category, final in (("tennis_ball", False), ("wine_glass", True)):
        thing = solid("t", category, 0.5, 0.15)
        seen = seen_placed(percept(thing), LANE, solid("t", category, 0.5, -0.2), lost)
        assert (seen.well, seen.fallen) == (False, final)


def test_a_new_thing_at_the_place_is_what_was_put_there() -> None:
    """Taken for another category it still bears its id; elsewhere only what looks like it does."""
    put = solid("t", "cube", 0.5, -0.2)
    before = percept(put)
    there, alike, unlike = (
        solid("n", "block", 0.51, 0.16), solid("n", "block", 0.51, 0.02), solid("n", "bowl", 0.51, 0.02, size=(0.15, 0.15, 0.06)),
    )  # fmt: skip
    for seen, name in ((there, "t"), (alike, "t"), (unlike, "n")):
        assert [o.id for o in called_as_before(percept(seen), before, put, PUT).objects] == [name]


def test_what_fell_beside_the_bin_is_not_claimed_however_far_it_was_carried() -> None:
    """40 cm from where it was taken it is still the ball that was put into the bin; two new ones are nobody's."""
    corners = ((0.30, 0.425, 0.0), (0.60, 0.675, 0.10))
    ball = solid("obj_0", "tennis_ball", 0.5, -0.1)
    before = percept(ball).model_copy(update={"bin": corners})
    aimed = PUT.model_copy(update={"aimed_at": (0.45, 0.55)})
    beside = before.model_copy(update={"objects": (solid("obj_1", "tennis_ball", 0.5, 0.36),)})
    twice = before.model_copy(update={"objects": (*beside.objects, solid("obj_2", "tennis_ball", 0.6, 0.30))})
    seen = called_as_before(beside, before, ball, aimed)
    assert not seen_placed(seen, goal(kind="bin"), ball, aimed).well
    assert [o.id for o in called_as_before(twice, before, ball, aimed).objects] == ["obj_1", "obj_2"]
