"""Laws of free motions: smooth, within the robot's limits, and clear of obstacles."""

from __future__ import annotations

import numpy as np
import pytest

from kb.grasp import Grasp
from sim.arm_shape import RADII, self_clearance, spheres
from sim.controller import along, follow
from sim.curve import cubic_spline, quintic
from sim.kinematics import link_poses
from sim.motion import MARGIN, Obstacle, Transit, clearances, free_motion, plan_transit, via_points
from sim.panda import Q_ACCELERATION, Q_MAX, Q_MIN, Q_VELOCITY, READY
from sim.reach import Reach, solve_reach

WALL = Obstacle((0.5, 0.0, 0.15), 0.0, (0.20, 0.02, 0.15))
"""A 30-cm wall between the left and the right half of the table."""


def _pregrasp(x: float, y: float) -> np.ndarray:
    grasp = Grasp(position=(x, y, 0.06), approach=(0, 0, -1), yaw=0.0, aperture=0.07, force=15, type="pinch")
    reach = solve_reach(grasp)
    assert isinstance(reach, Reach)
    return reach.pregrasp


@pytest.fixture(scope="module")
def sides() -> tuple[np.ndarray, np.ndarray]:
    return _pregrasp(0.5, 0.22), _pregrasp(0.5, -0.22)


def test_a_transit_begins_and_ends_at_rest_within_the_limits(sides: tuple[np.ndarray, np.ndarray]) -> None:
    """Velocity and acceleration stay below Franka's limits, and both vanish at the ends."""
    for goal in sides:
        transit = plan_transit(READY, goal)
        assert isinstance(transit, Transit)
        joints = np.vstack([READY, transit.samples(0.002)])
        velocity = np.diff(joints, axis=0) / 0.002
        acceleration = np.diff(velocity, axis=0) / 0.002
        assert (np.abs(velocity).max(axis=0) < Q_VELOCITY).all()
        assert (np.abs(acceleration).max(axis=0) < Q_ACCELERATION).all()
        assert np.abs(velocity[[0, -1]]).max() < 0.02
        assert joints[-1] == pytest.approx(goal, abs=1e-9)
        assert 0.5 < transit.duration < 2.5


def test_a_wall_is_passed_over(sides: tuple[np.ndarray, np.ndarray]) -> None:
    """The direct way through a wall is refused; a way above keeps the margin at every configuration."""
    left, right = sides
    direct = plan_transit(left, right)
    assert direct is not None
    assert direct.vias == 0
    assert clearances(direct.path, [WALL])[:, 1].min() < 0.0
    around = plan_transit(left, right, [WALL])
    assert around is not None
    assert around.vias > 0
    dense = around.samples(0.02)
    assert clearances(dense, [WALL])[:, 1].min() > 0.01
    assert clearances(dense, [])[:, 0].min() > 0.0


def test_no_way_is_none() -> None:
    """Where the goal is walled in, the answer is None and not a collision."""
    goal = _pregrasp(0.5, 0.0)
    cage = [Obstacle((0.5, s * 0.16, 0.5), 0.0, (0.4, 0.02, 0.5)) for s in (1, -1)]
    cage += [Obstacle((x, 0.0, 0.62), 0.0, (0.02, 0.3, 0.6)) for x in (0.40, 0.62)]
    assert plan_transit(READY, goal, cage) is None


def test_a_detour_aside_leads_out_of_a_corner() -> None:
    """An elbow turned aside can't raise the hand; strewn via points still lead home, 15 mm from what stands around it."""
    corner = np.array([1.464, 0.941, -1.589, -2.453, 1.417, 2.102, 2.550])
    cup = Obstacle(centre=(0.515, 0.0, 0.049), yaw=0.14, half=(0.0565, 0.0445, 0.049))
    glass = Obstacle(centre=(0.516, 0.149, 0.0997), yaw=0.0, half=(0.039, 0.039, 0.1036))
    assert plan_transit(corner, READY, (cup, glass)) is None
    found = plan_transit(corner, READY, (cup, glass), aside=40)
    assert found is not None
    assert clearances(found.path, (cup, glass)).min() >= MARGIN
    again = plan_transit(corner, READY, (cup, glass), aside=40)
    assert again is not None
    assert np.array_equal(found.path, again.path)


def test_no_spline_leaves_the_joints_range() -> None:
    """From a wrist near its stop some splines swing beyond it, though their knots do not; none of them is taken."""
    near = np.array([-1.663, 1.209, 1.66, -2.573, 1.879, 3.235, 0.75])
    refused = 0
    for vias in via_points(near, READY):
        knots = np.stack([near, *vias, READY])
        assert (knots < Q_MAX).all()
        found = free_motion(knots, (), carried=None, margin=-1.0, tilt=None)
        refused += found is None
        assert found is None or ((found.path >= Q_MIN).all() and (found.path <= Q_MAX).all())
    assert refused


