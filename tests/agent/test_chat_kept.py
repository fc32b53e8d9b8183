"""What a conversation keeps: memory for good, branches, scenes, exported sessions; second processes, full disks, growth."""

from __future__ import annotations

import resource
import sqlite3
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from agent.chat import Conversation
from agent.chat.portable import export_session, import_session
from agent.chat.sessions import delete_session, list_sessions
from kb.errors import BadInputError, EnvironmentFaultError


def events(turn: Iterator[Any]) -> dict[str, Any]:
    """The last event of each kind of a turn."""
    return {event.kind: event for event in turn}


def opened(scene: str = "cup_near_vase", **options: Any) -> Conversation:
    """A conversation that is quick: oracle perception, analytic outcomes."""
    return Conversation.open(scene, 10_003, **{"perception": "oracle", "evaluator": "analytic", **options})


def test_remember_that_outlives_the_conversation(tmp_path: Path) -> None:
    """What a person wants kept is used in another thread, with its source; forgotten, it is not."""
    threads = tmp_path / "threads.sqlite"
    with opened(thread="one", threads=threads) as talk:
        assert "nothing to remember" in events(talk.remember())["answer"].text
        events(talk.say("pick up the cup and remember that"))
    with opened(thread="two", threads=threads) as talk:
        assert "For good: cup" in events(talk.recall())["answer"].text
        events(talk.say("pick up the cup"))
        plan = talk.state.attempts[-1].plan
        assert any(item.source == "memory" and "one" in item.id for items in plan.provenance.values() for item in items)
        assert "1 grasp" in events(talk.forget("cup"))["answer"].text


def test_both_branches_stay(tmp_path: Path) -> None:
    """Gone back to before the motion, the conversation goes on otherwise; the first ending can be gone back to."""
    with opened(thread="t", threads=tmp_path / "threads.sqlite") as talk:
        events(talk.say("pick up the cup"))
        end = talk.history(1)[0].id
        before = next(point.id for point in talk.history() if point.next == "act")
        talk.fork(before)
        assert talk.unfinished == "pick up the cup"
        assert talk.state.held is None
        events(talk.say("pick up the vase"))
        assert talk.state.held is not None
        assert talk.state.held.category == "vase"
        talk.fork(end)
        assert "cup" in events(talk.say("what are you holding?"))["answer"].text
        with pytest.raises(BadInputError, match="no saved step"):
            talk.fork("nothing")


def test_another_scene_keeps_what_was_said(tmp_path: Path) -> None:
    """The table is new, the conversation is the same; a wrong name changes nothing; reopened it is in the new scene."""
    threads = tmp_path / "threads.sqlite"
    with opened(thread="t", threads=threads) as talk:
        events(talk.say("pick up the cup"))
        assert events(talk.change_scene("nowhere"))["refused"].code == 2
        assert "noted" in events(talk.change_scene("single_apple", 10_001))
        assert talk.state.held is None
        events(talk.say("pick up the apple"))
        assert talk.state.attempts[-1].target.category == "apple"
    with Conversation.open(thread="t", threads=threads, perception="oracle", evaluator="analytic") as talk:
        assert talk.place == "scene single_apple, seed 10001"
        assert talk.messages[0] == ("person", "pick up the cup")


def test_who_was_asked_before_is_asked_again(tmp_path: Path) -> None:
    """A session whose person wanted to be asked goes on asking after a restart, until that is switched off."""
    threads = tmp_path / "threads.sqlite"
    for given, kept in ((True, True), (False, True), (None, False)):
        with opened(thread="a", threads=threads, asks=bool(given)) as talk:
            if given is None:
                talk.asks = False
            assert talk.asks is kept
    with opened(thread="a", threads=threads) as talk:
        assert not talk.asks


