"""The journal: whole rows or none after any cut, no mixing of runs, one writer."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from bench.job import Settings
from bench.journal import Journal
from kb.errors import BadInputError, EnvironmentFaultError
from tests.bench_fixtures import ANALYTIC, row


def _filled(folder: Path, count: int = 3) -> bytes:
    """A journal with some rows; returns the bytes on disk."""
    with Journal(folder, ANALYTIC) as journal:
        for trial in range(count):
            journal.append(row(trial).line)
    return (folder / "trials.jsonl").read_bytes()


def test_rows_are_kept(tmp_path: Path) -> None:
    """What was appended is known when the journal is opened again."""
    _filled(tmp_path)
    with Journal(tmp_path, ANALYTIC, resume=True) as journal:
        assert journal.done == {row(trial).key for trial in range(3)}
        assert journal.repaired == []


def test_cut_anywhere_leaves_whole_rows(tmp_path: Path) -> None:
    """Wherever a kill cuts the file, the rows before the cut are kept, the rest is taken away with a sentence."""
    content = _filled(tmp_path)
    ends = [i + 1 for i, byte in enumerate(content) if byte == ord("\n")]
    for cut in sorted({*range(0, len(content), 97), *(end + shift for end in ends for shift in (-1, 0))}):
        (tmp_path / "trials.jsonl").write_bytes(content[:cut])
        with Journal(tmp_path, ANALYTIC, resume=True) as journal:
            whole = sum(end <= cut for end in ends)
            assert len(journal.done) == whole
            assert bool(journal.repaired) == (cut not in (0, *ends))
        assert (tmp_path / "trials.jsonl").read_bytes() == content[: ends[whole - 1] if whole else 0]


def test_broken_and_doubled_lines_go(tmp_path: Path) -> None:
    """A line that is no row, and a second line of the same trial, are taken away with a sentence each."""
    lines = _filled(tmp_path).splitlines(keepends=True)
    (tmp_path / "trials.jsonl").write_bytes(b"".join([lines[0], b"{}\n", lines[1], lines[0], b"\x00\xff\n", lines[2]]))
    with Journal(tmp_path, ANALYTIC, resume=True) as journal:
        assert len(journal.done) == 3
        assert len(journal.repaired) == 3
    assert (tmp_path / "trials.jsonl").read_bytes() == b"".join(lines)


def test_doubled_rows_are_refused(tmp_path: Path) -> None:
    """The journal never writes a trial twice."""
    with Journal(tmp_path, ANALYTIC) as journal:
        journal.append(row().line)
        with pytest.raises(ValueError, match="written already"):
            journal.append(row().line)
        with pytest.raises(ValueError, match="written already"):
            journal.append(row(1).line, row(1).line)
        journal.append(row(1).line, row(2).line)
        journal.append()
    with Journal(tmp_path, ANALYTIC, resume=True) as journal:
        assert len(journal.done) == 3


def test_other_trials_need_resume(tmp_path: Path) -> None:
    """A folder with trials is refused without --resume, and stays as it is."""
    content = _filled(tmp_path)
    with pytest.raises(BadInputError, match="--resume"):
        Journal(tmp_path, ANALYTIC)
    assert (tmp_path / "trials.jsonl").read_bytes() == content


@pytest.mark.parametrize(
    "other", [Settings(), ANALYTIC.model_copy(update={"seed": 3}), ANALYTIC.model_copy(update={"perception": "rgbd"})]
)
def test_rows_of_other_settings_do_not_mix(tmp_path: Path, other: Settings) -> None:
    """Trials of another seed, evaluator or perception are refused even with --resume."""
    content = _filled(tmp_path)
    with pytest.raises(BadInputError, match="were run with"):
        Journal(tmp_path, other, resume=True)
    assert (tmp_path / "trials.jsonl").read_bytes() == content


def test_one_writer_at_a_time(tmp_path: Path) -> None:
    """A folder in use is refused; when its writer is gone, it is free."""
    with Journal(tmp_path, ANALYTIC), pytest.raises(BadInputError, match="another benchmark"):
        Journal(tmp_path, ANALYTIC, resume=True)
    Journal(tmp_path, ANALYTIC, resume=True).close()


def test_sessions_are_recorded(tmp_path: Path) -> None:
    """Each sitting stands in run.json, with those before it."""
    for number in range(2):
        with Journal(tmp_path, ANALYTIC, resume=number > 0) as journal:
            journal.append(row(number).line)
            journal.note_session({"wall_s": 1.5, "workers": 2})
    run = json.loads((tmp_path / "run.json").read_text(encoding="utf-8"))
    assert [session["wall_s"] for session in run["sessions"]] == [1.5, 1.5]
    assert run["settings"]["evaluator"] == "analytic"


def test_unwritable_folder_is_said(tmp_path: Path) -> None:
    """A place where no folder can be made is an environment fault with the mend."""
    (tmp_path / "file").write_text("", encoding="utf-8")
    with pytest.raises(EnvironmentFaultError, match="--out"):
        Journal(tmp_path / "file" / "below", ANALYTIC)
