"""Pieces of the figures; the figures themselves take minutes and are drawn by `make figures`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from bench.figures.__main__ import FIGURES, main
from bench.figures.drawing import picture, save, sheet, typeset, words
from bench.figures.graph_to_constraints import adjustment_lines, around
from bench.figures.traced_run import first_run
from kb.constraint import Adjustment
from kb.errors import EnvironmentFaultError
from kb.scene_graph import SceneGraph, SceneNode
from sim.scene_file import load_scene

ROOT = Path(__file__).parents[2]
SCENES = sorted((ROOT / "bench" / "figures" / "scenes").glob("*.yaml"))


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_scenes_of_the_figures_are_valid(path: Path) -> None:
    """They load as any scene file and protect a neighbour, as the figures say."""
    task = load_scene(str(path)).task
    assert task is not None
    assert [item.kind for item in task.required] == ["collision"]


def test_every_figure_is_in_the_documentation() -> None:
    """`make figures` has been run: each of the five pictures is there."""
    assert len(FIGURES) == 5
    assert [name for name in FIGURES if not (ROOT / "docs" / "images" / f"{name}.png").is_file()] == []


def test_unknown_figures_are_named_with_the_known_ones(capsys: pytest.CaptureFixture[str]) -> None:
    """One line, exit code 2."""
    with pytest.raises(SystemExit) as stopped:
        main(["sistem"])
    assert stopped.value.code == 2
    assert 'unknown figure "sistem" (valid: system_overview, ' in capsys.readouterr().err


def test_a_drawing_has_the_same_bytes_twice(tmp_path: Path) -> None:
    """Nothing of time or machine goes into the file."""
    files: list[bytes] = []
    for name in ("a.png", "b.png"):
        figure, axis = sheet(3.0, 2.0)
        words(axis, 0.2, 0.2, "same → bytes")
        picture(axis, np.full((4, 6, 3), 90, np.uint8), 0.2, 0.6, 1.5)
        files.append(save(figure, tmp_path / name).read_bytes())
    assert files[0] == files[1]


def test_long_text_is_cut_with_dots() -> None:
    """At most the lines that there is room for; the height says how many."""
    _, axis = sheet(3.0, 2.0)
    one = words(axis, 0.0, 0.0, "word")
    assert words(axis, 0.0, 0.0, "word " * 50, wrap=10, most=3) == pytest.approx(3 * one)
    assert axis.texts[-1].get_text().endswith("…")


def test_signs_are_set_as_in_print() -> None:
    """The agent writes plain signs."""
    assert typeset("type power -> pinch, force x 0.9, +- 1 cm") == "type power → pinch, force × 0.9, ± 1 cm"


def test_adjustment_in_words() -> None:
    """Only what changes is listed, with units."""
    node = SceneNode(
        id="obj_1",
        category="cube",
        position=(0.5, 0.0, 0.1),
        state="stacked",
        fragility=0.0,
        size=(0.1, 0.1, 0.1),
        yaw=0.0,
    )
    change = Adjustment(force_scale=0.8, standoff=0.03, remove_first=("obj_1",), away=(0.0, 0.3, 0.0))
    assert adjustment_lines(change, SceneGraph(nodes=(node,), edges=())) == [
        "hand turned away from azimuth 90°",
        "force f × 0.8",
        "stand-off h + 30 mm",
        "first take away the cube",
    ]
    assert adjustment_lines(Adjustment(), SceneGraph(nodes=(), edges=())) == ["nothing"]


def test_no_fitting_run_is_said_with_its_seeds(monkeypatch: pytest.MonkeyPatch) -> None:
    """A figure is never drawn from a run that does not show what it says."""

    class Run:
        result = None

    monkeypatch.setattr("bench.figures.traced_run.trace", lambda *_: Run())
    with pytest.raises(EnvironmentFaultError, match="none of the seeds 10000 to 10002 of my_scene"):
        first_run("my_scene", "pick it up", lambda _: False, most=3)


def test_the_part_of_a_picture_around_the_objects_keeps_its_shape() -> None:
    """Height over width is as asked, the part lies inside, and it holds the objects."""
    from tests.percept_fixtures import percept, thing

    seen = percept(thing("obj_0", "cup", 0.5, 0.1))
    view = _view()
    pixels = np.zeros((960, 1280, 3), np.uint8)
    part = around(pixels, view, seen)
    assert part.shape[0] / part.shape[1] == pytest.approx(0.75, abs=0.01)
    assert part.shape[1] <= 1280


def _view() -> object:
    """A camera 1 m above the table that looks down."""
    from kb.rgbd import RgbdView

    pose = np.eye(4)
    pose[:3, :3] = np.diag([1.0, -1.0, -1.0])
    pose[:3, 3] = (0.5, 0.0, 1.0)
    return RgbdView("front", np.zeros((480, 640, 3), np.uint8), np.ones((480, 640), np.float32), 500.0, pose)
