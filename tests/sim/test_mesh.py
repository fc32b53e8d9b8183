"""The user's own objects: repair, cutting, cache, and files that must not be read."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

from kb.errors import BadInputError
from sim.build_model import build_model
from sim.draw_scene import draw_scene
from sim.mesh import cache_folder, convex_pieces, hull_volumes, pieces_of
from sim.placed import PlacedObject
from sim.scene_file import load_scene

BODY = '<mujoco>{extra}<worldbody><body pos="0 0 1"><freejoint/>{geom}</body></worldbody></mujoco>'
BOX = '<geom type="box" size="0.02 0.03 0.01"/>'


@pytest.fixture(autouse=True)
def _own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


def block(size: tuple[float, float, float], shift: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> str:
    """OBJ text of a box with every triangle's corners written out on their own, so that nothing is shared."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float) * size + shift
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [(a, b, c) for a, b, c, d in quads for a, b, c in ((a, b, c), (a, c, d))]
    lines = [f"v {x} {y} {z}" for triangle in triangles for x, y, z in corners[list(triangle)]]
    return "\n".join([*lines, *(f"f {3 * k + 1} {3 * k + 2} {3 * k + 3}" for k in range(len(triangles)))])


def shifted(obj: str, by: int) -> str:
    """The same OBJ faces with vertex numbers raised, to stand behind another mesh."""
    rows = [row.split() for row in obj.splitlines()]
    return "\n".join(" ".join([r[0], *(str(int(n) + by) for n in r[1:])]) if r[0] == "f" else " ".join(r) for r in rows)


def scene(folder: Path, keys: str) -> str:
    path = folder / "scene.yaml"
    path.write_text(f"name: t\nobjects:\n  - id: mine\n    position: [0.5, 0.1]\n    {keys}\n", encoding="utf-8")
    return str(path)


def drawn(folder: Path, keys: str) -> PlacedObject:
    placed = draw_scene(load_scene(scene(folder, keys)), 0)
    build_model(placed)
    return placed.objects[0]


def test_a_box_mesh_becomes_one_piece_of_the_right_size(tmp_path: Path) -> None:
    """A 4 x 5 x 6 cm box given in millimetres, far from the origin, stands on the table with its true size and mass."""
    (tmp_path / "b.obj").write_text(block((40, 50, 60), (500, -20, 7)))
    thing = drawn(tmp_path, "mesh: ./b.obj\n    scale: 0.001\n    mass: 0.25\n    color: [0.2, 0.4, 0.8]")
    assert len(thing.geoms) == 1
    assert thing.size == pytest.approx((0.04, 0.05, 0.06))
    assert thing.mass == 0.25
    assert thing.geoms[0].rgba[:3] == (0.2, 0.4, 0.8)
    assert thing.position[:2] == pytest.approx((0.5, 0.1), abs=1e-3)
    assert thing.category == "unknown"


def test_y_up_meshes_are_turned_upright(tmp_path: Path) -> None:
    """With `up: y` the mesh's y extent becomes the height."""
    (tmp_path / "b.obj").write_text(block((0.04, 0.08, 0.05)))
    assert drawn(tmp_path, "mesh: b.obj\n    up: y").size == pytest.approx((0.04, 0.05, 0.08))


def test_several_closed_pieces_are_allowed(tmp_path: Path) -> None:
    """Two boxes in one file become two convex pieces; the mass is shared by volume."""
    lower = block((0.06, 0.06, 0.02))
    upper = block((0.03, 0.06, 0.04), (0.0, 0.0, 0.02))
    (tmp_path / "two.obj").write_text(lower + "\n" + shifted(upper, 36))
    thing = drawn(tmp_path, "mesh: two.obj\n    mass: 0.3")
    assert len(thing.geoms) == 2
    assert sorted(geom.mass for geom in thing.geoms) == pytest.approx([0.15, 0.15], rel=1e-3)


def test_holes_are_filled() -> None:
    """A box without its lid has the volume of the closed box."""
    rows = block((0.04, 0.04, 0.04)).splitlines()
    vertices = np.array([[float(v) for v in row.split()[1:]] for row in rows if row.startswith("v")])
    faces = np.arange(len(vertices)).reshape(-1, 3)[:-2]
    pieces = pieces_of(vertices, faces, "here")
    assert sum(hull_volumes(pieces)) == pytest.approx(0.04**3, rel=1e-6)


def test_concave_meshes_are_cut_and_cached() -> None:
    """An L-shaped block is cut into pieces that together have its volume, not its hull's; the second time from the cache."""
    profile = np.array([[0, 0], [0.08, 0], [0.08, 0.02], [0.02, 0.02], [0.02, 0.08], [0, 0.08]])
    blob = _extruded(profile, 0.03)
    pieces = convex_pieces(blob, ".stl", "here")
    volume = (0.08 * 0.02 + 0.06 * 0.02) * 0.03
    assert len(pieces) >= 2
    assert sum(hull_volumes(pieces)) == pytest.approx(volume, rel=0.1)
    entries = list(cache_folder().iterdir())
    assert [entry.suffix for entry in entries] == [".npz"]
    again = convex_pieces(blob, ".stl", "here")
    assert all(np.array_equal(a, b) for a, b in zip(pieces, again, strict=True))


