"""Places to set things down: free, reachable, upright, and the bin."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from kb.errors import BadInputError
from kb.percept import PerceivedObject, Percept
from kb.sensing import Plan, Sensing
from sim.panda import READY
from tests.planning_fixtures import bottle, context, cup, percept, solid
from tools.context import ToolContext
from tools.open_world import open_perceiver, open_world
from tools.perceive import PerceiveArgs, perceive
from tools.place_object import PlaceArgs, choose_place, place_object, set_down_speed
from tools.plan_grasp import PlanArgs, plan_grasp
from tools.planning.set_down import SetDown, box_distance, footprint_radius, load_points

BIN = ((0.30, 0.425, 0.0), (0.60, 0.675, 0.10))


class Robot(SimpleNamespace):
    """A robot that only writes down where it was told to set down."""

    def place(self, position: Any, **options: Any) -> Sensing:
        self.placed = (position, options)
        return Sensing(phase="home")

    def handover(self, obstacles: Any, **options: Any) -> Sensing:
        self.handed = (obstacles, options)
        return Sensing(phase="hold")


def held(seen: PerceivedObject) -> Plan:
    plan = plan_grasp(PlanArgs(percept=percept(seen), target=seen.id), context()).plan
    assert plan is not None
    return plan


def chosen(seen: PerceivedObject, others: Percept, **fields: Any) -> SetDown | None:
    args = PlaceArgs.model_validate({"percept": others, "held": held(seen), "object": seen} | fields)
    return choose_place(args, ToolContext(robot=Robot(joints=READY, aperture=0.05)))


def test_a_side_of_the_table_is_the_robots_side() -> None:
    """Left is +y, right is -y, seen from the robot's base."""
    seen = solid("t", "cube", 0.5, 0.0)
    left, right = (chosen(seen, percept(), kind="side", side=side) for side in ("left", "right"))
    assert left is not None
    assert right is not None
    assert left.centre[1] > 0.15
    assert right.centre[1] < -0.15


def test_what_stands_there_is_kept_clear_of() -> None:
    """A mug on the wanted point: the nearest free place is taken, with the footprints 12 mm apart at least."""
    seen = solid("t", "cube", 0.5, -0.2)
    there = cup("n", 0.5, 0.2)
    option = chosen(seen, percept(there), kind="point", point=(0.5, 0.2))
    assert option is not None
    assert box_distance(option.centre, there) >= footprint_radius(seen) + 0.012
    assert math.dist(option.centre, (0.5, 0.2)) < 0.16


@pytest.mark.parametrize(("relation", "sign", "axis"), [("left_of", 1, 1), ("right_of", -1, 1), ("behind", 1, 0)])
def test_beside_means_on_the_wanted_side(relation: str, sign: int, axis: int) -> None:
    """Left of the reference is +y of it, behind is +x of it, both within 20 cm."""
    seen, other = solid("t", "cube", 0.40, -0.20), solid("n", "tennis_ball", 0.50, 0.0)
    option = chosen(seen, percept(other), kind="beside", reference="n", relation=relation)
    assert option is not None
    offset = np.subtract(option.centre, other.position[:2])
    assert sign * offset[axis] > 0.03
    assert np.linalg.norm(offset) < 0.2


def test_things_are_spread_inside_the_bin_and_keep_off_its_walls() -> None:
    """Slots 0, 1 and 2 lie at different places, each with the whole footprint inside."""
    seen = solid("t", "cube", 0.5, 0.0)
    inside = percept().model_copy(update={"bin": BIN})
    options = [chosen(seen, inside, kind="bin", slot=slot) for slot in range(3)]
    centres = [option.centre for option in options if option is not None]
    assert len({(round(x, 3), round(y, 3)) for x, y in centres}) == 3
    for x, y in centres:
        assert 0.30 + 0.025 < x < 0.60 - 0.025
        assert 0.425 + 0.025 < y < 0.675 - 0.025


def test_a_bottle_taken_from_the_side_is_set_down_upright() -> None:
    """The hand keeps its tilt: only a turn about the vertical separates grasp and set-down."""
    seen = bottle("t", 0.5, 0.1)
    plan = held(seen)
    option = chosen(seen, percept(), kind="side", side="right")
    assert option is not None
    assert option.approach[2] == pytest.approx(plan.grasp.approach[2], abs=1e-9)
    height = plan.grasp.position[2] - seen.base_z
    assert option.position[2] == pytest.approx(height, abs=0.005)


def test_a_lane_is_not_left() -> None:
    """`keep_in` bounds the centre."""
    seen = solid("t", "cube", 0.5, -0.2)
    option = chosen(seen, percept(), kind="point", point=(0.5, 0.15), keep_in=((0.35, 0.075), (0.68, 0.225)))
    assert option is not None
    assert 0.075 <= option.centre[1] <= 0.225


def test_the_more_fragile_the_slower() -> None:
    """A wine glass is set down slower than a cup, a cube at full speed."""
    speeds = [
        set_down_speed(PlaceArgs(percept=percept(), held=held(seen), object=seen, kind="aside"))
        for seen in (solid("t", "cube", 0.5, 0.0), cup("t", 0.5, 0.0))
    ]
    assert speeds == [pytest.approx(1.0), pytest.approx(0.7)]


def test_no_room_is_said_by_the_sensing() -> None:
    """A crowd on the only allowed spot: nothing moves, stopped by "path" while planning."""
    seen = solid("t", "cube", 0.4, -0.25)
    crowd = percept(solid("n", "box", 0.5, 0.15))
    args = PlaceArgs(
        percept=crowd,
        held=held(seen),
        object=seen,
        kind="point",
        point=(0.5, 0.15),
        keep_in=((0.48, 0.13), (0.52, 0.17)),
    )
    robot = Robot(joints=READY, aperture=0.05)
    sensing = place_object(args, ToolContext(robot=robot))
    assert (sensing.stopped_by, sensing.phase, hasattr(robot, "placed")) == ("path", "plan", False)


