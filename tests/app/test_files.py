"""Files appear whole or not at all, and bad targets are refused before anything is made."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from app.files import refuse_unusable_folder, refuse_unwritable_file, write_atomically
from kb.errors import BadInputError


def test_a_write_replaces_the_file_and_leaves_nothing_else(tmp_path: Path) -> None:
    """After the write there is one file with the new content."""
    target = tmp_path / "result.json"
    target.write_text("old")
    write_atomically(target, "new")
    assert [path.name for path in tmp_path.iterdir()] == ["result.json"]
    assert target.read_text() == "new"


def test_a_failed_write_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """If the last step fails, the old content stands and no temporary file is left."""
    target = tmp_path / "result.json"
    target.write_text("old")

    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fchmod", fail)
    with pytest.raises(OSError, match="No space"):
        write_atomically(target, "new")
    assert [path.name for path in tmp_path.iterdir()] == ["result.json"]
    assert target.read_text() == "old"


def test_a_json_target_that_cannot_be_written_is_refused(tmp_path: Path) -> None:
    """A folder, and a file in a folder that does not exist, are refused; nothing is created."""
    for path, says in ((tmp_path, "is a folder"), (tmp_path / "no" / "x.json", "does not exist")):
        with pytest.raises(BadInputError, match=says):
            refuse_unwritable_file(path, where="--json")
    refuse_unwritable_file(tmp_path / "x.json", where="--json")
    assert list(tmp_path.iterdir()) == []


def test_a_record_never_mixes_with_other_files(tmp_path: Path) -> None:
    """New, empty and earlier record folders are fine; a folder with anything else is refused."""
    own = frozenset({"result.json"})
    refuse_unusable_folder(tmp_path / "new" / "deep", where="--record", own_files=own)
    assert not (tmp_path / "new").exists()
    refuse_unusable_folder(tmp_path, where="--record", own_files=own)
    (tmp_path / "thesis.tex").write_text("years of work")
    with pytest.raises(BadInputError, match="not empty"):
        refuse_unusable_folder(tmp_path, where="--record", own_files=own)
    (tmp_path / "result.json").write_text("{}")
    refuse_unusable_folder(tmp_path, where="--record", own_files=own)
    with pytest.raises(BadInputError, match="is a file"):
        refuse_unusable_folder(tmp_path / "thesis.tex", where="--record", own_files=own)
    with pytest.raises(BadInputError, match="cannot be written"):
        refuse_unusable_folder(tmp_path / "thesis.tex" / "x", where="--record", own_files=own)
