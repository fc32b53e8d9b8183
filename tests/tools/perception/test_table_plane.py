"""The table puts a camera right."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from kb.rgbd import RgbdView
from tools.perception.calibrate_view import calibrate_view


def _turned(pose: np.ndarray, axis: tuple[float, float, float], angle: float, shift: tuple[float, float, float]):
    x, y, z = np.asarray(axis) / np.linalg.norm(axis)
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    moved = pose.copy()
    moved[:3, :3] = (np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k) @ pose[:3, :3]
    moved[:3, 3] += shift
    return moved


def test_calibration_error_is_removed(draw_views: Callable[..., tuple[RgbdView, ...]]) -> None:
    """A pose told wrong by 3 mm and 0.3 degrees is mended until table points are right to 1.5 mm everywhere."""
    exact = {view.name: view.transform_camera_to_world for view in draw_views()}
    told = {name: _turned(pose, (1, 2, 3), 0.005, (0.003, -0.003, 0.002)) for name, pose in exact.items()}
    for view in draw_views(told=told):
        mended = calibrate_view(view).pose
        corners = np.array([[x, y, 0.0, 1.0] for x in (0.3, 0.8) for y in (-0.35, 0.35)])
        before = (view.transform_camera_to_world @ np.linalg.inv(exact[view.name]) @ corners.T).T - corners
        after = (mended @ np.linalg.inv(exact[view.name]) @ corners.T).T - corners
        assert np.abs(after).max() < 0.0015
        assert np.abs(after).max() < 0.5 * np.abs(before).max()


def test_objects_do_not_tilt_the_table(draw_views: Callable[..., tuple[RgbdView, ...]]) -> None:
    """A box over an eighth of the table leaves the fitted height of the table right to 0.5 mm."""
    box = ((np.array([0.3, -0.3, 0.0]), np.array([0.5, 0.0, 0.2])), (20, 200, 30))
    for view in draw_views([box]):
        ready = calibrate_view(view)
        assert abs(ready.pose[2, 3] - view.transform_camera_to_world[2, 3]) < 0.0005


def test_projection_inverts_back_projection(draw_views: Callable[..., tuple[RgbdView, ...]]) -> None:
    """Projecting a pixel's point gives the pixel back."""
    for view in draw_views():
        ready = calibrate_view(view)
        rows, columns = np.nonzero(ready.measured)
        chosen = slice(None, None, 997)
        u, v, depth = ready.project(ready.points[rows[chosen], columns[chosen]].astype(float))
        np.testing.assert_allclose(u, columns[chosen], atol=0.02)
        np.testing.assert_allclose(v, rows[chosen], atol=0.02)
        np.testing.assert_allclose(depth, ready.depth[rows[chosen], columns[chosen]], atol=1e-4)
