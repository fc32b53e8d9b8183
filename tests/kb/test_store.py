"""The store of experiences: file, index, errors."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from kb.errors import BadInputError, EnvironmentFaultError
from kb.store import ExperienceStore, cosine
from tests.experience_fixtures import DIM, make_entries, make_experience, make_store


@pytest.fixture(autouse=True)
def _own_cache(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("RAGVLM_CACHE", str(tmp_path / "cache"))


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "kb.jsonl"
    make_store(make_entries({"cup": (4, 1), "vase": (3, 1)}), path)
    return path


def test_a_saved_store_reads_back_equal(file: Path) -> None:
    """Header and entries survive the file, and saving again gives the same bytes."""
    store = ExperienceStore.open(file)
    assert store.all() == tuple(make_entries({"cup": (4, 1), "vase": (3, 1)}))
    before = file.read_bytes()
    store.save(file)
    assert file.read_bytes() == before


def test_the_shipped_store_opens_with_the_core_embedder() -> None:
    """Without a path the packaged file is read; its header names embedder and taxonomy."""
    store = ExperienceStore.open()
    assert store.embedder_name == "shape-colour-1"
    assert store.header.taxonomy == "g14-1"


def test_categories_are_found_through_the_index(file: Path) -> None:
    """`by_category` returns exactly the entries of the categories asked for, in file order."""
    store = ExperienceStore.open(file)
    assert [entry.id for entry in store.by_category("vase")] == ["vase_00", "vase_01", "vase_02"]
    assert len(store.by_category("vase", "cup")) == 7
    assert store.by_category("mug") == store.by_category() == ()


def test_visual_queries_equal_exact_search() -> None:
    """For 20 random queries over 116 entries the index with exact re-scoring gives the true ten nearest."""
    store = make_store()
    rng = np.random.default_rng(5)
    for query in rng.random((20, DIM)):
        exact = sorted(store.all(), key=lambda e: (-cosine(query, np.asarray(e.embedding)), e.id))[:10]
        found = store.query_visual(tuple(query), 10)
        assert [entry.id for entry, _ in found] == [entry.id for entry in exact]
        assert all(score == cosine(query, np.asarray(entry.embedding)) for entry, score in found)


def test_the_index_is_kept_under_the_contents_hash(file: Path, tmp_path: Path) -> None:
    """A second store of the same content uses the same folder; another content gets its own."""
    first, second = ExperienceStore.open(file), ExperienceStore.open(file)
    first.by_category("cup")
    second.by_category("cup")
    folder = tmp_path / "cache" / "kb"
    assert [path.name for path in folder.iterdir()] == [first.content_hash()]
    first.add(make_experience("cup_new", "cup"))
    assert len(first.by_category("cup")) == 5
    assert {path.name for path in folder.iterdir()} == {first.content_hash(), second.content_hash()}


def test_a_cache_that_cannot_be_written_is_no_obstacle(
    file: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """With a plain file where the cache folder should be, the index lives in memory."""
    blocker = tmp_path / "blocker"
    blocker.write_text("")
    monkeypatch.setenv("RAGVLM_CACHE", str(blocker))
    assert len(ExperienceStore.open(file).by_category("cup")) == 4
    assert blocker.read_text() == ""


def test_a_damaged_index_is_no_obstacle(file: Path, tmp_path: Path) -> None:
    """An index folder without its database is passed over."""
    store = ExperienceStore.open(file)
    (tmp_path / "cache" / "kb" / store.content_hash()).mkdir(parents=True)
    assert len(store.by_category("cup")) == 4


def test_adding_appends_to_the_file_and_to_queries(file: Path) -> None:
    """After `add` the file, a fresh store and the open one know the entry."""
    store = ExperienceStore.open(file)
    new = make_experience("cup_new", "cup")
    store.add(new)
    assert store.get("cup_new") == ExperienceStore.open(file).get("cup_new") == new
    assert store.query_visual(new.embedding, 1)[0][0] == new
    assert [path.name for path in file.parent.iterdir() if path.name.startswith(".")] == []


def test_refused_entries_leave_the_file_untouched(file: Path) -> None:
    """A known id, another embedder and another length are refused; not a byte changes."""
    store, before = ExperienceStore.open(file), file.read_bytes()
    new = make_experience("new", "cup")
    for bad in (
        make_experience("cup_00", "cup"),
        new.model_copy(update={"embedder": "other"}),
        new.model_copy(update={"embedding": (1.0,)}),
        new.model_copy(update={"n_success": 11}),
    ):
        with pytest.raises(BadInputError):
            store.add(bad)
    assert file.read_bytes() == before
    assert len(store) == 7


def _drop_tail(text: str) -> str:
    return text[: -len(text.splitlines()[-1]) // 2 - 1]


def _edit(line: int, change: Callable[[dict[str, object]], object]) -> Callable[[str], str]:
    def edited(text: str) -> str:
        lines = text.splitlines()
        value = json.loads(lines[line - 1])
        change(value)
        lines[line - 1] = json.dumps(value)
        return "\n".join(lines) + "\n"

    return edited


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (lambda text: "", r":1: the knowledge base is empty"),
        (_drop_tail, r":8: damaged line"),
        (lambda text: "{}\n" + text, r":1: this is no knowledge base of ours"),
        (lambda text: text.split("\n", 1)[1], r":1: this is no knowledge base of ours"),
        (_edit(1, lambda v: v.update(schema_version=2)), r":1: schema version 2 is not supported \(valid: 1\)"),
        (_edit(3, lambda v: v.pop("category")), r":3: category: Field required"),
        (_edit(4, lambda v: v.update(success="perhaps")), r":4: success: Input should be a valid boolean"),
        (_edit(5, lambda v: v.update(embedder="clip")), r":5: .*embedded with 'clip'"),
        (_edit(6, lambda v: v.update(embedding=[0.5])), r":6: .*1 embedding numbers instead of 8"),
        (_edit(7, lambda v: v.update(id="cup_00")), r":7: experience 'cup_00' stands already in line 2"),
        (_edit(2, lambda v: v.update(mass=float("nan"))), r":2: mass: Input should be a finite number"),
    ],
)
def test_damaged_files_are_refused_with_the_line(file: Path, damage: Callable[[str], str], message: str) -> None:
    """Every kind of damage gives one line of text with file and line number."""
    file.write_text(damage(file.read_text()))
    with pytest.raises(BadInputError, match=message) as caught:
        ExperienceStore.open(file)
    assert "\n" not in str(caught.value)


def test_a_missing_or_binary_file_says_the_mend(tmp_path: Path) -> None:
    """A file that was named is the caller's input, a folder in its place is a fault; each message says how to mend it."""
    binary = tmp_path / "binary.jsonl"
    binary.write_bytes(b"\xff\xfe\x00\x80")
    for path in (tmp_path / "none.jsonl", binary):
        with pytest.raises(BadInputError, match="ragvlm kb build"):
            ExperienceStore.open(path)
    with pytest.raises(EnvironmentFaultError, match="ragvlm kb build"):
        ExperienceStore.open(tmp_path)


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_read_only_store_can_be_queried_but_not_changed(file: Path) -> None:
    """Reading needs no write permission; adding says so, and memory and file stay as they were."""
    store = ExperienceStore.open(file)
    file.parent.chmod(0o500)
    try:
        assert len(store.by_category("cup")) == 4
        with pytest.raises(EnvironmentFaultError, match="cannot write"):
            store.add(make_experience("cup_new", "cup"))
    finally:
        file.parent.chmod(0o700)
    assert len(store) == 7


def test_opening_needs_neither_chromadb_nor_the_network() -> None:
    """Importing and reading the store leaves chromadb unimported: only queries pay for it."""
    code = (
        "import sys; from kb.store import ExperienceStore; ExperienceStore.open(); sys.exit('chromadb' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
