"""The doctor: healthy checks say so with numbers, sick ones say the mend, and the exit code follows."""

from __future__ import annotations

import json
from collections.abc import Callable

import pytest

from app import doctor_checks
from app.command_line import run_command_line
from app.doctor import Finding
from kb.errors import EnvironmentFaultError

EVERY = (
    "python", "packages", "kinematics", "reach", "cameras", "hold", "grip", "pictures", "video", "knowledge_base",
    "state_folder", "models",
)  # fmt: skip


@pytest.mark.parametrize("name", ["python", "packages", "kinematics", "reach", "cameras", "hold", "grip"])
def test_this_machine_passes_what_every_machine_must(name: str) -> None:
    """Interpreter, packages, kinematics, reach, cameras, standing still and gripping work wherever tests run."""
    finding = getattr(doctor_checks, name)()
    assert finding.ok, finding.says


def test_pictures_work_without_opengl(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without OpenGL the check passes, says that pictures are ray-cast, and names the Debian packages."""
    monkeypatch.setenv("RAGVLM_OPENGL", "disable")
    finding = doctor_checks.pictures()
    assert finding.ok
    assert "ray-cast" in finding.says
    assert "libosmesa6" in finding.mend
    assert "libegl1" in finding.mend


def healthy(monkeypatch: pytest.MonkeyPatch, **sick: Callable[[], Finding]) -> None:
    """Replaces every check: all are well except the given ones."""
    for name in EVERY:
        monkeypatch.setattr(doctor_checks, name, sick.get(name, lambda: Finding(True, "well")))


def test_all_well_is_exit_0(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """Nothing to mend."""
    healthy(monkeypatch)
    assert run_command_line(["doctor"]) == 0
    assert "everything that matters works" in capsys.readouterr().out


def test_a_failed_check_says_its_mend_and_gives_3(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """What a check raises becomes a finding with the mend, the others still run, and the exit code is 3."""

    def broken() -> Finding:
        raise EnvironmentFaultError("the file is gone", mend="restore it")

    healthy(monkeypatch, knowledge_base=broken)
    assert run_command_line(["doctor"]) == 3
    said = capsys.readouterr().out
    assert "the file is gone" in said
    assert "mend: " in said
    assert said.count("well") == len(EVERY) - 1


def test_missing_optional_models_are_no_failure(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The models extra is optional: its absence is said, with the mend, and the exit code stays 0."""
    healthy(monkeypatch, models=lambda: Finding(False, "not installed", "pip install"))
    assert run_command_line(["doctor", "--json"]) == 0
    rows = {row["check"]: row for row in json.loads(capsys.readouterr().out)}
    assert rows["models"] == {
        "check": "models", "ok": False, "says": "not installed", "mend": "pip install", "optional": True,
    }  # fmt: skip
