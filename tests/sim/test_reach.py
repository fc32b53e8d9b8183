"""Laws of reach: what is called reachable is a continuous, straight, legal motion; what is not comes with its distance."""

from __future__ import annotations

import math
import time

import numpy as np
import pytest

from kb.grasp import Grasp
from sim.hand import FULL_LIFT
from sim.kinematics import grasp_pose, tcp_poses, within_limits
from sim.panda import READY
from sim.reach import LEAST_LIFT, Reach, Unreachable, reach_from, solve_reach, solve_reaches


def _grasp(x: float, y: float, z: float, approach: tuple[float, float, float], yaw: float) -> Grasp:
    return Grasp(position=(x, y, z), approach=approach, yaw=yaw, aperture=0.07, force=15, type="pinch")


def _side(x: float, y: float, azimuth: float) -> Grasp:
    return _grasp(x, y, 0.1, (math.cos(azimuth), math.sin(azimuth), 0.0), azimuth + math.pi / 2)


def _draws(count: int, seed: int) -> np.ndarray:
    return np.random.default_rng(seed).uniform([0.40, -0.25, -3.1], [0.65, 0.25, 3.1], (count, 3))


def test_every_top_grasp_over_the_spawn_area_is_reachable() -> None:
    """Ledger G40: all of 40 random top-down grasps in the spawn area can be made."""
    reached = [solve_reach(_grasp(x, y, 0.025, (0, 0, -1), yaw)) for x, y, yaw in _draws(40, 1)]
    assert all(isinstance(reach, Reach) for reach in reached)


@pytest.mark.parametrize("seed", [2, 3])
def test_a_reach_is_straight_continuous_and_within_limits(seed: int) -> None:
    """Approach and lift are straight lines with a fixed orientation, without jumps, within the joint limits."""
    for x, y, turn in _draws(12, seed):
        grasp = _side(x, y, math.atan2(y, x) + 0.2 + 0.1 * turn)
        reach = solve_reach(grasp)
        if isinstance(reach, Unreachable):
            continue
        for path in (reach.approach, reach.lift):
            assert within_limits(path).all()
            assert np.abs(np.diff(path, axis=0)).max() < 0.3
            poses = tcp_poses(path)
            line = np.linspace(poses[0, :3, 3], poses[-1, :3, 3], len(path))
            assert np.abs(poses[:, :3, 3] - line).max() < 1e-4
            assert np.abs(poses[:, :3, :3] - poses[0, :3, :3]).max() < 1e-3
        start, end = tcp_poses(reach.approach[[0, -1]])[:, :3, 3]
        assert end - start == pytest.approx(grasp.standoff * np.array(grasp.approach), abs=2e-4)
        rise = np.diff(tcp_poses(reach.lift[[0, -1]])[:, :3, 3], axis=0)[0]
        assert rise == pytest.approx((0, 0, reach.height), abs=2e-4)
        assert reach.height in (FULL_LIFT, LEAST_LIFT)
        assert end == pytest.approx(grasp.position, abs=1e-4)


def test_either_way_round_of_the_hand_is_a_solution() -> None:
    """The hand's z axis is the approach and its y axis is plus or minus the closing axis."""
    grasp = _grasp(0.5, 0.1, 0.03, (0, 0, -1), 0.4)
    found = solve_reaches(grasp, options=6)
    assert isinstance(found, tuple)
    assert len(found) > 1
    wanted = grasp_pose(grasp)
    for reach in found:
        pose = tcp_poses(reach.joints[None])[0]
        assert pose[:3, 2] == pytest.approx(wanted[:3, 2], abs=1e-4)
        assert abs(pose[:3, 1] @ wanted[:3, 1]) == pytest.approx(1.0, abs=1e-6)
    costs = [reach.cost for reach in found]
    assert costs == sorted(costs)


def test_out_of_reach_says_how_far() -> None:
    """A grasp 30 cm beyond the arm is unreachable by about that distance; one below the table hits nothing reachable."""
    far = solve_reach(_grasp(1.15, 0.0, 0.1, (0, 0, -1), 0.0))
    assert isinstance(far, Unreachable)
    assert far.reason == "grasp"
    assert 0.1 < far.residual < 0.6


def test_stored_joints_give_the_same_motion() -> None:
    """A plan's joint angles reproduce the reach they came from; angles of another grasp are refused."""
    grasp = _grasp(0.5, 0.1, 0.03, (0, 0, -1), 0.4)
    reach = solve_reach(grasp)
    assert isinstance(reach, Reach)
    again = reach_from(grasp, reach.joints)
    assert isinstance(again, Reach)
    assert np.abs(again.approach - reach.approach).max() < 1e-6
    assert isinstance(reach_from(grasp, READY), Unreachable)


@pytest.mark.slow
def test_a_grasp_costs_milliseconds() -> None:
    """Planning one reachable grasp takes 15 ms at most on a busy core (2-4 ms on a free one)."""
    grasps = [_grasp(x, y, 0.025, (0, 0, -1), yaw) for x, y, yaw in _draws(20, 5)]
    begun = time.process_time()
    for grasp in grasps:
        solve_reach(grasp)
    assert (time.process_time() - begun) / len(grasps) < 0.015
