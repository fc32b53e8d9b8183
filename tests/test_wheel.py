"""The built wheel carries everything: it runs from its own files, away from this tree."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import venv
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
RUN = ["run", "pick up the cube", "--scene", "single_cube", "--seed", "11", "--json", "-"]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel of this tree, built without the network."""
    folder = tmp_path_factory.mktemp("wheel")
    build = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    subprocess.run(build, cwd=ROOT, check=True, capture_output=True)
    (built,) = folder.glob("*.whl")
    return built


def test_the_wheel_has_code_data_and_licence_but_no_tests(wheel: Path) -> None:
    """Every package file of the tree is in the wheel, the licence too, and nothing of the tests."""
    names = set(zipfile.ZipFile(wheel).namelist())
    rooms = ("agent", "app", "bench", "kb", "memory", "prompts", "sim", "tools")
    files = {str(p.relative_to(ROOT)) for room in rooms for p in (ROOT / room).rglob("*") if p.is_file()}
    assert {name for name in files if "__pycache__" not in name} - names == set()
    assert any(name.endswith("licenses/LICENSE") for name in names)
    assert not any(name.startswith(("tests/", "docs/")) for name in names)


def test_the_wheel_runs_from_its_own_files(wheel: Path, tmp_path: Path) -> None:
    """Unpacked elsewhere and run there, the command line finds its scenes, prompts and facts, and grasps a cube."""
    zipfile.ZipFile(wheel).extractall(tmp_path / "site")
    code = "import sys, agent, app.command_line as c; assert agent.__file__.startswith(sys.argv[1]), agent.__file__; "
    code += "sys.argv = ['ragvlm', *sys.argv[2:]]; c.main()"
    command = [sys.executable, "-c", code, str(tmp_path / "site"), *RUN]
    environment = {**os.environ, "PYTHONPATH": str(tmp_path / "site")}
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["success"] is True


@pytest.mark.long
def test_the_wheel_installs_into_a_fresh_environment(wheel: Path, tmp_path: Path) -> None:
    """With nothing but the wheel and what it depends on, `ragvlm` grasps a cube."""
    venv.create(tmp_path / "venv", with_pip=True)
    scripts = tmp_path / "venv" / "bin"
    subprocess.run([scripts / "python", "-m", "pip", "install", "--quiet", str(wheel)], check=True)
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    done = subprocess.run([scripts / "ragvlm", *RUN], cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["success"] is True
