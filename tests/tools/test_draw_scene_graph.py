"""The picture with marks and graph: boxes where the objects are, every relation said once."""

from __future__ import annotations

import numpy as np
import pytest

from kb.affordance import AffordanceDescriptor
from kb.percept import PerceivedObject, Percept
from kb.rgbd import RgbdView
from kb.scene_graph import SceneEdge, SceneGraph, SceneNode
from tools.draw_scene_graph import PALETTE, PANEL, box_corners, distinct_edges, draw_scene_graph, project

AFFORDANCE = AffordanceDescriptor(type="GRASPABLE_BODY", material="wood", fragility=0.0, region="body")


def thing(number: int, x: float, y: float, yaw: float = 0.0) -> PerceivedObject:
    """A wooden block of 6 x 4 x 4 cm on the table."""
    return PerceivedObject(
        id=f"obj_{number}", category="block", confidence=0.9, position=(x, y, 0.02), yaw=yaw, size=(0.06, 0.04, 0.04),
        shape="box", affordance=AFFORDANCE,
    )  # fmt: skip


@pytest.fixture
def view() -> RgbdView:
    """A grey picture from 1 m above the middle of the table, looking straight down, up in the picture is +x."""
    pose = np.eye(4)
    pose[:3, 0], pose[:3, 1], pose[:3, 2] = (0, -1, 0), (-1, 0, 0), (0, 0, -1)
    pose[:3, 3] = (0.5, 0.0, 1.0)
    grey = np.full((240, 320, 3), 128, np.uint8)
    return RgbdView("top", grey, np.ones((240, 320), np.float32), 300.0, pose)


def test_projection_undoes_back_projection(view: RgbdView) -> None:
    """Pixels of back-projected points are the pixels they came from."""
    points = view.points_w()
    rows, columns = np.mgrid[0:240:37, 0:320:41]
    pixels = project(view, points[rows, columns].reshape(-1, 3))
    assert np.allclose(pixels, np.stack([columns.ravel(), rows.ravel()], axis=1), atol=1e-6)


def test_points_behind_the_camera_have_no_pixel(view: RgbdView) -> None:
    """They are NaN, so that nothing is drawn at a mirrored place."""
    assert np.isnan(project(view, np.array([[0.5, 0.0, 2.0]]))).all()


def test_a_turned_box_keeps_its_sides() -> None:
    """The corners of a box turned by 90 degrees span its length along y."""
    corners = box_corners(thing(0, 0.5, 0.0, yaw=np.pi / 2))
    assert np.allclose(np.ptp(corners, axis=0), (0.04, 0.06, 0.04))
    assert np.allclose(corners.mean(axis=0), (0.5, 0.0, 0.02))


def test_marks_stand_on_their_objects_in_their_colours(view: RgbdView) -> None:
    """At the projected centre of each object there is a disc of its own colour, and nothing elsewhere."""
    percept = Percept(look=0, perception="rgbd", objects=(thing(0, 0.5, 0.1), thing(1, 0.5, -0.1)))
    picture = draw_scene_graph(view, percept, scale=2).astype(int)
    assert picture.shape == (480, 640, 3)
    for number, item in enumerate(percept.objects):
        x, y = project(view, np.array([item.position]))[0] * 2
        beside = picture[round(y) + 10, round(x)]
        assert np.abs(beside - PALETTE[number]).max() < 30
    assert (picture[:60] == 128).all()


def test_objects_out_of_sight_are_left_out(view: RgbdView) -> None:
    """An object behind the camera leaves the picture as it is."""
    behind = thing(0, 0.5, 0.0).model_copy(update={"position": (0.5, 0.0, 1.5)})
    picture = draw_scene_graph(view, Percept(look=0, perception="rgbd", objects=(behind,)), scale=1)
    assert (picture == 128).all()


def test_each_relation_is_said_once() -> None:
    """Of an edge and its inverse only the first is kept; directed relations stay."""
    edges = (
        SceneEdge(source="a", relation="LEFT_OF", target="b"),
        SceneEdge(source="b", relation="RIGHT_OF", target="a"),
        SceneEdge(source="a", relation="ADJACENT_TO", target="b", gap=0.02),
        SceneEdge(source="b", relation="ADJACENT_TO", target="a", gap=0.02),
        SceneEdge(source="b", relation="BLOCKS_APPROACH", target="a"),
    )
    kept = distinct_edges(SceneGraph(nodes=(), edges=edges))
    assert [(e.source, e.relation) for e in kept] == [
        ("a", "LEFT_OF"), ("a", "ADJACENT_TO"), ("b", "BLOCKS_APPROACH"),
    ]  # fmt: skip


def test_the_graph_is_drawn_between_the_marks_and_listed(view: RgbdView) -> None:
    """With a graph, the line between two marks changes pixels half-way, and a list stands beside the picture."""
    objects = (thing(0, 0.5, 0.15), thing(1, 0.5, -0.15))
    percept = Percept(look=0, perception="rgbd", objects=objects)
    nodes = tuple(
        SceneNode(id=o.id, category=o.category, position=o.position, state="empty", fragility=0.0, size=o.size, yaw=0.0)
        for o in objects
    )
    graph = SceneGraph(
        nodes=nodes, edges=(SceneEdge(source="obj_0", relation="ADJACENT_TO", target="obj_1", gap=0.24),)
    )
    bare = draw_scene_graph(view, percept, SceneGraph(nodes=nodes, edges=()), target="obj_0")
    drawn = draw_scene_graph(view, percept, graph, target="obj_0")
    assert drawn.shape == (480, 640 + PANEL, 3)
    middle = (project(view, np.array([[0.5, 0.0, 0.02]]))[0] * 2).round().astype(int)
    window = np.s_[middle[1] - 5 : middle[1] + 5, middle[0] - 60 : middle[0] + 60]
    assert (drawn[window] != bare[window]).any()
    assert (drawn[:, 640:] != bare[:, 640:]).any()
