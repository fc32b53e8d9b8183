"""Pictures for people: what is painted is what is there, by either way of painting."""

from __future__ import annotations

import numpy as np
import pytest

from sim.draw_scene import draw_scene
from sim.picture import DRAFT, PictureMaker
from sim.picture_opengl import NoOpenGLError, open_context
from sim.picture_rays import FINE, RayPainter
from sim.scene_file import load_scene
from sim.viewpoint import OVERVIEW, Viewpoint
from sim.visual_model import visual_model
from sim.world import World

ABOVE = Viewpoint(eye=(0.55, 0.0, 1.6), target=(0.551, 0.0, 0.0), fovy=30.0)
"""Looks straight down on the table."""


@pytest.fixture(scope="module")
def world() -> World:
    """A cube on the table."""
    return World(draw_scene(load_scene("single_cube"), 0))


def pixel_of(viewpoint: Viewpoint, point: np.ndarray, width: int, height: int) -> tuple[int, int]:
    """Row and column at which a world point appears, found from the rays themselves."""
    rows, columns = np.mgrid[0:height, 0:width]
    rays = viewpoint.rays(np.stack([columns.ravel(), rows.ravel()], 1).astype(float), width, height)
    towards = point - np.asarray(viewpoint.eye)
    best = int(np.argmax(rays @ (towards / np.linalg.norm(towards))))
    return divmod(best, width)


def test_the_visual_model_has_the_joints_of_the_physical_one(world: World) -> None:
    """A state of the physics fits the pictures' model unchanged: the same joints at the same addresses."""
    model = visual_model(world.placed)
    assert model.nq == world.model.nq
    names = [world.model.joint(i).name for i in range(world.model.njnt)]
    assert [model.joint(i).name for i in range(model.njnt)] == names
    assert np.array_equal(model.jnt_qposadr, world.model.jnt_qposadr)


def test_ray_cast_pictures_show_an_object_where_it_stands(world: World) -> None:
    """Moving the cube moves the pixels that change to where it was and where it is."""
    with PictureMaker(world.placed, "raycast") as maker:
        before = maker.picture(world.data.qpos, ABOVE, 160, 90, DRAFT).astype(int)
        qpos = world.data.qpos.copy()
        start = world.model.joint("cube").qposadr[0]
        old = qpos[start : start + 3].copy()
        qpos[start : start + 3] = new = old + np.array([0.0, -0.12 if old[1] > 0 else 0.12, 0.0])
        after = maker.picture(qpos, ABOVE, 160, 90, DRAFT).astype(int)
    changed = np.abs(after - before).max(axis=2) > 12
    for place in (old, new):
        row, column = pixel_of(ABOVE, place + np.array([0.0, 0.0, 0.025]), 160, 90)
        assert changed[row, column]
    assert changed.mean() < 0.2


def test_ray_cast_pictures_repeat_exactly(world: World) -> None:
    """The same state gives the same bytes, however many threads cast."""
    with PictureMaker(world.placed, "raycast") as maker:
        first = maker.picture(world.data.qpos, OVERVIEW, 96, 54, FINE)
        data = maker._data
        one = RayPainter(maker.model, threads=1)
        second = one.paint(data, OVERVIEW, 96, 54, FINE)
        one.close()
    assert np.array_equal(first, second)


def test_the_robot_is_painted_white_in_front_of_the_backdrop(world: World) -> None:
    """The forearm's pixels are bright and grey, unlike the wooden table."""
    with PictureMaker(world.placed, "raycast") as maker:
        picture = maker.picture(world.data.qpos, OVERVIEW, 320, 180, DRAFT)
        link = maker._data.body("robot/link4").xpos.copy()
        table = np.array([0.75, -0.3, 0.0])
        robot_pixel = picture[pixel_of(OVERVIEW, link, 320, 180)].astype(int)
        table_pixel = picture[pixel_of(OVERVIEW, table, 320, 180)].astype(int)
    assert robot_pixel.min() > 110
    assert np.ptp(robot_pixel) < 25
    assert np.abs(robot_pixel - table_pixel).max() > 15


def test_collision_shapes_are_not_painted(world: World) -> None:
    """Only visual meshes, objects and the setting are seen: hiding the robot's capsules changes no pixel."""
    model = visual_model(world.placed)
    with PictureMaker(world.placed, "raycast") as maker:
        first = maker.picture(world.data.qpos, OVERVIEW, 96, 54, DRAFT)
        data = maker._data
        model.geom_rgba[model.geom_group == 3] = (1.0, 0.0, 0.0, 1.0)
        painter = RayPainter(model)
        second = painter.paint(data, OVERVIEW, 96, 54, DRAFT)
        painter.close()
    assert np.array_equal(first, second)


def test_without_opengl_pictures_are_ray_cast(world: World, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where no backend may be used, the maker falls back; asking for OpenGL by name says why there is none."""
    monkeypatch.setenv("RAGVLM_OPENGL", "disable")
    with PictureMaker(world.placed) as maker:
        assert maker.kind == "raycast"
    with pytest.raises(NoOpenGLError, match="disable"):
        PictureMaker(world.placed, "opengl")


def test_opengl_paints_the_same_scene_where_there_is_one(world: World) -> None:
    """Both ways of painting agree on where the table ends: their brightness edges fall on the same pixels."""
    try:
        context, _ = open_context(64, 64)
        context.free()
    except NoOpenGLError as error:
        pytest.skip(str(error))
    with PictureMaker(world.placed, "opengl") as maker:
        drawn = maker.picture(world.data.qpos, ABOVE, 160, 120).astype(float)
    with PictureMaker(world.placed, "raycast") as maker:
        cast = maker.picture(world.data.qpos, ABOVE, 160, 120, DRAFT).astype(float)
    middle = (slice(40, 80), slice(60, 100))
    warm = [picture[middle][..., 0].mean() - picture[middle][..., 2].mean() for picture in (drawn, cast)]
    corner = [picture[:6, :6].std() for picture in (drawn, cast)]
    assert np.sign(warm[0]) == np.sign(warm[1])
    assert max(corner) < 30
    assert np.corrcoef(drawn.mean(axis=2).ravel(), cast.mean(axis=2).ravel())[0, 1] > 0.6
