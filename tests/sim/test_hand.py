"""Laws of the hand's boxes and of the swept clearance."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kb.grasp import Grasp
from sim.hand import PALM_ABOVE_TCP, TCP_OFFSET, TIP_BEYOND_TCP, hand_boxes
from sim.swept_hand import (
    CULL_MARGIN,
    Passing,
    swept_clearance,
    swept_clearances,
    swept_count,
    swept_distances,
    swept_leasts,
)


def _top(x: float = 0.5, y: float = 0.0, z: float = 0.05, yaw: float = 0.0, aperture: float = 0.06) -> Grasp:
    return Grasp(
        position=(x, y, z), approach=(0, 0, -1), yaw=yaw, aperture=aperture, force=10, type="pinch", standoff=0.1
    )


def test_measured_size_of_the_hand() -> None:
    """The hand reaches 102 mm along the closing axis, 31.5 mm across, and the tips stand 46 mm below the palm."""
    boxes = hand_boxes(0.0)
    assert max(centre[1] + half[1] for centre, half in boxes) == pytest.approx(0.102)
    assert max(centre[0] + half[0] for centre, half in boxes) == pytest.approx(0.0315)
    assert PALM_ABOVE_TCP + TIP_BEYOND_TCP == pytest.approx(0.046, abs=5e-4)


def test_opening_moves_only_the_fingers() -> None:
    """The gap between the pads is the aperture; the palm stays."""
    for aperture in (0.0, 0.03, 0.08):
        boxes = hand_boxes(aperture)
        pads = [boxes[4], boxes[7]]
        inner = [abs(centre[1]) - half[1] for centre, half in pads]
        assert inner == pytest.approx([aperture / 2, aperture / 2])
        assert [tuple(c) for c, _ in boxes[:2]] == [tuple(c) for c, _ in hand_boxes(0.0)[:2]]


def test_points_between_the_pads_are_clear_and_points_in_a_pad_are_not() -> None:
    """A point at the tool centre is half an aperture from the pads; a point inside a pad is negative."""
    grasp = _top()
    assert swept_clearance(grasp, np.array([[0.5, 0.0, 0.05]]), lift=0.0) == pytest.approx(0.03, abs=2e-3)
    inside = np.array([[0.5 + 0.03 + 0.007, 0.0, 0.05]])
    assert swept_clearance(grasp, inside) < -0.003


def test_a_tall_neighbour_hits_the_palm_only_along_the_closing_axis() -> None:
    """Ledger G2: a neighbour 8 cm away and 12 cm tall is hit along the closing axis and missed across it."""
    column = np.array([[0.58, 0.0, z] for z in np.linspace(0, 0.12, 13)])
    assert swept_clearance(_top(yaw=0.0), column) < 0.0
    assert swept_clearance(_top(yaw=math.pi / 2), column) > 0.04


def test_the_sweep_covers_the_way_in_and_the_way_up() -> None:
    """A point above the palm on the approach, and one above the lifted hand's path, are found."""
    above = np.array([[0.5, 0.09, 0.05 + 0.07 + 0.10]])
    grasp = _top(yaw=math.pi / 2)
    assert swept_clearance(grasp, above, lift=0.0) < 0.0
    higher = above + np.array([0.0, 0.0, 0.13])
    assert swept_clearance(grasp, higher, lift=0.0) > 0.02
    assert swept_clearance(grasp, higher, lift=0.17) < 0.01


@settings(max_examples=40, deadline=None)
@given(st.floats(-3, 3), st.floats(0.0, 0.08), st.floats(-0.3, 0.3), st.floats(-0.2, 0.2), st.floats(0.0, 0.3))
def test_clearance_moves_with_the_scene(yaw: float, aperture: float, dx: float, dy: float, z: float) -> None:
    """Moving grasp and points together changes nothing; half a turn of the closing axis changes nothing."""
    rng = np.random.default_rng(7)
    points = rng.uniform(-0.15, 0.15, (40, 3)) + np.array([0.5, 0.0, 0.1])
    grasp = _top(z=0.05 + z, yaw=yaw, aperture=aperture)
    base = swept_clearance(grasp, points)
    moved = grasp.model_copy(update={"position": (0.5 + dx, dy, 0.05 + z)})
    assert swept_clearance(moved, points + np.array([dx, dy, 0.0])) == pytest.approx(base, abs=1e-9)
    turned = grasp.model_copy(update={"yaw": yaw + math.pi})
    assert swept_clearance(turned, points) == pytest.approx(base, abs=1e-9)


