"""Laws of the shape fits: boxes, outlines, balls, components, medians."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tools.perception.connected import connected
from tools.perception.filter_depth import box_sum, median_depth
from tools.perception.outline import outline
from tools.perception.sections import ranks_by_group
from tools.perception.sphere import fit_sphere
from tools.perception.upright_box import box_at, smallest_yaw, wrap_half_turn

ANGLE = st.floats(-3.1, 3.1)


def _rectangle(longer: float, shorter: float, yaw: float, centre: tuple[float, float]) -> np.ndarray:
    u, v = np.meshgrid(np.linspace(-0.5, 0.5, 61) * longer, np.linspace(-0.5, 0.5, 41) * shorter)
    c, s = np.cos(yaw), np.sin(yaw)
    return np.column_stack([u.ravel() * c - v.ravel() * s + centre[0], u.ravel() * s + v.ravel() * c + centre[1]])


@given(ANGLE)
def test_undirected_angles_lie_in_half_a_turn(angle: float) -> None:
    """Turning by half a turn changes nothing, and the result lies in (-pi/2, pi/2]."""
    wrapped = wrap_half_turn(angle)
    assert -np.pi / 2 < wrapped <= np.pi / 2
    assert abs(np.sin(wrapped - angle)) < 1e-9


@settings(max_examples=25, deadline=None)
@given(st.floats(0.06, 0.2), st.floats(0.02, 0.045), ANGLE, st.floats(0.3, 0.8), st.floats(-0.3, 0.3))
def test_rectangles_are_measured(longer: float, shorter: float, yaw: float, x: float, y: float) -> None:
    """The outline's rectangle has the sides, centre and azimuth of the rectangle it sees (1.5 mm, 1 degree)."""
    centre, azimuth, a, b = outline(_rectangle(longer, shorter, yaw, (x, y))).rectangle()
    assert a == pytest.approx(longer, abs=0.003)
    assert b == pytest.approx(shorter, abs=0.003)
    np.testing.assert_allclose(centre, (x, y), atol=0.0015)
    assert abs(np.sin(azimuth - yaw)) < np.sin(np.deg2rad(2.5))


@settings(max_examples=25, deadline=None)
@given(st.floats(0.03, 0.06), st.floats(0.3, 0.8), st.floats(-0.3, 0.3))
def test_circles_are_round_and_handles_bulge(radius: float, x: float, y: float) -> None:
    """A disc is round with its radius; a bar that sticks out leaves the circle and shows as the bulge."""
    k = np.arange(4000) + 0.5
    r, turn = radius * np.sqrt(k / 4000), np.pi * (1 + 5**0.5) * k
    disc = np.column_stack([x + r * np.cos(turn), y + r * np.sin(turn)])
    plain = outline(disc)
    assert plain.roughness < 0.02
    assert plain.radius == pytest.approx(radius, abs=0.0015)
    bar = _rectangle(0.03, 0.01, 0.7, (x + (radius + 0.01) * np.cos(0.7), y + (radius + 0.01) * np.sin(0.7)))
    mug = outline(np.concatenate([disc, bar]))
    np.testing.assert_allclose(mug.centre, (x, y), atol=0.002)
    assert mug.bulge == pytest.approx(0.025, abs=0.003)
    assert abs(np.sin((mug.bulge_azimuth - 0.7) / 2)) < 0.1


@settings(max_examples=20, deadline=None)
@given(ANGLE, st.floats(0.05, 0.2), st.floats(0.02, 0.04))
def test_smallest_box_turns_with_its_points(yaw: float, longer: float, shorter: float) -> None:
    """The smallest upright box of a turned cuboid is the cuboid."""
    flat = _rectangle(longer, shorter, yaw, (0.5, 0.1))
    points = np.concatenate([np.column_stack([flat, np.full(len(flat), z)]) for z in (0.0, 0.07)])
    box = box_at(points, smallest_yaw(points)[0])
    np.testing.assert_allclose(box.size, (longer, shorter, 0.07), atol=0.002)
    np.testing.assert_allclose(box.centre, (0.5, 0.1, 0.035), atol=0.001)


def test_a_ball_is_found_from_one_side() -> None:
    """A third of a ball with 1-mm noise gives centre and radius to 1.5 mm."""
    rng = np.random.default_rng(3)
    k = np.arange(3000) + 0.5
    z, turn = 1 - 2 * k / 3000, np.pi * (1 + 5**0.5) * k
    unit = np.column_stack([np.sqrt(1 - z * z) * np.cos(turn), np.sqrt(1 - z * z) * np.sin(turn), z])
    seen = unit[unit @ np.array([0.6, 0.0, 0.8]) > 0.3]
    ball = fit_sphere(np.array([0.5, 0.1, 0.04]) + 0.04 * seen + 0.001 * rng.standard_normal(seen.shape))
    np.testing.assert_allclose(ball.centre, (0.5, 0.1, 0.04), atol=0.0015)
    assert ball.radius == pytest.approx(0.04, abs=0.0015)


@given(st.lists(st.tuples(st.integers(0, 19), st.integers(0, 19)), max_size=30))
def test_components_are_those_of_the_graph(edges: list[tuple[int, int]]) -> None:
    """Two nodes have one label if and only if a path joins them."""
    first = np.array([a for a, _ in edges], np.intp)
    second = np.array([b for _, b in edges], np.intp)
    label = connected(20, first, second)
    reach = np.eye(20, dtype=bool)
    reach[first, second] = reach[second, first] = True
    for _ in range(5):
        reach = reach @ reach
    assert (reach == (label[:, None] == label[None])).all()


def test_the_median_drops_spikes_and_closes_single_holes() -> None:
    """A single wrong pixel vanishes, a single hole closes, a large one stays, the rest is its neighbourhood's median."""
    rng = np.random.default_rng(0)
    depth = (1.0 + 0.01 * rng.standard_normal((12, 14))).astype(np.float32)
    depth[5, 5], depth[8, 9] = 3.0, 0.0
    depth[8:11, 2:5] = 0.0
    filtered = median_depth(depth)
    assert filtered[5, 5] < 1.1
    assert 0.95 < filtered[8, 9] < 1.05
    assert filtered[9, 3] == 0.0
    assert filtered[2, 2] == np.median(depth[1:4, 1:4])


def test_window_sums_are_sums_over_windows() -> None:
    """Each value is the sum over its window, cut at the border."""
    image = np.arange(63.0).reshape(7, 9)
    total = box_sum(image, 2)
    assert total[3, 4] == image[1:6, 2:7].sum()
    assert total[0, 8] == image[0:3, 6:9].sum()


def test_ranks_are_taken_within_groups() -> None:
    """The median rank of each group is its own, groups with too few values give NaN."""
    values = np.array([5.0, 1.0, 3.0, 10.0, 30.0, 20.0, 7.0])
    (middle,) = ranks_by_group(values, np.array([0, 0, 0, 1, 1, 1, 2]), 3, (0.5,), 2)
    assert middle[0] == 3.0
    assert middle[1] == 20.0
    assert np.isnan(middle[2])
