"""Laws of what the page keeps with a session: bounded, back after a restart, and not broken by damaged files."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from app.timeline import CURVE_POINTS, curve
from app.web.board import Board
from app.web.replays import KEPT, Replays
from app.web.rows import measurement
from app.web.transcript import FILE, Transcript, entry_of, world_mark
from app.web.transcript import KEPT as ENTRIES
from kb.constraint import Constraints


def _entry(number: int) -> dict[str, object]:
    return {"kind": "answer", "label": "Answer", "text": f"text {number}", "details": []}


def test_replays_come_back_and_stay_bounded(tmp_path: Path) -> None:
    """The latest runs are kept on disk with times and joints; older ones go; a damaged file costs only itself."""
    poses = [np.full(9, step / 100, np.float32) for step in range(5)]
    kept = Replays(tmp_path)
    for number in range(KEPT + 3):
        assert kept.add(f"turn {number}", "scene a", [0.0, 0.1, 0.2, 0.3, 0.4], poses) is not None
    assert kept.add("nothing moved", "scene a", [], []) is None
    assert len(list(tmp_path.glob("*.npz"))) == KEPT
    (tmp_path / "replay-000099.npz").write_bytes(b"no archive")
    again = Replays(tmp_path)
    again.load()
    assert [card["words"] for card in again.cards("scene a")][:2] == [f"turn {KEPT + 2}", f"turn {KEPT + 1}"]
    assert again.cards("scene b") == []
    latest = again.runs[KEPT + 2]
    assert latest.at(0.0)[0] == 0.0
    assert np.isclose(latest.at(1.0)[0], 0.04)
    assert np.isclose(latest.at(0.5)[0], 0.02)


def test_a_stopped_robot_is_not_called_wrong() -> None:
    """What had come about before the stop is told without blame; a claim that nobody cut short is judged."""
    goal = SimpleNamespace(attempts=(), verdict=object(), claimed=False, success=True)
    result = SimpleNamespace(goals=[goal], executed=True, success=True, damage_events=0)
    step = SimpleNamespace(kind="finished", result=result)
    cut, whole = entry_of(step, stopped=True), entry_of(step)
    assert cut is not None
    assert whole is not None
    assert cut["text"] == "The observer saw success."
    assert "wrong about it" in whole["text"]


def test_the_transcript_comes_back_without_what_a_kill_cut_off(tmp_path: Path) -> None:
    """Entries are on disk at once; a half-written line is left out; no more than a page shows are read."""
    kept = Transcript(tmp_path)
    for number in range(ENTRIES + 20):
        kept.add(_entry(number))
    with (tmp_path / FILE).open("a") as stream:
        stream.write(json.dumps(_entry(-1))[:20])
    entries = Transcript(tmp_path).entries
    assert entries[-1] == _entry(ENTRIES + 19)
    assert len(entries) <= ENTRIES
    assert Transcript(tmp_path / "absent").entries == []


def test_lamps_come_back_with_the_world_they_were_measured_in(tmp_path: Path) -> None:
    """By the world's mark: not those of another branch, and nothing that is no lamp."""
    lamp = {
        "kind": "clearance",
        "target": "vase",
        "reason": "near",
        "gap": 12,
        "state": "kept",
        "measured": ["moved 0 mm"],
    }
    kept = Transcript(tmp_path)
    for world, rows in ((b"here", [lamp, {"kind": 3}, "text"]), (b"there", [{**lamp, "state": "broken"}])):
        kept.add({**_entry(0), "lamps": rows, "after": world_mark(SimpleNamespace(world=world))})
    again = Transcript(tmp_path)
    assert again.lamps(world_mark(SimpleNamespace(world=b"here"))) == [lamp]
    assert again.lamps(world_mark(SimpleNamespace(world=b"there")))[0]["state"] == "broken"
    assert again.lamps(world_mark(SimpleNamespace(world=b""))) == []


def test_a_session_taken_up_shows_its_lamps() -> None:
    """What was measured last, also when no plan is left; what is only watched where nothing was measured."""
    lamp = {"kind": "clearance", "target": "vase", "reason": "near", "gap": 12, "state": "kept", "measured": []}
    board = Board(lambda _part, _value: None)
    state = SimpleNamespace(percept=None, plan=None, constraints=Constraints())
    board.restore(state, [lamp])
    assert board.parts["constraints"] == [lamp]
    board.restore(state, [])
    assert board.parts["constraints"] == []


def test_a_folder_that_cannot_be_written_costs_nothing_in_memory(tmp_path: Path) -> None:
    """Where a file stands in the folder's place, transcript and replays go on in memory."""
    blocked = tmp_path / "file"
    blocked.write_text("")
    kept, runs = Transcript(blocked), Replays(blocked)
    kept.add(_entry(1))
    assert kept.entries == [_entry(1)]
    assert runs.add("turn", "scene", [0.0, 0.1], [np.zeros(9, np.float32)] * 2) is not None


def test_a_thinned_curve_keeps_its_peaks() -> None:
    """However long a motion was, the plot has few points and the largest force of the motion among them."""
    rows = [
        {"t": n * 0.02, "phase": "close" if n > 500 else "approach", "grip_n": 1.0, "wrist_n": 2.0} for n in range(1000)
    ]
    rows[777]["grip_n"] = 63.0
    drawn = curve(rows)
    assert len(drawn["curve"]) <= CURVE_POINTS
    assert max(point[1] for point in drawn["curve"]) == 63.0
    assert [name for name, _ in drawn["phases"]] == ["approach", "close"]


def test_measurements_have_their_units() -> None:
    """The ending of a measurement's name is its unit."""
    assert measurement("force_n", 1.26) == "force 1.3 N"
    assert measurement("displacement_mm", 2.0) == "displacement 2.0 mm"
    assert measurement("moved_m", 0.004) == "moved 4.0 mm"
    assert measurement("tilt_deg", 3.0) == "tilt 3.0 °"
    assert measurement("supporter", "bowl") == "supporter bowl"
    assert measurement("supporter_moved", False) == "supporter moved False"
