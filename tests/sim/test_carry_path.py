"""Laws of carrying: what is held stays upright where the arm can do so, and keeps clear of what stands there."""

from __future__ import annotations

import math

import numpy as np
import pytest

from kb.grasp import Grasp
from sim.carry_path import OVERSHOOT, UPRIGHT, arcs_above, carry_way, way_down
from sim.kinematics import forward, grasp_pose
from sim.motion import Obstacle, clearances, free_motion, plan_direct, tilts
from sim.reach import Reach, solve_reach

DIP = math.radians(20.0)


def side_grasp(x: float, y: float) -> Grasp:
    """A stem grasp dipping by 20 degrees, from the robot's side; exactly radial ones cannot be lifted."""
    azimuth = math.atan2(y, x) + 0.5
    approach = (math.cos(DIP) * math.cos(azimuth), math.cos(DIP) * math.sin(azimuth), -math.sin(DIP))
    return Grasp(
        position=(x, y, 0.07), approach=approach, yaw=azimuth + math.pi / 2, aperture=0.04, force=3.6, type="side"
    )


@pytest.fixture(scope="module")
def lifted() -> np.ndarray:
    reach = solve_reach(side_grasp(0.5, -0.22))
    assert isinstance(reach, Reach)
    return reach.lift[-1]


def test_a_glass_is_carried_across_the_table_without_tipping(lifted: np.ndarray) -> None:
    """The way tips it by less than 10 degrees and ends where the straight way down begins."""
    goal = grasp_pose(side_grasp(0.5, 0.2))
    way = way_down(goal, lifted, (), None)
    assert way is not None
    assert float(tilts(way.transit.path).max()) <= UPRIGHT
    assert way.transit.path[-1] == pytest.approx(way.path[0], abs=1e-9)
    below = forward(way.path[-1])[:3, 3]
    assert below == pytest.approx(goal[:3, 3] - np.array([0.0, 0.0, OVERSHOOT]), abs=1e-4)


def test_tilt_is_the_angle_of_what_stood_upright(lifted: np.ndarray) -> None:
    """Turning the base joint tips nothing; turning the sixth joint tips by no more than its angle."""
    turned, tipped = lifted.copy(), lifted.copy()
    turned[0] += 0.7
    tipped[5] += 0.2
    start, still, tilt = tilts(np.stack([lifted, turned, tipped]))
    assert start == still == pytest.approx(0.0, abs=1e-6)
    assert 0.15 < tilt <= 0.2


def test_a_way_that_tips_too_far_is_refused(lifted: np.ndarray) -> None:
    """The same knots pass without a limit and fail with one below their tilt."""
    tipped = lifted.copy()
    tipped[5] += 0.3
    knots = np.stack([lifted, tipped])
    assert free_motion(knots, (), carried=None, margin=0.0, tilt=None) is not None
    assert free_motion(knots, (), carried=None, margin=0.0, tilt=0.25) is None


def test_what_is_held_passes_over_what_stands_in_between(lifted: np.ndarray) -> None:
    """A box between start and goal: hand and load keep clear of it on the way."""
    box = Obstacle((0.5, 0.0, 0.05), 0.0, (0.05, 0.05, 0.05))
    load = np.array([[0.0, 0.0, 0.10], [0.0, 0.0, 0.14]])
    way = way_down(grasp_pose(side_grasp(0.5, 0.2)), lifted, (box,), load)
    assert way is not None
    assert float(clearances(way.transit.path, (box,), load)[:, 1].min()) > 0.0


def test_a_direct_way_is_taken_where_it_is_upright(lifted: np.ndarray) -> None:
    """Turning about the base alone needs no arc: the way is the straight one in joint space."""
    goal = lifted.copy()
    goal[0] += 0.4
    way, direct = carry_way(lifted, goal, (), None), plan_direct(lifted, goal)
    assert way is not None
    assert direct is not None
    assert way.path == pytest.approx(direct.path)


def test_arcs_need_hands_that_differ_by_a_turn_about_the_vertical_only(lifted: np.ndarray) -> None:
    """To a set-down with another dip there is no arc."""
    steeper = grasp_pose(side_grasp(0.5, 0.2))
    steeper[:3, :3] = steeper[:3, :3] @ np.array([[1, 0, 0], [0, 0.9, -0.436], [0, 0.436, 0.9]])
    assert not list(arcs_above(steeper, lifted))
