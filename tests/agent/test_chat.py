"""The conversation engine: references, demands, steering, what-if, memory, forks, sessions, and what goes wrong."""

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
from agent.chat.hear import hear
from agent.chat.heard import heard, inert
from agent.chat.portable import export_session, import_session
from agent.chat.read_demand import only_demand, plain, read_demand
from agent.chat.sessions import delete_session, list_sessions
from agent.state import State
from kb.errors import BadInputError, EnvironmentFaultError


def events(turn: Iterator[Any]) -> dict[str, Any]:
    """The last event of each kind of a turn."""
    return {event.kind: event for event in turn}


def opened(scene: str = "cup_near_vase", **options: Any) -> Conversation:
    """A conversation that is quick: oracle perception, analytic outcomes."""
    return Conversation.open(scene, 10_003, **{"perception": "oracle", "evaluator": "analytic", **options})


@pytest.fixture(scope="module")
def talk() -> Iterator[Conversation]:
    """One conversation that several tests go on with, in order."""
    with opened() as conversation:
        yield conversation


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        ("no, by the handle", {"region": "handle"}), ("not by the rim", {"not_region": "rim"}), ("gentler", {"force_scale": 0.7}),
        ("from the side please", {"approach": "side"}), ("with 5 N", {"force": 5.0}), ("a bit slower", {"speed_scale": 0.5}),
        ("with a pinch grasp", {"type": "pinch"}), ("opening of 60 mm", {"aperture": 0.06}),
        ("from above and firmer", {"approach": "top", "force_scale": 1.4}),
    ],
)  # fmt: skip
def test_demands_are_read(words: str, wanted: dict[str, Any]) -> None:
    """Each wish becomes the fields it speaks of, and nothing else."""
    demand = only_demand(plain(words))
    assert demand is not None
    assert demand.model_dump(exclude={"words"}, exclude_defaults=True) == wanted


@pytest.mark.parametrize(
    "words", ["pick up the cup", "put it on the side", "the cup with the handle", "sort by size", "why"]
)
def test_what_is_no_demand_is_none(words: str) -> None:
    """Places, things and questions are not taken for a manner."""
    assert read_demand(plain(words))[1] is None


def test_tools_are_heard_whatever_the_wording() -> None:
    """Free wording reaches the tool; what is none of them is a task for the brain."""
    for words, tool in (
        ("remember that", "remember"), ("what do you remember?", "recall"), ("compare the last two attempts", "compare"),
        ("what have you done so far?", "report"), ("why did you grasp it that way?", "why"), ("thank you", "say"),
        ("what would have happened with 4 N?", "whatif"), ("what if you had used a pinch grasp", "whatif"),
        ("pick up the cup", "task"), ("what do you see", "task"), ("forget what you remember", "forget"),
    ):  # fmt: skip
        assert hear(words, State())[0].tool == tool, words
    both = hear("pick up the cup and remember that", State())
    assert [call.tool for call in both] == ["task", "remember"]


def test_what_is_heard_is_inert() -> None:
    """Escape sequences, control and direction characters are taken out; words, HTML and line ends in answers stay."""
    assert heard("\x1b[31mred\x1b[0m\x1b]0;t\x07 a\x00b\u202ec\r\nd") == "red abc  d"
    assert inert("<b>a</b>\n\x1b[2Jb") == "<b>a</b>\nb"


def test_references_reach_back(talk: Conversation) -> None:
    """For "it", "the same" and "and the vase?": each turn is about what was spoken of before."""
    assert events(talk.say("pick up the cup"))["finished"].result.goals[0].claimed
    assert talk.state.held is not None
    first = talk.state.attempts[-1].plan.grasp.force
    again = events(talk.say("do that again but gentler"))["finished"].result
    assert [goal.kind for goal in again.goals] == ["place", "pick"]
    assert talk.state.attempts[-1].plan.grasp.force == pytest.approx(0.7 * first, rel=1e-3)
    assert "vase" in events(talk.say("and the vase?"))["answer"].text
    assert talk.state.held.category == "vase"
    assert "vase" in events(talk.say("put it back"))["answer"].text


def test_a_demand_is_a_constraint_with_its_own_provenance(talk: Conversation) -> None:
    """The grasp obeys, and each number it decided names the person's words."""
    events(talk.say("pick up the cup by the rim with 6 N"))
    plan = talk.state.attempts[-1].plan
    assert plan.region == "rim"
    assert plan.grasp.force == 6.0
    said = [item.id for item in plan.provenance["force"] if item.source == "constraint"]
    assert any(item.startswith("person") for item in said)
    events(talk.undo())


