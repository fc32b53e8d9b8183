"""Large values of a checkpoint are stored once, come back as they were, and go when nothing names them any more."""

from __future__ import annotations

import json
import sqlite3
import zipfile
from pathlib import Path
from typing import Any

import pytest

from agent import build_agent
from agent.chat.portable import export_session, import_session
from agent.chat.sessions import delete_session
from agent.checkpoint import PARTS, prune, serializer, sqlite_saver
from agent.conversation import Agent
from agent.thread_saver import LARGE
from kb.errors import EnvironmentFaultError


def opened(threads: Path) -> Agent:
    return build_agent("single_cube", 10_001, perception="oracle", thread="mine", threads=threads)


@pytest.fixture
def threads(tmp_path: Path) -> Path:
    """A file with a thread in which something was picked up and put back."""
    path = tmp_path / "threads.sqlite"
    agent = opened(path)
    assert agent.run("pick up the cube").success
    assert agent.run("put it back").success
    return path


def rows(path: Path, query: str) -> list[Any]:
    with sqlite3.connect(path) as database:
        return database.execute(query).fetchall()


def former(path: Path) -> None:
    """Makes the file what an earlier version wrote: every checkpoint whole, no table of values."""
    saver, serde = sqlite_saver(path), serializer()
    whole = [
        (found, serde.dumps_typed(found.checkpoint)) for found in saver.list({"configurable": {"thread_id": "mine"}})
    ]
    for found, (kind, blob) in whole:
        saver.conn.execute(
            "UPDATE checkpoints SET type = ?, checkpoint = ?, metadata = ? WHERE checkpoint_id = ?",
            (kind, blob, json.dumps(found.metadata).encode(), found.config["configurable"]["checkpoint_id"]),
        )
    saver.conn.execute(f"DROP TABLE {PARTS}")
    saver.conn.commit()
    saver.conn.close()


def plain(values: Any) -> dict[str, Any]:
    return {key: tuple(value) if isinstance(value, list | tuple) else value for key, value in values.items()}


def test_a_value_that_does_not_change_is_stored_once(threads: Path) -> None:
    """Two turns have two snapshots of the world, not one for each of their checkpoints, which hold none of the large values."""
    named = [json.loads(text)[PARTS] for (text,) in rows(threads, "SELECT metadata FROM checkpoints")]
    worlds = {parts["world"] for parts in named if "world" in parts}
    assert len(named) > 20
    assert len(worlds) == 2  # holding, put back
    assert not any("parts" in found.metadata for found in sqlite_saver(threads).list(None))
    serde = serializer()
    for kind, blob in rows(threads, "SELECT type, checkpoint FROM checkpoints"):
        assert not set(serde.loads_typed((kind, blob))["channel_values"]) & set(LARGE)


def test_every_checkpoint_comes_back_whole(threads: Path) -> None:
    """What a new process reads equals what the old one had in its hands, at every step of the history."""
    agent = opened(threads)
    one = [(s.config, plain(s.values)) for s in agent.graph.get_state_history(agent.config)]
    again = opened(threads)
    assert [(s.config, plain(s.values)) for s in again.graph.get_state_history(again.config)] == one
    assert {"world", "attempts", "percept", "memory"} <= set(one[0][1])
    assert len(one[0][1]["attempts"]) == 1
    assert not any("attempts" in values and values["attempts"] for _, values in one[-3:])


def test_a_file_of_an_earlier_version_is_read_and_gone_on_with(threads: Path) -> None:
    """Checkpoints that hold everything themselves stay readable, and the conversation goes on from them."""
    before = plain(opened(threads).graph.get_state(opened(threads).config).values)
    former(threads)
    assert (PARTS,) not in rows(threads, "SELECT name FROM sqlite_master")
    agent = opened(threads)
    assert plain(agent.graph.get_state(agent.config).values) == before
    assert agent.run("pick up the cube").success
    assert opened(threads).run("what are you holding?").answer


def test_values_go_when_no_checkpoint_names_them(threads: Path) -> None:
    """After pruning the values left are those that the checkpoints left name; one that nobody named goes, too."""
    agent = opened(threads)
    saver: Any = agent.graph.checkpointer
    saver.conn.execute(
        f"INSERT INTO {PARTS} VALUES ('mine', 'orphan', 'bytes', x'00'), ('other', 'theirs', 'bytes', x'00')"
    )
    saver.conn.commit()
    for _ in range(6):
        agent.run("what do you see?")
    named = [json.loads(text)[PARTS] for (text,) in rows(threads, "SELECT metadata FROM checkpoints")]
    kept = {name for (name,) in rows(threads, f"SELECT name FROM {PARTS} WHERE thread_id = 'mine'")}
    assert kept == {name for parts in named for name in parts.values()}
    assert rows(threads, f"SELECT name FROM {PARTS} WHERE thread_id = 'other'") == [("theirs",)]
    assert "cube" in opened(threads).run("where is the cube?").answer


