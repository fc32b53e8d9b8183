"""A knowledge base that is damaged, cut off, foreign or absent: one line, exit code 2 or 3, the file untouched."""

from __future__ import annotations

from pathlib import Path

import pytest

from app.command_line import run_command_line
from kb.store import ExperienceStore


def said(words: list[str], capsys: pytest.CaptureFixture[str]) -> tuple[int, str]:
    """Exit code and standard error of a command."""
    code = run_command_line(words)
    return code, capsys.readouterr().err


NAMES = (
    "cut off in a line", "cut off between lines", "rubbish", "out of range", "foreign version", "foreign format", "empty",
    "another embedder inside", "twice the same",
)  # fmt: skip


def damaged(good: str, name: str) -> tuple[str, str]:
    """Content with that fault, and words that must be said."""
    lines = good.splitlines(keepends=True)
    other = lines[1].replace('"embedder": "shape-colour-1"', '"embedder": "x"')
    faults = {
        "cut off in a line": (good[: len(good) // 2], "damaged line"),
        "cut off between lines": ("".join(lines[:50]), "49 experiences instead of 116"),
        "rubbish": ("".join([*lines[:9], "rubbish\n", *lines[10:]]), ":10: damaged line"),
        "out of range": (good.replace('"n_success": 10', '"n_success": 99', 1), "99 successes of 10"),
        "foreign version": (good.replace('"schema_version": 1', '"schema_version": 7', 1), "schema version 7"),
        "foreign format": (good.replace("ragvlm-experiences", "something", 1), "no knowledge base of ours"),
        "empty": ("", "empty"),
        "another embedder inside": ("".join([lines[0], other, *lines[2:]]), "'x'"),
        "twice the same": ("".join([*lines, lines[1]]), "already in line 2"),
    }
    return faults[name]


@pytest.mark.parametrize("name", NAMES)
def test_each_fault_is_one_line(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """`kb show` on a damaged copy ends with exit 2, one line that says where, and does not touch the file."""
    path = tmp_path / "kb.jsonl"
    ExperienceStore.open().save(path)
    content, words = damaged(path.read_text(), name)
    path.write_text(content)
    found, error = said(["kb", "show", "--store", str(path)], capsys)
    assert (found, error.count("\n")) == (2, 1)
    assert words in error
    assert "Traceback" not in error
    assert path.read_text() == content


def test_an_absent_or_binary_file_is_bad_input(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Nothing where the caller says, or bytes that are no text: exit 2 with the mend in one line."""
    binary = tmp_path / "kb.jsonl"
    content = bytes(range(256))
    binary.write_bytes(content)
    for path in (tmp_path / "nothing.jsonl", binary):
        code, error = said(["kb", "show", "--store", str(path)], capsys)
        assert (code, error.count("\n")) == (2, 1)
        assert str(path) in error
        assert "kb build" in error
    assert binary.read_bytes() == content


def test_a_shipped_file_that_is_gone_is_an_environment_fault(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without a path nobody named a wrong one: the installation is damaged, exit 3."""
    monkeypatch.setattr("kb.store.resources.files", lambda _: tmp_path)
    code, error = said(["kb", "show"], capsys)
    assert (code, error.count("\n")) == (3, 1)
    assert "restore the file" in error


def test_a_file_that_cannot_be_written_keeps_its_content(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """If the replacing file cannot be made, adding an experience fails in one line and the old file is whole."""
    from kb.errors import EnvironmentFaultError

    path = tmp_path / "kb.jsonl"
    ExperienceStore.open().save(path)
    content, store = path.read_bytes(), ExperienceStore.open(path)

    def refuse(*_: object, **__: object) -> tuple[int, str]:
        raise OSError(30, "Read-only file system")

    monkeypatch.setattr("kb.store_file.tempfile.mkstemp", refuse)
    entry = store.all()[0].model_copy(update={"id": "new"})
    with pytest.raises(EnvironmentFaultError, match="cannot write the knowledge base"):
        store.add(entry)
    assert path.read_bytes() == content
    assert len(store) == 116