def test_the_fast_distance_equals_the_boxes() -> None:
    """The mirrored five-box distance equals the signed distance to all eight stretched boxes."""
    rng = np.random.default_rng(5)
    grasp = _side(0.4)
    points = rng.normal([0.5, 0.0, 0.1], 0.1, (300, 3))
    local = (points - np.asarray(grasp.position)) @ grasp.rotation()
    best = np.full(len(points), np.inf)
    for centre, half in hand_boxes(grasp.aperture):
        centre = centre - [0.0, 0.0, TCP_OFFSET + grasp.standoff / 2]
        outside = np.abs(local - centre) - (half + np.array([0.0, 0.0, grasp.standoff / 2]))
        distance = np.linalg.norm(np.maximum(outside, 0.0), axis=1) + np.minimum(outside.max(axis=1), 0.0)
        best = np.minimum(best, distance)
    assert swept_distances(grasp, points, lift=0.0) == pytest.approx(best, abs=1e-12)


def test_nothing_slips_through_the_lift() -> None:
    """Points all along the way of a side grasp's fingers upwards are within the swept hand."""
    grasp = _side(0.0)
    pad = np.asarray(grasp.position) + grasp.closing_axis() * (grasp.aperture / 2 + 0.007)
    column = pad + np.linspace(0.0, 0.17, 60)[:, None] * [0.0, 0.0, 1.0]
    assert swept_distances(grasp, column, lift=0.17).max() < 0.0
    assert swept_distances(grasp, column, lift=0.0).max() > 0.1


def _side(turn: float) -> Grasp:
    approach = (math.cos(turn), math.sin(turn), 0.0)
    return Grasp(position=(0.5, 0, 0.1), approach=approach, yaw=turn + 1.57, aperture=0.06, force=10, type="side")


def test_batch_agrees_with_single_and_far_points_count_as_far() -> None:
    """Culled or not, clearances up to the margin are exact, and larger ones are never understated below it."""
    rng = np.random.default_rng(2)
    points = rng.uniform([0.3, -0.3, 0.0], [0.8, 0.3, 0.2], (500, 3))
    grasps = [_top(x, y, 0.05, yaw) for x, y, yaw in rng.uniform([0.3, -0.3, -3], [0.8, 0.3, 3], (50, 3))]
    grasps.append(_top(2.0, 2.0))
    batch = swept_clearances(grasps, points)
    for grasp, value in zip(grasps, batch, strict=True):
        exact = swept_distances(grasp, points, lift=0.0).min()
        assert min(value, CULL_MARGIN) == pytest.approx(min(exact, CULL_MARGIN), abs=1e-9)
    assert swept_clearances(grasps, np.zeros((0, 3))).tolist() == [np.inf] * len(grasps)


@pytest.mark.parametrize("lift", [0.0, 0.12, 0.17])
def test_points_that_are_left_out_change_no_bit(lift: float) -> None:
    """The least distance and the number of near points are those of all distances, bit for bit, at any lean of the hand."""
    rng = np.random.default_rng(11)
    for _ in range(60):
        lean = np.array([*rng.normal(size=2), -abs(rng.normal()) * rng.choice([0.1, 1.0, 100.0])])
        x, y, z = (lean / np.linalg.norm(lean)).tolist()
        yaw, opening = rng.uniform([-3, 0.01], [3, 0.08]).tolist()
        grasp = Grasp(position=(0.5, 0, 0.1), approach=(x, y, z), yaw=yaw, aperture=opening, force=10, type="side")
        points = rng.normal(rng.uniform([0.4, -0.1, 0.0], [0.6, 0.1, 0.2]), 0.04, (400, 3))
        distances = swept_distances(grasp, points, lift=lift)
        halves = [distances[:7].min(), distances[7:].min()]
        assert swept_leasts(grasp, [points[:7], points[7:]], lift=lift) == halves
        for limit in (-0.002, 0.001, 0.03):
            assert swept_count(grasp, points, limit, lift=lift) == (distances < limit).sum()


@pytest.mark.parametrize("tilt", [0.0, 0.6])
def test_one_view_of_the_points_serves_all_openings_and_lifts(tilt: float) -> None:
    """Clearances and counts from one view are those of a grasp of its own for each opening, lift and way back."""
    rng = np.random.default_rng(4)
    for _ in range(40):
        points = rng.normal([0.5, 0.0, 0.05], 0.08, (200, 3))
        approach = (math.sin(tilt), 0.0, -math.cos(tilt))
        yaw = float(rng.uniform(-3, 3))
        grasp = Grasp(position=(0.5, 0, 0.1), approach=approach, yaw=yaw, aperture=0.07, force=10, type="power")
        view = Passing(grasp, points)
        for aperture, lift in itertools.product((0.03, 0.07), (0.0, 0.17)):
            alone = grasp.model_copy(update={"aperture": aperture})
            assert view.clearance(aperture, lift) == pytest.approx(swept_clearance(alone, points, lift=lift), abs=1e-12)
        back = 0.02
        x, y, z = (np.array(grasp.position) - back * np.array(approach)).tolist()
        stopped = grasp.model_copy(update={"position": (x, y, z)})
        assert view.count(0.004, back) == swept_count(stopped, points, 0.004, lift=0.0)