@pytest.mark.parametrize(
    "fields", [{"kind": "bin"}, {"kind": "side"}, {"kind": "point"}, {"kind": "beside", "reference": "x"}]
)
def test_what_is_missing_is_said(fields: dict[str, Any]) -> None:
    """No bin, no side, no point, no such reference: bad input."""
    with pytest.raises(BadInputError):
        chosen(solid("t", "cube", 0.5, 0.0), percept(), **fields)


def test_what_lies_in_the_bin_is_kept_clear_of_and_fallen_back_on() -> None:
    """A thing that is remembered at the first place sends the next one elsewhere; a full bin still takes it, on top."""
    corners = ((0.30, 0.425, 0.0), (0.60, 0.675, 0.10))
    seen = solid("t", "cube", 0.45, 0.1)
    bare = percept().model_copy(update={"bin": corners})
    free = chosen(seen, bare, kind="bin")
    assert free is not None
    there = solid("n", "tennis_ball", *free.centre)
    other = chosen(seen, bare, kind="bin", lying=(there,))
    assert other is not None
    assert box_distance(other.centre, there) >= 0.025 + 0.03
    full = tuple(
        solid(f"n{k}", "box", x, y) for k, (x, y) in enumerate(((0.37, 0.49), (0.53, 0.49), (0.37, 0.62), (0.53, 0.62)))
    )
    assert chosen(seen, bare, kind="bin", lying=full) is not None


def test_a_cup_goes_into_the_bin_in_physics() -> None:
    """Grasped, carried over the wall, lowered, let go: the observer finds it in the bin, undamaged."""
    opened = open_world("clear_table", 10002)
    tools = ToolContext(
        robot=opened.robot, perceiver=open_perceiver("oracle", opened, None), rng=np.random.default_rng(0)
    )
    seen = perceive(PerceiveArgs(), tools)
    target = next(item for item in seen.objects if item.category == "cup")
    name = opened.observer.meant(target.category, target.position)
    plan = plan_grasp(PlanArgs(percept=seen, target=target.id), tools).plan
    assert plan is not None
    tools.robot.grasp(plan.grasp, joints=plan.joints, shake=False)
    place_object(PlaceArgs(percept=seen, held=plan, object=target, kind="bin"), tools)
    verdict = opened.observer.judge(opened.motions, name, SimpleNamespace(kind="bin", side=None, relation=None))
    assert verdict.success
    assert opened.observer.in_bin(name)


def test_a_place_in_a_lane_is_well_inside_it() -> None:
    """With something on the lane's middle the free place lies along the lane, 3.5 cm or more from its edges."""
    seen = solid("t", "tennis_ball", 0.5, -0.2)
    there = solid("n", "cube", 0.515, 0.15)
    option = chosen(seen, percept(there), kind="point", point=(0.515, 0.15), keep_in=((0.35, 0.075), (0.68, 0.225)))
    assert option is not None
    assert 0.11 - 1e-9 <= option.centre[1] <= 0.19 + 1e-9
    assert box_distance(option.centre, there) >= footprint_radius(seen) + 0.012


def test_long_things_lie_along_a_lane() -> None:
    """A phone that lay across a lane is turned along it, so that the lanes beside it stay free."""
    seen = solid("t", "smartphone", 0.5, -0.2, yaw=math.pi / 2)
    option = chosen(seen, percept(), kind="point", point=(0.515, 0.0), keep_in=((0.35, -0.075), (0.68, 0.075)))
    assert option is not None
    assert abs(math.cos(seen.yaw + option.turn)) > math.cos(math.radians(30.0))


def test_a_hand_fits_beside_what_is_still_to_be_taken() -> None:
    """In a lane 5 cm and more are left beside a thing that waits, and less where there is no such room."""
    seen = solid("t", "cube", 0.5, -0.2)
    waits = solid("n", "box", 0.515, 0.15)
    lane = {"kind": "point", "point": (0.515, 0.15), "keep_in": ((0.35, 0.075), (0.68, 0.225))}
    plain, roomy = chosen(seen, percept(waits), **lane), chosen(seen, percept(waits), **lane, to_take=("n",))
    assert plain is not None
    assert roomy is not None
    assert box_distance(roomy.centre, waits) - 0.025 >= 0.05 > box_distance(plain.centre, waits) - 0.025
    small = solid("n", "cube", 0.515, 0.15)
    narrow = {**lane, "keep_in": ((0.425, 0.115), (0.605, 0.185))}
    crowded = chosen(seen, percept(small), **narrow, to_take=("n",))
    assert crowded is not None
    assert box_distance(crowded.centre, small) - 0.025 < 0.05


def test_what_is_held_out_is_carried_in_its_full_extent() -> None:
    """The robot is told where the held thing reaches, as for a set-down."""
    seen, robot = solid("t", "smartphone", 0.5, 0.0), Robot(joints=READY, aperture=0.05)
    args = PlaceArgs(
        percept=percept(seen, solid("n", "cube", 0.5, 0.2)), held=held(seen), object=seen, kind="hand_over"
    )
    place_object(args, ToolContext(robot=robot))
    boxes, options = robot.handed
    assert len(boxes) == 1
    assert options["load"] == load_points(seen, args.held)
    assert np.ptp(np.array(options["load"]), axis=0).max() > 0.08
