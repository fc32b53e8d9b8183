"""Checkpoints: everything in the state survives them unchanged, without warnings and without arrays."""

from __future__ import annotations

import dataclasses
import logging
import sqlite3
from pathlib import Path

import numpy as np
import pytest

from agent import build_agent
from agent.checkpoint import prune, serializer, settle
from agent.state import State
from kb.errors import BadInputError, EnvironmentFaultError


@pytest.fixture(scope="module")
def finished() -> State:
    """The state after a pick."""
    agent = build_agent("single_cube", 10_001, perception="oracle")
    agent.run("pick up the cube")
    return agent.state


def test_every_field_survives_serialisation(finished: State, caplog: pytest.LogCaptureFixture) -> None:
    """Each value comes back equal and with its type; the serializer warns of nothing."""
    serde = serializer()
    with caplog.at_level(logging.WARNING):
        for field in dataclasses.fields(State):
            value = getattr(finished, field.name)
            back = serde.loads_typed(serde.dumps_typed(value))
            plain = tuple(back) if isinstance(value, tuple) else back
            assert plain == value, field.name
    assert not caplog.records


def test_pictures_are_kept_by_hash_only(finished: State) -> None:
    """No array is in the state; pictures are "name:hash"."""
    assert all(":" in item and len(item) < 60 for item in finished.pictures)
    assert len(finished.pictures) == 2
    assert not any(isinstance(getattr(finished, f.name), np.ndarray) for f in dataclasses.fields(State))


def test_a_thread_belongs_to_its_world(tmp_path: Path) -> None:
    """A thread reopened without a scene has its own; another scene or seed is refused with both names."""
    threads = tmp_path / "threads.sqlite"
    agent = build_agent("single_cube", 10_001, perception="oracle", thread="mine", threads=threads)
    agent.run("pick up the cube")
    again = build_agent(perception="oracle", thread="mine", threads=threads)
    assert "cube" in again.run("what are you holding?").answer
    assert again.run("put it on the right").goals[0].claimed
    with pytest.raises(BadInputError, match="single_cube"):
        build_agent("single_cup", thread="mine", threads=threads)


def test_unwritable_threads_are_an_environment_fault(tmp_path: Path) -> None:
    """A path through a file cannot keep threads; the error says the mend."""
    (tmp_path / "file").write_text("x")
    with pytest.raises(EnvironmentFaultError, match="RAGVLM_HOME"):
        build_agent("single_cube", thread="t", threads=tmp_path / "file" / "threads.sqlite")


def test_a_thread_does_not_grow_without_bound(tmp_path: Path) -> None:
    """Only the last checkpoints are kept, and the conversation goes on from them."""
    threads = tmp_path / "threads.sqlite"
    agent = build_agent("single_cube", 10_001, perception="oracle", thread="mine", threads=threads)
    for _ in range(3):
        agent.run("what do you see?")
    prune(agent._graph.checkpointer, "mine", keep=5)
    with sqlite3.connect(threads) as connection:
        assert connection.execute("SELECT COUNT(*) FROM checkpoints").fetchone() == (5,)
    assert "cube" in agent.run("where is the cube?").answer


def test_an_answered_turn_is_on_the_platter(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A turn of many steps ends with a commit that SQLite flushes; what a full disk then says is one line with its mend."""
    agent = build_agent("single_cube", 10_001, perception="oracle", thread="mine", threads=tmp_path / "threads.sqlite")
    journal, said = tmp_path / "threads.sqlite-wal", list[str]()
    agent.graph.checkpointer.conn.set_trace_callback(said.append)
    before = journal.stat().st_size
    agent.run("what do you see?")
    agent.graph.checkpointer.conn.set_trace_callback(None)
    full, last_write = (
        said.index("PRAGMA synchronous = FULL"),
        max(i for i, s in enumerate(said) if s.startswith("INSERT")),
    )
    assert last_write < full < said.index("PRAGMA user_version = 1") < said.index("PRAGMA synchronous = NORMAL")
    grown = journal.stat().st_size
    settle(agent.graph.checkpointer)
    assert before < grown < journal.stat().st_size  # a flush is a commit of its own
    assert agent.graph.checkpointer.conn.execute("PRAGMA synchronous").fetchone() == (1,)

    def full_disk(_saver: object) -> None:
        raise sqlite3.OperationalError("database or disk is full")

    monkeypatch.setattr("agent.conversation.settle", full_disk)
    with pytest.raises(
        EnvironmentFaultError, match=r"cannot save the conversation: .* full; what was saved before is kept"
    ):
        agent.run("where is the cube?")
