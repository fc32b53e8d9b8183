"""The timeline of a conversation: forces and the observer's word come back after a restart, on the right branch."""

from __future__ import annotations

from pathlib import Path

import pytest

from agent.chat import Conversation
from app.chat.talk import Talk
from app.console import make_console
from app.timeline import FILE, Timeline


def opened(threads: Path) -> Conversation:
    """A conversation that is quick to look."""
    return Conversation.open("single_cube", 10_003, perception="oracle", thread="t", threads=threads)


def test_forces_and_the_observers_word_outlive_the_process(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Taken up again, each motion has the curve and the verdict it had; `/why` tells them; gone back, later ones are gone."""
    threads = tmp_path / "threads.sqlite"
    with opened(threads) as talk:
        face = Talk(talk, make_console())
        face.hear("pick up the cube")
        end = talk.history(1)[0].id
        face.hear("put it on the left")
        lived = Timeline()
        lived.open(talk.folder, talk.state, talk.agent.opened.motions)
    assert [(row["tool"], row["state"], row["observed"]) for row in lived.rows] == [
        ("execute_grasp", "claimed", True), ("place_object", "claimed", None)
    ]  # fmt: skip
    assert all(len(row["curve"]) > 50 for row in lived.rows)
    assert max(point[1] for point in lived.rows[0]["curve"]) > 5.0
    with opened(threads) as talk:
        again = Timeline()
        again.open(talk.folder, talk.state, talk.agent.opened.motions)
        assert again.rows == lived.rows
        capsys.readouterr()
        Talk(talk, make_console()).hear("/why")
        told = capsys.readouterr().out
        assert "Forces felt over" in told
        assert "The observer saw success: lifted" in told
        talk.fork(end)
        again.open(talk.folder, talk.state, talk.agent.opened.motions)
        assert [row["tool"] for row in again.rows] == ["execute_grasp"]
        assert talk.folder is not None
        (talk.folder / FILE).write_text('[{"motion": "<b>"}]')
        again.open(talk.folder, talk.state, talk.agent.opened.motions)
        assert [(row["tool"], row["state"], row["curve"]) for row in again.rows] == [("execute_grasp", "claimed", [])]