def _extruded(profile: np.ndarray, height: float) -> bytes:
    """Binary STL of an upright prism over an L-shaped outline whose corner 0 sees every other corner."""
    low = np.column_stack([profile, np.zeros(len(profile))])
    high = low + np.array([0, 0, height])
    n = len(profile)
    triangles = [(high[0], high[k], high[k + 1]) for k in range(1, n - 1)]
    triangles += [(low[0], low[k + 1], low[k]) for k in range(1, n - 1)]
    for k in range(n):
        j = (k + 1) % n
        triangles += [(low[k], low[j], high[j]), (low[k], high[j], high[k])]
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *np.concatenate(t), 0) for t in triangles)
    return b"\0" * 80 + struct.pack("<I", len(triangles)) + body


def test_a_broken_cache_entry_is_made_anew() -> None:
    """A damaged cache file is ignored and replaced."""
    blob = block((0.04, 0.04, 0.04)).encode()
    first = convex_pieces(blob, ".obj", "here")
    entry = next(cache_folder().iterdir())
    entry.write_bytes(b"broken")
    assert np.array_equal(convex_pieces(blob, ".obj", "here")[0], first[0])
    assert entry.read_bytes() != b"broken"


def test_mjcf_bodies_are_taken_over(tmp_path: Path) -> None:
    """A free MJCF body keeps its pieces and its mass and stands with its lowest point on the table."""
    geoms = BOX + '<geom type="cylinder" size="0.01 0.03" pos="0 0 0.04"/>'
    (tmp_path / "t.xml").write_text(BODY.format(extra="", geom=geoms))
    thing = drawn(tmp_path, "mjcf: t.xml")
    assert [geom.type for geom in thing.geoms] == ["box", "cylinder"]
    assert thing.size == pytest.approx((0.04, 0.06, 0.08), abs=1e-3)
    assert thing.mass == pytest.approx(1000 * (0.04 * 0.06 * 0.02 + np.pi * 0.01**2 * 0.06), rel=1e-3)


@pytest.mark.parametrize(
    ("keys", "says"),
    [
        ("mesh: missing.obj", "no file"),
        ("mesh: ../out.obj", "leads out"),
        ("mesh: sub/../../out.obj", "leads out"),
        ("mesh: /etc/passwd", "leads out"),
        ("mesh: link.obj", "leads out"),
        ("mesh: thing.txt", "not of a known kind"),
        ("mesh: flat.obj", "no volume"),
        ("mesh: junk.obj", "cannot be read"),
        ("mesh: empty.stl", "mesh"),
        ("mesh: big.obj", "0.2 to 60 cm"),
        ("mesh: huge.obj", "50"),
        ("mesh: good.obj\n    mass: 0", "greater than 0"),
        ("mjcf: include.xml", "leads out"),
        ("mjcf: meshdir.xml", "leads out"),
        ("mjcf: absolute.xml", "leads out"),
        ("mjcf: entity.xml", "not allowed"),
        ("mjcf: hinge.xml", "free joint"),
        ("mjcf: broken.xml", "malformed XML"),
        ("mjcf: wrong.xml", "does not compile"),
    ],
)
def test_unusable_files_are_refused_by_name_with_the_line(tmp_path: Path, keys: str, says: str) -> None:
    """Missing, foreign, flat, broken or escaping files give one line with file, line and object; nothing is cached."""
    outside = tmp_path / "out.obj"
    outside.write_text(block((0.04, 0.04, 0.04)))
    folder = tmp_path / "scene"
    folder.mkdir()
    (folder / "link.obj").symlink_to(outside)
    (folder / "good.obj").write_text(block((0.04, 0.04, 0.04)))
    (folder / "thing.txt").write_text("x")
    (folder / "flat.obj").write_text("v 0 0 0\nv .1 0 0\nv 0 .1 0\nf 1 2 3\n")
    (folder / "junk.obj").write_text("v 1 2\nf 1 2 9\n")
    (folder / "empty.stl").write_bytes(b"")
    (folder / "big.obj").write_text(block((40, 40, 40)))
    with open(folder / "huge.obj", "wb") as file:
        file.truncate(50_000_001)
    (folder / "include.xml").write_text(BODY.format(extra='<include file="../out.xml"/>', geom=BOX))
    (folder / "meshdir.xml").write_text(BODY.format(extra='<compiler meshdir="../"/>', geom=BOX))
    mesh = '<asset><mesh name="m" file="/etc/passwd"/></asset>'
    (folder / "absolute.xml").write_text(BODY.format(extra=mesh, geom='<geom type="mesh" mesh="m"/>'))
    (folder / "entity.xml").write_text('<!DOCTYPE x [<!ENTITY a "b">]>' + BODY.format(extra="", geom=BOX))
    (folder / "hinge.xml").write_text(BODY.format(extra="", geom=BOX).replace("<freejoint/>", '<joint type="hinge"/>'))
    (folder / "broken.xml").write_text("<mujoco><worldbody>")
    (folder / "wrong.xml").write_text(BODY.format(extra="", geom='<geom type="bax" size="1"/>'))
    path = scene(folder, keys)
    with pytest.raises(BadInputError) as caught:
        draw_scene(load_scene(path), 0)
    message = str(caught.value)
    assert "\n" not in message
    assert message.startswith(f"{path}:")
    assert "'mine'" in message
    assert says in message
    assert not (tmp_path / "cache").exists()
