"""Laws of forward and inverse kinematics."""

from __future__ import annotations

import numpy as np

from sim.kinematics import (
    CLOSED_FORM_ERROR,
    flipped,
    forward,
    inverse,
    inverse_many,
    jacobian,
    link_poses,
    pose_error,
    refine,
    tcp_poses,
    within_limits,
)
from sim.panda import Q_MAX, Q_MIN, READY


def _configurations(count: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).uniform(Q_MIN, Q_MAX, (count, 7))


def test_batch_equals_single_forward_kinematics() -> None:
    """Vectorised and closed-form forward kinematics agree to rounding on 1000 configurations."""
    joints = _configurations(1000)
    single = np.array([forward(q) for q in joints])
    assert np.abs(tcp_poses(joints) - single).max() < 1e-12
    assert link_poses(joints).shape == (1000, 8, 4, 4)


def test_inverse_then_forward_returns_the_pose() -> None:
    """Every solution that `inverse_many` returns lies within the limits and reaches the pose to 0.1 mm."""
    reached = 0
    for q in _configurations(60, 3):
        pose = forward(q)
        found = inverse_many(pose, np.array([q[6], q[6] + 0.1]), READY, 0.0)
        if len(found):
            reached += 1
            assert within_limits(found, 0.0).all()
            assert np.abs(tcp_poses(found)[:, :3, 3] - pose[:3, 3]).max() < 1e-4
    assert reached >= 55


def test_only_true_solutions_are_kept() -> None:
    """Every solution over many last joint angles reaches the tool point, and none that does is left out."""
    samples = np.linspace(-2.7, 2.7, 12)
    for joints in _configurations(10, seed=3):
        pose = forward(joints)
        found = inverse_many(pose, samples, READY)
        assert np.linalg.norm(tcp_poses(found)[:, :3, 3] - pose[:3, 3], axis=1).max(initial=0.0) < CLOSED_FORM_ERROR
        each = np.concatenate([inverse(pose, q7, READY) for q7 in samples])
        each = each[within_limits(each)]
        true = np.linalg.norm(tcp_poses(each)[:, :3, 3] - pose[:3, 3], axis=1) < CLOSED_FORM_ERROR
        assert np.array_equal(each[true], found)


def test_jacobian_is_the_derivative() -> None:
    """The geometric Jacobian matches central differences of the pose."""
    step = 1e-6
    for q in _configurations(10, 4):
        change = [pose_error(forward(q + step * e), forward(q - step * e)) / (2 * step) for e in np.eye(7)]
        assert np.abs(jacobian(q) - np.array(change).T).max() < 1e-6


def test_refine_reaches_a_near_pose_and_measures_a_far_one() -> None:
    """From nearby the wanted pose is met; a pose 2 m away keeps an error of more than 1 m."""
    wanted = READY + 0.1
    joints, error = refine(forward(wanted), READY)
    assert error < 1e-5
    assert np.abs(forward(joints) - forward(wanted)).max() < 1e-4
    far = forward(READY)
    far[:3, 3] = (2.0, 0.0, 0.3)
    assert refine(far, READY)[1] > 1.0


def test_flipping_twice_is_nothing() -> None:
    """Half a turn about the approach keeps tool point and approach, and is its own inverse."""
    pose = forward(READY)
    turned = flipped(pose)
    assert np.array_equal(flipped(turned), pose)
    assert np.array_equal(turned[:3, 2:], pose[:3, 2:])
    assert np.array_equal(turned[:3, 0], -pose[:3, 0])