def test_a_folded_arm_meets_its_shoulder() -> None:
    """The distance of wrist and shoulder is nothing where physics has them touch, and ample at home."""
    folded = np.array([[2.789, 1.038, -1.504, -3.032, -2.718, 2.703, 1.8]])
    assert self_clearance(folded) == pytest.approx(0.0, abs=5e-4)
    assert self_clearance(READY[None]) > 0.1
    assert clearances(folded, ())[0, 0] == pytest.approx(0.0, abs=5e-4)


def test_a_load_keeps_clear_of_the_robots_own_arm() -> None:
    """What reaches up to the forearm is told apart from what hangs free; without a load there is no such column."""
    beside = np.array([[1.071, 1.56, -1.484, -1.854, 1.737, 0.442, 0.947]])
    forearm = spheres(beside)[0][(RADII == 0.055)]
    hand = link_poses(beside)[0, 7]
    touching = (forearm - hand[:3, 3]) @ hand[:3, :3]
    assert clearances(beside, ()).shape == (1, 1)
    assert clearances(beside, (), touching)[0, -1] < 0.0
    assert clearances(READY[None], (), np.array([[0.0, 0.0, 0.2]]))[0, -1] > 0.1


def test_nearness_of_the_goal_is_allowed_but_not_exceeded(sides: tuple[np.ndarray, np.ndarray]) -> None:
    """A goal 3 mm from an obstacle is reached, and the path comes no closer than the goal itself."""
    goal = sides[0]
    box = Obstacle((0.5, 0.22, 0.0), 0.0, (0.06, 0.06, 0.1))
    near = float(clearances(goal[None], [box])[0, 1])
    taller = Obstacle((0.5, 0.22, 0.0), 0.0, (0.06, 0.06, 0.1 + near - 0.003))
    assert clearances(goal[None], [taller])[0, 1] == pytest.approx(0.003, abs=1e-3)
    transit = plan_transit(READY, goal, [taller])
    assert transit is not None
    assert clearances(transit.path, [taller])[:, 1].min() > 0.001


def test_a_held_object_is_kept_clear_too(sides: tuple[np.ndarray, np.ndarray]) -> None:
    """What hangs 15 cm below the hand makes the way over a wall higher or longer."""
    left, right = sides
    low = Obstacle((0.5, 0.0, 0.05), 0.0, (0.10, 0.02, 0.05))
    assert plan_transit(left, right, [low]) is not None
    load = np.array([[0.0, 0.0, 0.10 + share] for share in np.linspace(0.0, 0.06, 3)])
    loaded = plan_transit(left, right, [low], carried=load)
    assert loaded is not None
    assert clearances(loaded.path, [low], load)[:, 1].min() > 0.0


def test_spline_passes_its_knots_and_reproduces_lines() -> None:
    """The cubic spline interpolates its knots and is exact on straight lines."""
    knots = np.array([0.0, 0.3, 0.5, 1.0])
    values = np.random.default_rng(0).normal(size=(4, 7))
    assert cubic_spline(knots, values, knots) == pytest.approx(values)
    straight = np.outer(knots, np.arange(7.0)) + 1.0
    at = np.linspace(0, 1, 33)
    assert cubic_spline(knots, straight, at) == pytest.approx(np.outer(at, np.arange(7.0)) + 1.0)


def test_controls_carry_the_derivative_of_the_path() -> None:
    """Velocity inputs are the time derivative of the position inputs, also at the first step."""
    path = np.array([READY, READY + 0.2, READY + 0.3])
    joints = along(path, 1.0)
    controls = follow(joints, 0.05, path[0])
    integrated = path[0] + np.cumsum(controls[:, 1:21:3], axis=0) * 0.002
    assert integrated == pytest.approx(joints, abs=2e-3)
    assert controls[:, 21] == pytest.approx(np.full(len(joints), 0.05))
    assert quintic(500)[-1] == 1.0


def test_a_straight_motion_asks_no_joint_for_more_than_it_can() -> None:
    """A path that turns joint 3 by one radian in a tenth of a second takes as long as the published limit demands, and one
    that is slow enough takes exactly the time that was asked for."""
    path = np.zeros((13, 7))
    path[:, 2] = np.linspace(0.0, 1.0, 13)
    hurried, calm = along(path, 0.1), along(path, 2.0)
    speeds = np.abs(np.diff(hurried[:, 2])) / 0.002
    assert 0.9 * Q_VELOCITY[2] < speeds.max() <= Q_VELOCITY[2]
    assert len(calm) == 1000