def test_a_session_is_one_file(tmp_path: Path) -> None:
    """Exported and imported under another name it goes on, pending approval included; a file that is none is refused."""
    threads, file = tmp_path / "threads.sqlite", tmp_path / "s.zip"
    with opened(thread="a", threads=threads, asks=True) as talk:
        events(talk.say("pick up the cup"))
    export_session("a", file, threads)
    assert import_session(file, "b", threads) == "b"
    delete_session("a", threads)
    assert [info.thread for info in list_sessions(threads)] == ["b"]
    with Conversation.open(thread="b", threads=threads, perception="oracle", evaluator="analytic") as talk:
        assert events(talk.approve())["finished"].result.success
    for bad in (b"", b"PK\x03\x04 nothing"):
        file.write_bytes(bad)
        with pytest.raises(BadInputError):
            import_session(file, "c", threads)
    export_session("b", file, threads)
    with pytest.raises(BadInputError, match="already"):
        import_session(file, None, threads)


def test_a_second_process_is_refused_with_the_pid(tmp_path: Path) -> None:
    """The holder's pid is in the error; once it has closed, the thread is free."""
    threads = tmp_path / "threads.sqlite"
    holder = (
        "import sys\nfrom pathlib import Path\nfrom agent.chat.session_lock import SessionLock\n"
        f"SessionLock(Path({str(tmp_path / 'sessions' / 't')!r}))\nprint('held', flush=True)\nsys.stdin.read()"
    )
    process = subprocess.Popen([sys.executable, "-c", holder], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    assert process.stdout.readline() == "held\n"
    with pytest.raises(EnvironmentFaultError, match=rf"pid {process.pid}\b"):
        opened(thread="t", threads=threads)
    process.communicate("")
    opened(thread="t", threads=threads).close()


def test_a_full_disk_costs_one_line_and_nothing_that_was_saved(tmp_path: Path) -> None:
    """Files may not grow any more: the turn is refused with the mend; with room again the conversation is as it was."""
    threads = tmp_path / "threads.sqlite"
    with opened(thread="t", threads=threads) as talk:
        events(talk.say("pick up the cup"))
        before = talk.messages
        limits = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (4096, limits[1]))
        try:
            told = events(talk.say("put it back"))
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        assert told["refused"].code == 3
        assert "cannot save" in told["refused"].text
        assert "\n" not in told["refused"].text
    with Conversation.open(thread="t", threads=threads, perception="oracle", evaluator="analytic") as talk:
        assert talk.messages[: len(before)] == before
        assert events(talk.say("what are you holding?"))["finished"].result.success
    with sqlite3.connect(threads) as database:
        assert database.execute("PRAGMA integrity_check").fetchone() == ("ok",)


def test_a_read_only_file_costs_one_line_and_nothing_that_was_saved(tmp_path: Path) -> None:
    """Where threads can suddenly not be written, the turn is refused with the mend; later all is there as it was saved."""
    threads = tmp_path / "threads.sqlite"
    with opened(thread="t", threads=threads) as talk:
        events(talk.say("pick up the cup"))
        before = talk.messages
        talk.agent.graph.checkpointer.conn.execute("PRAGMA query_only = ON")
        told = events(talk.say("put it back"))["refused"]
        assert told.code == 3
        assert "cannot save the conversation" in told.text
        assert "\n" not in told.text
        talk.agent.graph.checkpointer.conn.execute("PRAGMA query_only = OFF")
        assert talk.messages == before
        assert events(talk.say("put it back"))["finished"].result.success
    with pytest.raises(EnvironmentFaultError, match="cannot keep the session") as refused:
        opened(thread="t", threads="/proc/nowhere/threads.sqlite")
    assert "\n" not in str(refused.value)


@pytest.mark.long
def test_memory_stays_flat_over_500_commands(tmp_path: Path) -> None:
    """Checkpoint size and the process stay within 5 % from the 100th command to the 500th."""
    threads = tmp_path / "threads.sqlite"
    sizes: dict[int, tuple[int, int]] = {}
    with opened("single_cube", thread="t", threads=threads) as talk:
        for number in range(500):
            events(talk.say("pick up the cube" if number % 2 == 0 else "put it back"))
            if number in (199, 499):
                with sqlite3.connect(threads) as database:
                    biggest = database.execute("SELECT MAX(LENGTH(checkpoint)) FROM checkpoints").fetchone()[0]
                pages = int(Path("/proc/self/statm").read_text().split()[1])
                sizes[number] = (biggest, pages)
    for early, late in zip(sizes[199], sizes[499], strict=True):
        assert late <= 1.05 * early
