"""What a person feels of the conversation, through the real faces: stop, first word, overhead, idle server, memory."""

from __future__ import annotations

import pytest

from bench import chat_report
from bench.chat_report import Line, main, quantile, table
from kb.errors import BadInputError


def test_the_table_names_what_was_missed() -> None:
    """A target that was missed is marked, one that could not be measured is neither kept nor missed."""
    lines = [Line("a", "1 ms", "2 ms", True), Line("b", "3 ms", "2 ms", False), Line("c", "nothing", "2 ms", None)]
    rows = table(lines).splitlines()[2:]
    assert [row.split("|")[-2].strip() for row in rows] == ["kept", "**missed**", "not measured"]
    assert quantile([1.0] * 99 + [101.0], 0.5) == 1.0


def test_an_unknown_section_is_refused() -> None:
    """With the sections that there are."""
    with pytest.raises(BadInputError, match="stop_page"):
        main(["--only", "dance"])


def test_a_stop_that_was_never_hit_is_not_kept() -> None:
    """Without a measured stop nothing is claimed; one above 50 ms in a hundred is within, two are not."""
    assert chat_report._stop_line("x", []).kept is None
    assert chat_report._stop_line("x", [5.0] * 199 + [80.0]).kept is True
    assert chat_report._stop_line("x", [5.0] * 10 + [80.0]).kept is False


@pytest.mark.long
@pytest.mark.parametrize(("section", "count"), [("stop_page", 200), ("stop_terminal", 200)])
def test_a_stop_through_a_face_halts_physics_in_time(section: str, count: int) -> None:
    """At 200 random moments, from key or click to the halt: p99 at most 50 ms of wall time (on a quiet machine)."""
    pytest.importorskip("mjviser")
    (line,) = chat_report.SECTIONS[section](count)
    assert line.kept, line.measured


@pytest.mark.long
@pytest.mark.parametrize(("section", "count"), [("turns", 30), ("idle", 0), ("memory", 500)])
def test_the_conversation_costs_little(section: str, count: int) -> None:
    """First word within 300 ms, the conversation itself within 150 ms a turn, an idle server below 20 %, memory flat."""
    pytest.importorskip("mjviser")
    for line in chat_report.SECTIONS[section](count):
        assert line.kept, f"{line.what}: {line.measured}"
