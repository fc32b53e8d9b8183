"""Records: one real run is written to a folder, and `show` reads it back."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from app import record as record_module
from app.command_line import run_command_line
from app.record import colour_depth
from kb.run_result import RunResult
from sim import video


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A recorded run of the cube, with small pictures."""
    folder = tmp_path_factory.mktemp("runs") / "cube"
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("RAGVLM_OPENGL", "disable")
        patch.setattr(record_module, "PICTURE_SIZES", {"raycast": (96, 54)})
        patch.setattr(video, "SIZES", {"raycast": (96, 54)})
        patch.setattr(video, "MAX_FRAMES", {"raycast": 6})
        patch.setattr(video.shutil, "which", lambda _name: None)
        code = run_command_line(
            ["run", "pick up the cube", "--scene", "single_cube", "--perception", "oracle", "--record", str(folder)]
        )
    assert code == 0
    return folder


def test_a_record_holds_all_that_is_promised(recorded: Path) -> None:
    """Result, steps, forces, camera pictures, graph, last moment and video are there and can be opened."""
    names = {str(path.relative_to(recorded)) for path in recorded.rglob("*") if path.is_file()}
    cameras = {f"cameras/look_0_{name}.png" for name in ("front", "top", "front_depth", "front_marks", "graph")}
    assert names >= {"result.json", "trace.jsonl", "forces.json", "picture.png", "video.gif"} | cameras
    result = RunResult.model_validate_json((recorded / "result.json").read_text())
    assert result.success
    assert result.perception == "oracle"
    with Image.open(recorded / "video.gif") as film:
        assert film.n_frames >= 4
    with Image.open(recorded / "cameras" / "look_0_front.png") as picture:
        assert picture.size == (640, 480)


def test_the_trace_has_every_stage_in_order(recorded: Path) -> None:
    """Stages 0 to 7 occur, thought comes before action and action before observation."""
    rows = [json.loads(line) for line in (recorded / "trace.jsonl").read_text().splitlines()]
    assert {row["stage"] for row in rows} >= {0, 1, 2, 3, 4, 5, 6, 7}
    kinds = [row["kind"] for row in rows]
    assert kinds.index("thought") < kinds.index("action") < kinds.index("observation")
    assert kinds[-1] == "answer"


def test_the_forces_show_the_commanded_grip(recorded: Path) -> None:
    """During the hold the gripper presses with the force of the grasp."""
    rows = json.loads((recorded / "forces.json").read_text())
    held = [row["grip_n"] for row in rows if row["phase"] == "hold"]
    result = RunResult.model_validate_json((recorded / "result.json").read_text())
    grasp = result.goals[0].attempts[0].grasp
    assert grasp is not None
    assert np.median(held) == pytest.approx(grasp.force, rel=0.05)


def test_the_film_shows_motion(recorded: Path) -> None:
    """The first and the last frame differ: the robot has moved."""
    with Image.open(recorded / "video.gif") as film:
        first = np.asarray(film.convert("RGB")).astype(int)
        film.seek(film.n_frames - 1)
        last = np.asarray(film.convert("RGB")).astype(int)
    assert (np.abs(first - last).max(axis=2) > 40).mean() > 0.01


def test_show_reads_it_back(recorded: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Steps, verdict, forces and the list of files are printed; exit 0."""
    assert run_command_line(["show", str(recorded)]) == 0
    said = capsys.readouterr().out
    for word in ("Thought", "observed success", "gripper", "video.gif", "oracle perception"):
        assert word in said


def test_a_damaged_record_is_bad_input(recorded: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A line cut off at the end (a killed run) is left out; damage in the middle is named with its line."""
    lines = (recorded / "trace.jsonl").read_text().splitlines()
    (tmp_path / "trace.jsonl").write_text("\n".join([*lines[:3], lines[3][:20]]))
    assert run_command_line(["show", str(tmp_path)]) == 0
    assert "did not end" in capsys.readouterr().out
    (tmp_path / "trace.jsonl").write_text("\n".join([lines[0], "{damaged", lines[2]]))
    assert run_command_line(["show", str(tmp_path)]) == 2
    assert "line 2" in capsys.readouterr().err


def test_depth_is_coloured_by_distance() -> None:
    """Near is warm, far is cold, unmeasured is black."""
    depth = np.linspace(0.5, 1.5, 100, dtype=np.float32)[None].repeat(4, axis=0)
    depth[0, 0] = 0.0
    colour = colour_depth(depth).astype(int)
    assert colour[1, 0, 0] > colour[1, 0, 2]
    assert colour[1, -1, 2] > colour[1, -1, 0]
    assert (colour[0, 0] == 0).all()
