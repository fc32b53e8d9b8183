"""Distances of footprints."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tools.planning.outline import clear_case, outline, rectangle_gap


def test_gap_of_two_squares_side_by_side() -> None:
    """Two 4-cm squares with middles 10 cm apart are 6 cm apart; turned by 45 degrees, less by their corners."""
    one = outline((0.0, 0.0), (0.04, 0.04, 0.1), 0.0)
    assert rectangle_gap(one, outline((0.10, 0.0), (0.04, 0.04, 0.1), 0.0)) == pytest.approx(0.06)
    turned = outline((0.10, 0.0), (0.04, 0.04, 0.1), math.pi / 4)
    assert rectangle_gap(one, turned) == pytest.approx(0.08 - 0.02 * math.sqrt(2))


def test_overlap_is_negative() -> None:
    """Rectangles that overlap have no gap."""
    one = outline((0.0, 0.0), (0.2, 0.04, 0.1), 0.3)
    assert rectangle_gap(one, outline((0.05, 0.02), (0.1, 0.1, 0.1), 1.0)) < 0.0


def test_clear_cases_are_those_of_the_gap() -> None:
    """What is said without looking at the turn holds for 1500 random pairs of boxes, and is said of most of them."""
    rng, said = np.random.default_rng(5), 0
    for _ in range(1500):
        one, other = rng.uniform(-0.3, 0.3, (2, 2)).tolist()
        sizes = [tuple(rng.uniform(0.01, 0.2, 3).tolist()) for _ in range(2)]
        gap = float(rng.uniform(-0.01, 0.05))
        keeps = clear_case(one, sizes[0], other, sizes[1], gap)
        turned = [
            outline(*box, float(yaw))
            for box, yaw in zip(((one, sizes[0]), (other, sizes[1])), rng.uniform(-3, 3, 2), strict=True)
        ]
        assert keeps in (None, rectangle_gap(*turned) >= gap)
        said += keeps is not None
    assert said > 750
