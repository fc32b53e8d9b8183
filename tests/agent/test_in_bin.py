"""What the robot remembers of the bin's contents."""

from __future__ import annotations

import math

import numpy as np
import pytest

from agent.in_bin import KEPT, with_another
from kb.sensing import Sensing
from tests.planning_fixtures import solid

CORNERS = ((0.30, 0.425, 0.0), (0.60, 0.675, 0.10))


def test_a_thing_lies_where_it_was_let_go_turned_as_it_was_turned() -> None:
    """Its box and its points are moved to the place and turned about the vertical with the hand."""
    put = solid("obj_3", "smartphone", 0.5, -0.2)
    (lying,) = with_another((), put, Sensing(aimed_at=(0.40, 0.50), turned=math.pi / 2), CORNERS)
    assert lying.position == pytest.approx((0.40, 0.50, put.size[2] / 2))
    assert math.cos(2 * (lying.yaw - put.yaw)) == pytest.approx(-1.0)
    before = put.surface_points() - np.asarray(put.position)
    after = lying.surface_points() - np.asarray(lying.position)
    assert np.allclose(after, np.stack([-before[:, 1], before[:, 0], before[:, 2]], axis=1), atol=1e-3)


def test_a_thing_lies_there_once_and_what_was_not_let_go_not_at_all() -> None:
    """Put there again it is remembered at its new place; without a place nothing is added; the memory is bounded."""
    ball = solid("obj_0", "tennis_ball", 0.5, 0.0)
    once = with_another((), ball, Sensing(aimed_at=(0.40, 0.50)), CORNERS)
    again = with_another(once, ball, Sensing(aimed_at=(0.50, 0.60)), CORNERS)
    assert [obj.position[:2] for obj in again] == [(0.50, 0.60)]
    assert with_another(again, ball, Sensing(), CORNERS) == again
    many = again
    for k in range(KEPT + 5):
        many = with_another(many, solid(f"obj_{k}", "cube", 0.5, 0.0), Sensing(aimed_at=(0.45, 0.55)), CORNERS)
    assert len(many) == KEPT
