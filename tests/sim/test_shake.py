"""The shake: how far and how fast the hand is rocked, in whatever posture the arm stands."""

from __future__ import annotations

import math

import numpy as np
import pytest

from kb.grasp import Grasp
from sim.build_model import TIMESTEP
from sim.kinematics import forward
from sim.panda import Q_MAX, Q_MIN, Q_VELOCITY, READY
from sim.reach import Unreachable, solve_reaches
from sim.shake import ANGLE, KNOTS, rocked_configurations, shake_path

SECONDS = 2.0


def _tops(count: int) -> list[np.ndarray]:
    """Configurations at the top of a lift, for random grasps from above and from the side."""
    rng, tops = np.random.default_rng(5), list[np.ndarray]()
    while len(tops) < count:
        radius, turn, height = rng.uniform(0.35, 0.68), rng.uniform(-0.6, 0.6), rng.uniform(0.02, 0.2)
        heading, slope = turn + rng.uniform(-0.6, 0.6), rng.choice([rng.uniform(0.0, 0.7), math.pi / 2])
        approach = (math.cos(heading) * math.cos(slope), math.sin(heading) * math.cos(slope), -math.sin(slope))
        grasp = Grasp(
            position=(radius * math.cos(turn), radius * math.sin(turn), height),
            approach=approach,
            yaw=float(rng.uniform(-1.5, 1.5)),
            aperture=0.06,
            force=10,
            type="pinch",
        )
        found = solve_reaches(grasp, READY, lift=0.15, options=1)
        if not isinstance(found, Unreachable):
            tops.append(found[0].lift[-1])
    return tops


def test_no_joint_is_asked_for_more_than_its_speed() -> None:
    """In 150 random postures every joint stays within its published speed, and the arm starts and ends where it stood;
    at most one shake in five takes longer than 2 s for that, none longer than 8 s."""
    lengths = []
    for top in _tops(150):
        path = np.concatenate([top[None], shake_path(top, SECONDS)])
        assert (np.abs(np.diff(path, axis=0)) <= TIMESTEP * Q_VELOCITY).all()
        assert path[-1] == pytest.approx(top, abs=1e-9)
        lengths.append((len(path) - 1) * TIMESTEP)
    assert min(lengths) == SECONDS
    assert max(lengths) < 8.0
    assert sum(length > SECONDS for length in lengths) <= 30


def test_a_slower_shake_rocks_as_far() -> None:
    """Where a joint is too slow for 1 Hz the hand still tilts by 15 degrees to both sides, as often as elsewhere."""
    slow = [top for top in _tops(150) if len(shake_path(top, SECONDS)) * TIMESTEP > SECONDS]
    rocking = [top for top in slow if rocked_configurations(top, np.linspace(-ANGLE, ANGLE, KNOTS)) is not None]
    assert len(rocking) > 5
    for top in rocking:
        rest = forward(top)
        x, y, z = rest[:3, 0], rest[:3, 1], rest[:3, 2]
        hands = np.array([forward(joints)[:3, :3] for joints in shake_path(top, SECONDS)])
        angles = np.arctan2(-(hands[:, :, 2] @ y), hands[:, :, 2] @ z)
        assert np.degrees([angles.min(), angles.max()]) == pytest.approx([-15.0, 15.0], abs=0.5)
        assert np.abs(hands[:, :, 0] @ x - 1.0).max() < 1e-3
        assert int((np.abs(np.diff(np.sign(angles[np.abs(angles) > 1e-3]))) > 0).sum()) == 3


def test_beside_its_limit_the_last_joint_turns_as_far() -> None:
    """Where the arm cannot rock, the last joint turns by 30 degrees in all, off its limits, from and to where it stood."""
    tops = [np.array([-1.133, 0.756, 1.459, -2.506, 2.125, 2.703, last]) for last in (-2.87, -2.7, 2.6, 2.75, 2.87)]
    stiff = [top for top in tops if rocked_configurations(top, np.linspace(-ANGLE, ANGLE, KNOTS)) is None]
    assert len(stiff) >= 3
    for top in stiff:
        path = shake_path(top, SECONDS)
        turned = path[:, 6]
        assert np.ptp(path[:, :6], axis=0).max() == 0.0
        assert np.degrees(np.ptp(turned)) == pytest.approx(30.0, abs=1.0)
        assert turned.min() > Q_MIN[6]
        assert turned.max() < Q_MAX[6]
        assert turned[-1] == pytest.approx(top[6], abs=1e-9)
        assert (np.abs(np.diff(path, axis=0)) <= TIMESTEP * Q_VELOCITY).all()