def test_a_checkpoint_that_could_not_be_saved_leaves_nothing_half(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where the value is stored and the checkpoint is not, the next checkpoint stores it again if it has gone meanwhile."""
    saver: Any = sqlite_saver(tmp_path / "threads.sqlite")
    config: Any = {"configurable": {"thread_id": "t", "checkpoint_ns": ""}}
    value = b"snapshot"

    def point(number: int) -> dict[str, Any]:
        return {"v": 1, "id": f"{number:08}", "ts": "", "channel_values": {"world": value}, "channel_versions": {}}

    with monkeypatch.context() as patched:
        patched.setattr("langgraph.checkpoint.sqlite.SqliteSaver.put", _full)
        with pytest.raises(sqlite3.OperationalError):
            saver.put(config, point(1), {}, {})
    saver.prune_parts("t")
    assert saver.conn.execute(f"SELECT COUNT(*) FROM {PARTS}").fetchone() == (0,)
    saver.put(config, point(2), {}, {})
    assert saver.get_tuple(config).checkpoint["channel_values"] == {"world": value}
    saver.delete_thread("t")
    assert saver.get_tuple(config) is None
    saver.put(config, point(3), {}, {})
    assert saver.get_tuple(config).checkpoint["channel_values"] == {"world": value}


def test_going_back_to_before_a_value_and_making_it_again_keeps_it(tmp_path: Path) -> None:
    """A value that the last checkpoint does not name may be forgotten; made again, it is stored again."""
    saver: Any = sqlite_saver(tmp_path / "threads.sqlite")
    config: Any = {"configurable": {"thread_id": "t", "checkpoint_ns": ""}}
    world = b"snapshot"
    for number, values in enumerate(({"world": world}, {}, {"world": world})):
        point = {"v": 1, "id": f"{number:08}", "ts": "", "channel_values": values, "channel_versions": {}}
        saver.put(config, point, {}, {})
        prune(saver, "t", keep=1)
        if number < 2:
            saver.conn.execute("DELETE FROM checkpoints WHERE checkpoint_id < ?", (point["id"],))
            saver.prune_parts("t")
        assert saver.get_tuple(config).checkpoint["channel_values"] == values
        saver._decoded.clear()
    assert saver.get_tuple(config).checkpoint["channel_values"] == {"world": world}


def _full(*_: Any) -> None:
    raise sqlite3.OperationalError("database or disk is full")


def test_a_damaged_file_costs_one_line(threads: Path) -> None:
    """A checkpoint whose value is gone is told in one line, not taken for an empty one."""
    with sqlite3.connect(threads) as database:
        database.execute(f"DELETE FROM {PARTS}")
    with pytest.raises(EnvironmentFaultError, match=r"cannot read the thread 'mine': .* is missing"):
        opened(threads)


@pytest.fixture(params=["now", "former"])
def session(request: pytest.FixtureRequest, threads: Path, tmp_path: Path) -> Path:
    """An exported session, of this version and of the one before."""
    if request.param == "former":
        former(threads)
    file = tmp_path / "session.zip"
    export_session("mine", file, threads)
    if request.param == "former":
        _rename(file)
    return file


def _rename(file: Path) -> None:
    """Gives the exported file the format's former name."""
    with zipfile.ZipFile(file) as packed:
        items = {item: packed.read(item) for item in packed.namelist()}
    items["session.json"] = items["session.json"].replace(b"session-2", b"session-1")
    with zipfile.ZipFile(file, "w") as packed:
        for item, content in items.items():
            packed.writestr(item, content)


def test_sessions_are_exported_imported_and_deleted_with_their_values(
    session: Path, threads: Path, tmp_path: Path
) -> None:
    """Another home has the conversation as it was; a deleted one leaves no value."""
    elsewhere = tmp_path / "elsewhere" / "threads.sqlite"
    assert import_session(session, "yours", elsewhere) == "yours"
    there = build_agent(perception="oracle", thread="yours", threads=elsewhere)
    here = opened(threads)
    assert plain(there.graph.get_state(there.config).values) == plain(here.graph.get_state(here.config).values)
    del here
    for name, file in (("yours", elsewhere), ("mine", threads)):
        delete_session(name, file)
        assert rows(file, f"SELECT COUNT(*) FROM {PARTS}") == [(0,)]
