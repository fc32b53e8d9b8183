"""Distances of footprints."""

from __future__ import annotations

import math

import pytest

from tools.planning.outline import outline, rectangle_gap


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
