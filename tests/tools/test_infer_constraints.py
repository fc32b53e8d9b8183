"""Constraints and their adjustment on scenes made for each of the four kinds."""

from __future__ import annotations

import math

import pytest

from kb.constraint import Constraints
from kb.errors import BadInputError
from kb.percept import PerceivedObject
from kb.switches import Switches
from tests.percept_fixtures import percept, thing
from tools.build_scene_graph import SceneGraphArgs, build_scene_graph
from tools.context import ToolContext
from tools.infer_constraints import ConstraintArgs, infer_constraints


def infer(*objects: PerceivedObject, target: str = "t", margin: float = 1.0, **switches: object) -> Constraints:
    context = ToolContext(switches=Switches.model_validate(switches))
    graph = build_scene_graph(SceneGraphArgs(percept=percept(*objects), target=target), context)
    return infer_constraints(ConstraintArgs(graph=graph, target=target, margin=margin), context)


def kinds(found: Constraints) -> list[tuple[str, str]]:
    return [(constraint.kind, constraint.target) for constraint in found.active]


def test_alone_there_is_no_constraint_and_nothing_is_adjusted() -> None:
    """An empty cup without neighbours: no active constraint, neutral adjustment."""
    found = infer(thing("t", "cup", 0.5, 0.0))
    assert found == Constraints()


def test_a_fragile_neighbour_takes_force_height_and_side() -> None:
    """Vase 6 cm to +y: force x 0.8, stand-off + 0.03 m, hand biased by 0.3 towards +y of the motion, yaw 90 degrees."""
    found = infer(thing("t", "cup", 0.5, 0.0), thing("v", "vase", 0.5, 0.14))
    assert kinds(found) == [("collision", "v")]
    change = found.adjustment
    assert (change.force_scale, change.standoff) == (0.8, 0.03)
    assert change.away == pytest.approx((0.0, 0.3, 0.0))
    assert change.avoid_yaw == pytest.approx((math.pi / 2,))
    assert found.active[0].gap == pytest.approx(0.06)
    assert "6.0 cm" in found.active[0].reason


def test_the_other_reading_of_away_turns_the_bias_round() -> None:
    """`away: motion` biases the motion away from the neighbour instead of the hand (ledger G11)."""
    objects = (thing("t", "cup", 0.5, 0.0), thing("v", "vase", 0.5, 0.14))
    assert infer(*objects, away="motion").adjustment.away == pytest.approx((0.0, -0.3, 0.0))


@pytest.mark.parametrize(("gap", "active"), [(0.099, True), (0.101, False)])
def test_the_safe_distance_is_ten_centimetres_between_surfaces(gap: float, active: bool) -> None:
    """delta_safe = 0.10 m (Sec. III-B; ledger G5)."""
    found = infer(thing("t", "cup", 0.5, 0.0), thing("v", "vase", 0.5, 0.08 + gap))
    assert bool(found.active) == active


def test_margins_widen_the_safe_distance() -> None:
    """After a violation, margin 1.5 reaches a neighbour at 14 cm, and the adjustment says so (ledger G18)."""
    objects = (thing("t", "cup", 0.5, 0.0), thing("v", "vase", 0.5, 0.22))
    assert not infer(*objects).active
    wide = infer(*objects, margin=1.5)
    assert kinds(wide) == [("collision", "v")]
    assert wide.adjustment.margin == 1.5


def test_two_fragile_neighbours_cut_the_force_once() -> None:
    """Force and stand-off change once; directions add up, and opposite ones cancel."""
    found = infer(
        thing("t", "smartphone", 0.5, 0.0), thing("l", "wine_glass", 0.5, -0.1), thing("r", "wine_glass", 0.5, 0.1)
    )
    assert sorted(kinds(found)) == [("collision", "l"), ("collision", "r")]
    assert (found.adjustment.force_scale, found.adjustment.standoff) == (0.8, 0.03)
    assert found.adjustment.away == pytest.approx((0.0, 0.0, 0.0))
    assert len(found.adjustment.avoid_yaw) == 2


@pytest.mark.parametrize(("fragility", "active"), [(0.5, True), (0.49, False)])
def test_neighbours_count_as_fragile_from_one_half(fragility: float, active: bool) -> None:
    """Fragility 0.5 is fragile (ledger G8); a sturdy neighbour needs clearance, not less force."""
    neighbour = thing("v", "vase", 0.5, 0.14)
    affordance = neighbour.affordance.model_copy(update={"fragility": fragility})
    found = infer(thing("t", "cup", 0.5, 0.0), neighbour.model_copy(update={"affordance": affordance}))
    assert bool(found.active) == active