def test_what_cannot_be_done_as_demanded_is_not_done_otherwise(talk: Conversation) -> None:
    """A vase has no handle: the robot says so and moves nothing."""
    attempts = len(talk.state.attempts)
    told = events(talk.say("pick up the vase by the handle"))
    assert not told["finished"].result.success
    assert "as you said" in told["finished"].result.answer
    assert len(talk.state.attempts) == attempts


def test_why_and_compare_speak_from_the_record(talk: Conversation) -> None:
    """Every number of the grasp is listed with sources; experiences with their outcomes; two attempts differ by fields."""
    told = events(talk.why())["explained"]
    fields = {fact.field for fact in told.facts}
    assert fields == set(talk.state.attempts[-1].plan.provenance)
    assert all(fact.sources for fact in told.facts)
    assert "trials succeeded" in told.text
    rows = {row.field for row in events(talk.compare(0, 1))["compared"].rows}
    assert "force" in rows
    assert "object" not in rows


def test_a_what_if_leaves_the_world_alone(talk: Conversation) -> None:
    """The simulated ending is told beside the real one, and the snapshot of the world is the same afterwards."""
    before = talk.state.world
    told = events(talk.whatif(force=1.0))["whatif"]
    assert told.real is not None
    assert told.simulated is not None
    assert told.simulated.claimed is False
    assert talk.state.world == before
    assert events(talk.whatif(force=300.0))["refused"].code == 2
    assert events(talk.whatif(colour="red"))["refused"].code == 2
    assert "no grasp" in events(talk.whatif(region="stem"))["whatif"].text


def test_approval_waits_and_is_steered() -> None:
    """Nothing moves until the word; a question is answered, a wish plans anew, no ends it."""
    with opened(asks=True) as talk:
        assert "asked" in events(talk.say("pick up the cup"))
        assert "noted" in events(talk.say("what do you see?"))
        assert "explained" in events(talk.say("why?"))
        assert events(talk.say("no, by the rim"))["asked"].plan.region == "rim"
        assert not talk.state.executed
        assert events(talk.edit(force=500.0))["refused"].code == 2
        told = events(talk.edit(force=7.0))
        assert told["action"].plan.grasp.force == 7.0
        assert "asked" in events(talk.say("pick up the vase")) or talk.pending is not None
        assert not events(talk.say("no"))["finished"].result.success
        assert talk.pending is None
        assert "refused" in events(talk.approve())


def test_a_placing_is_approved_too() -> None:
    """Nothing is put down without the word: the place is told, questions wait, another place or point is asked about."""
    with opened("single_cube", asks=True) as talk:
        assert events(talk.say("put the cube on the left"))["asked"].motion == "grasp"
        asked = events(talk.approve())["asked"]
        assert (asked.motion, asked.text) == ("place", "May I put the cube on the left?")
        assert asked.point[1] < -0.05  # the person's left is the robot's right
        motions = talk.agent.opened.motions
        assert "because you asked" in events(talk.say("why?"))["noted"].text
        assert "noted" in events(talk.say("gentler"))
        assert events(talk.say("no, on the right"))["asked"].point[1] > 0.05
        assert events(talk.edit(x=2.0))["refused"].code == 2
        assert events(talk.edit(force=5.0))["refused"].code == 2
        assert talk.agent.opened.motions == motions
        done = events(talk.edit(x=0.45, y=0.1))
        assert done["finished"].result.success
        assert done["observation"].sensing.aimed_at == pytest.approx((0.45, 0.1), abs=0.02)
        events(talk.say("pick up the cube"))
        events(talk.approve())
        assert events(talk.undo())["asked"].motion == "place"
        assert not events(talk.reject())["finished"].result.success
        assert talk.state.held is not None


def test_steering_is_heard_before_the_next_motion() -> None:
    """A word that comes while the robot works changes the grasp; something else is done afterwards."""
    with opened() as talk:
        turn = talk.say("pick up the cup")
        told = {}
        for event in turn:
            first = event.kind not in told
            told.setdefault(event.kind, event)
            if event.kind == "look" and first:
                talk.steer("no, by the rim")
                talk.steer("what are you holding?")
        assert "heeded" in told
        assert talk.state.attempts[-1].plan.region == "rim"
        assert ("person", "what are you holding?") in talk.messages
        assert "hand" in talk.messages[-1][1] or "hold" in talk.messages[-1][1]


def test_a_stop_latches() -> None:
    """After a stop nothing moves until the release, whatever is said; then it goes on."""
    with opened() as talk:
        talk.stop()
        told = events(talk.say("pick up the cup"))
        assert "stopped" in told
        assert not told["finished"].result.executed
        talk.release()
        assert events(talk.say("go on"))["finished"].result.success


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
