"""Laws of the ray-cast cameras."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import mujoco
import numpy as np
import pytest

from sim.camera_noise import noisy_depth, smooth_field
from sim.cameras import FRONT, TOP, capture, capture_all, cast, draw_cameras
from sim.placed import CameraDraw, PlacedScene

TINY = """
<mujoco><worldbody>
  <geom name="floor" type="plane" size="0 0 .1" pos="0 0 -0.75"/>
  <geom name="table" type="box" size=".3 .4 .02" pos="0.55 0 -0.02" rgba="0.7 0.6 0.5 1"/>
  <geom name="ball" type="sphere" size="0.04" pos="0.5 0.1 0.04" rgba="0.9 0.1 0.1 1"/>
  <body name="glass"><geom name="glass" type="box" size="0.03 0.03 0.05" pos="0.6 -0.15 0.05" rgba="0.8 0.9 0.9 0.4"/></body>
</worldbody></mujoco>
"""
SCENE = PlacedScene(name="tiny", seed=0, objects=(), light=(0.0, 0.0, 1.0), ambient=0.5)


@pytest.fixture(scope="module")
def world() -> tuple[Any, Any]:
    model = mujoco.MjModel.from_xml_string(TINY)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


@pytest.mark.parametrize("camera", [FRONT, TOP], ids=lambda camera: camera.name)
def test_back_projected_points_lie_on_the_surfaces(world: tuple[Any, Any], camera: CameraDraw) -> None:
    """Without noise the points of a picture lie on the very surfaces that were met, to 0.01 mm."""
    model, data = world
    image = cast(model, data, camera, SCENE)
    points = capture(model, data, camera, SCENE, np.random.default_rng(0), noise=0.0).points_w()
    ball = points[image.geom == model.geom("ball").id]
    assert len(ball) > 500
    assert np.abs(np.linalg.norm(ball - [0.5, 0.1, 0.04], axis=1) - 0.04).max() < 1e-5
    top = points[image.geom == model.geom("table").id]
    on_top = top[top[:, 2] > -0.001]
    assert len(on_top) > 50_000
    assert np.abs(on_top[:, 2]).max() < 1e-5


def test_the_whole_table_is_seen_by_both_cameras(world: tuple[Any, Any]) -> None:
    """Both nominal cameras see points within 5 mm of each corner of the table."""
    model, data = world
    for camera in (FRONT, TOP):
        points = capture(model, data, camera, SCENE, np.random.default_rng(0), noise=0.0).points_w().reshape(-1, 3)
        for corner in ((0.25, 0.4), (0.25, -0.4), (0.85, 0.4), (0.85, -0.4)):
            distance = np.linalg.norm(points - [*corner, 0.0], axis=1)
            assert np.nanmin(distance) < 0.005, (camera.name, corner)


def test_only_rays_that_can_matter_are_cast(world: tuple[Any, Any]) -> None:
    """Leaving out the rays that miss the table's volume changes no pixel that shows something on the table."""
    model, data = world
    for camera in (FRONT, TOP):
        part, whole = (cast(model, data, camera, SCENE, whole=flag) for flag in (False, True))
        things = np.isin(whole.geom, [model.geom(name).id for name in ("table", "ball", "glass")])
        assert np.array_equal(part.geom[things], whole.geom[things])
        assert np.allclose(part.depth, whole.depth, atol=1e-5)


def test_glass_shows_what_is_behind_and_loses_half_of_its_depth(world: tuple[Any, Any]) -> None:
    """A see-through pixel mixes its colour with what lies behind, and half of such pixels have no depth."""
    model, data = world
    image = cast(model, data, TOP, SCENE)
    glass = image.geom == model.geom("glass").id
    assert np.array_equal(glass, image.through)
    seen = image.rgb[glass][0]
    assert np.allclose(seen, 0.4 * np.array([0.8, 0.9, 0.9]) + 0.6 * np.array([0.7, 0.6, 0.5]), atol=0.02)
    view = capture(model, data, TOP, SCENE, np.random.default_rng(1))
    assert 0.45 < (view.depth[glass] == 0).mean() < 0.55


def test_noise_has_the_stated_size(world: tuple[Any, Any]) -> None:
    """On a flat surface the depth error has the standard deviation of 2 mm and 1.5 mm together, and no bias."""
    model, data = world
    image = cast(model, data, TOP, SCENE)
    table = image.geom == model.geom("table").id
    errors = []
    for seed in range(8):
        view = capture(model, data, TOP, SCENE, np.random.default_rng(seed))
        keep = table & (view.depth > 0)
        errors.append((view.depth - image.depth)[keep])
    error = np.concatenate(errors)
    assert error.std() == pytest.approx(0.0025, rel=0.15)
    assert abs(error.mean()) < 3e-4


def test_noise_is_smooth_where_it_says_so() -> None:
    """Neighbouring pixels of the smooth field hardly differ; far ones are independent."""
    field = smooth_field((480, 640), np.random.default_rng(0))
    assert np.abs(np.diff(field, axis=1)).max() < 0.15
    assert field.std() == pytest.approx(1.0, abs=0.3)


def test_no_noise_gives_the_truth_back() -> None:
    """Scale zero returns the depth unchanged and draws nothing."""
    depth = np.linspace(0.0, 2.0, 12, dtype=np.float32).reshape(3, 4)
    rng = np.random.default_rng(0)
    assert np.array_equal(noisy_depth(depth, np.ones((3, 4), bool), rng, 0.0), depth)
    assert rng.random() == np.random.default_rng(0).random()


def test_same_seed_same_picture(world: tuple[Any, Any]) -> None:
    """Pictures taken in threads depend on the generator's seed alone, bit for bit."""
    model, data = world
    one, two = (capture_all(model, data, (FRONT, TOP), SCENE, np.random.default_rng(5)) for _ in range(2))
    for a, b in zip(one, two, strict=True):
        assert a.rgb.tobytes() == b.rgb.tobytes()
        assert a.depth.tobytes() == b.depth.tobytes()


def test_scene_scales_the_noise(world: tuple[Any, Any]) -> None:
    """A scene without camera noise gives exact pictures."""
    model, data = world
    view = capture(model, data, TOP, replace(SCENE, noise=0.0), np.random.default_rng(0))
    assert np.array_equal(view.depth, cast(model, data, TOP, SCENE).depth)


def test_cameras_jitter_and_residual_have_the_stated_size() -> None:
    """True poses stray 5 mm and 1 degree (rms) from nominal, told ones 1 mm and 0.1 degree from the true ones."""
    shifts, turns, residuals = [], [], []
    for seed in range(200):
        for drawn, nominal in zip(draw_cameras(np.random.default_rng(seed)), (FRONT, TOP), strict=True):
            shifts.append(np.linalg.norm(drawn.true_pose[:3, 3] - nominal.true_pose[:3, 3]))
            residuals.append(np.linalg.norm(drawn.told_pose[:3, 3] - drawn.true_pose[:3, 3]))
            relative = drawn.true_pose[:3, :3].T @ nominal.true_pose[:3, :3]
            turns.append(np.arccos(np.clip((np.trace(relative) - 1) / 2, -1, 1)))
            assert np.allclose(drawn.true_pose[:3, :3] @ drawn.true_pose[:3, :3].T, np.eye(3), atol=1e-9)

    def rms(values: list[Any]) -> float:
        return float(np.sqrt(np.mean(np.square(values))))

    assert rms(shifts) == pytest.approx(0.005, rel=0.1)
    assert rms(residuals) == pytest.approx(0.001, rel=0.1)
    assert np.degrees(rms(turns)) == pytest.approx(1.0, rel=0.1)