def test_a_filled_cup_is_taken_straight_down_and_slowly() -> None:
    """Direction (0, 0, -1), speed 0.3, tilt at most 15 degrees (Sec. III-B; ledger G11)."""
    found = infer(thing("t", "cup", 0.5, 0.0, state="filled"))
    assert kinds(found) == [("content", "t")]
    assert found.adjustment.direction == (0.0, 0.0, -1.0)
    assert found.adjustment.speed == 0.3
    assert found.adjustment.max_tilt == pytest.approx(math.radians(15.0))


def test_a_bowl_with_a_key_in_it_keeps_its_content() -> None:
    """What lies wholly inside is carried along: content, and no removal."""
    found = infer(thing("t", "bowl", 0.5, 0.0), thing("k", "key", 0.5, 0.0, base=0.008))
    assert kinds(found) == [("content", "t")]
    assert found.adjustment.remove_first == ()
    assert "key" in found.active[0].reason


def test_a_pile_is_removed_from_the_top() -> None:
    """Support is transitive: what lies on what lies on the target goes first (ledger G7)."""
    pile = (
        thing("t", "box", 0.5, 0.0),
        thing("m", "cube", 0.5, 0.0, base=0.12),
        thing("u", "block", 0.5, 0.0, base=0.17),
    )
    found = infer(*pile)
    assert kinds(found) == [("support", "u"), ("support", "m")]
    assert found.adjustment.remove_first == ("u", "m")
    assert infer(*pile, target="m").adjustment.remove_first == ("u",)
    assert not infer(*pile, target="u").adjustment.remove_first


def test_a_fragile_thing_on_top_is_removed_not_feared() -> None:
    """A phone on the box is a prerequisite; once it is gone it is no neighbour."""
    found = infer(thing("t", "box", 0.5, 0.0), thing("p", "smartphone", 0.5, 0.0, base=0.12))
    assert kinds(found) == [("support", "p")]
    assert found.adjustment.force_scale == 1.0


def test_an_occluder_is_passed_on_the_side_with_more_room() -> None:
    """The lateral direction is horizontal, across the line to the occluder, away from the third object."""
    ball, box = thing("t", "tennis_ball", 0.45, 0.0), thing("b", "box", 0.59, 0.0)
    found = infer(ball, box, thing("c", "cube", 0.45, 0.13))
    assert ("occlusion", "b") in kinds(found)
    assert found.adjustment.lateral == pytest.approx((0.0, -1.0, 0.0), abs=1e-9)
    mirrored = infer(ball, box, thing("c", "cube", 0.45, -0.13))
    assert mirrored.adjustment.lateral == pytest.approx((0.0, 1.0, 0.0), abs=1e-9)


def test_all_four_kinds_come_in_the_order_of_composition() -> None:
    """Support, occlusion, content, collision (ledger G11)."""
    found = infer(
        thing("t", "mug", 0.45, 0.0, state="filled"),
        thing("s", "key", 0.45, 0.0, base=0.09),
        thing("o", "box", 0.59, 0.0),
        thing("v", "vase", 0.45, 0.14),
    )
    assert [kind for kind, _ in kinds(found)] == ["support", "occlusion", "content", "collision"]
    assert found.adjustment.direction == (0.0, 0.0, -1.0)
    assert found.adjustment.max_tilt is not None
    assert found.adjustment.away != (0.0, 0.0, 0.0)


def test_with_centre_distances_the_papers_own_case_is_missed() -> None:
    """Cup 5 cm from a wine glass: 12.5 cm between centres, so the literal reading sees no danger (ledger G5)."""
    objects = (thing("t", "cup", 0.5, 0.0), thing("g", "wine_glass", 0.5, 0.125))
    assert kinds(infer(*objects)) == [("collision", "g")]
    assert infer(*objects, distance="centre").active == ()


def test_an_unknown_target_is_refused_with_the_choices() -> None:
    """The message names the nodes."""
    graph = build_scene_graph(SceneGraphArgs(percept=percept(thing("t", "cup", 0.5, 0.0))), ToolContext())
    with pytest.raises(BadInputError, match=r"'x'.*valid: t"):
        infer_constraints(ConstraintArgs(graph=graph, target="x"), ToolContext())
