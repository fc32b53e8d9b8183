"""A person's word before a motion."""

from __future__ import annotations

import io

import pytest

from app.approve import ask, edit
from kb.errors import BadInputError

PROPOSAL = {
    "plan": {
        "grasp": {
            "position": [0.5, 0.0, 0.05], "approach": [0.0, 0.0, -1.0], "yaw": 0.0, "aperture": 0.05, "force": 10.0,
            "type": "pinch", "standoff": 0.1, "speed": 1.0,
        }
    }
}  # fmt: skip


def answer(monkeypatch: pytest.MonkeyPatch, *lines: str) -> dict[str, object]:
    """The decision of somebody who types these lines."""
    monkeypatch.setattr("sys.stdin", io.StringIO("".join(line + "\n" for line in lines)))
    return ask(PROPOSAL)


@pytest.mark.parametrize(
    ("typed", "verdict"), [("y", "approve"), ("YES", "approve"), ("n", "reject"), ("reject", "reject")]
)
def test_yes_and_no(monkeypatch: pytest.MonkeyPatch, typed: str, verdict: str) -> None:
    """Plain words decide at once."""
    assert answer(monkeypatch, typed)["verdict"] == verdict


def test_silence_rejects(monkeypatch: pytest.MonkeyPatch) -> None:
    """The end of the input is not consent."""
    assert answer(monkeypatch)["verdict"] == "reject"


def test_nonsense_is_asked_again(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """What is neither yes nor no nor an edit is answered with the choices, and nothing moves."""
    assert answer(monkeypatch, "perhaps", "", "n")["verdict"] == "reject"
    assert "valid: y, n, force=VALUE" in capsys.readouterr().err


def test_an_edit_is_kept_and_bounded(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """A possible edit becomes the decision; one that the hand cannot do is refused and leaves the earlier ones."""
    decision = answer(monkeypatch, "force=12", "aperture=0.5", "y")
    assert decision["verdict"] == "edit"
    assert decision["grasp"] == {**PROPOSAL["plan"]["grasp"], "force": 12.0}
    assert "aperture:" in capsys.readouterr().err
    assert PROPOSAL["plan"]["grasp"]["force"] == 10.0


PLACING = {**PROPOSAL, "motion": "place", "words": "put the cup on the left", "thought": "There.", "point": [0.5, -0.2]}


def test_a_placing_is_asked_about_with_its_place(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The place may be changed within the table, the grasp may not; where nothing can be chosen only yes and no count."""
    monkeypatch.setattr("sys.stdin", io.StringIO("force=3\nx=2\nx=0.6\ny\n"))
    assert ask(PLACING) == {"verdict": "edit", "point": (0.6, -0.2)}
    told = capsys.readouterr().err
    assert "may I put the cup on the left?" in told
    assert "valid: y, n, x=VALUE, y=VALUE" in told
    assert "x: 2 m is off the table (valid: 0.3 to 0.75)" in told
    monkeypatch.setattr("sys.stdin", io.StringIO("x=0.6\ny\n"))
    assert ask({**PLACING, "point": None}) == {"verdict": "approve"}


@pytest.mark.parametrize("word", ["force", "force=", "force=much", "colour=red", "=3", "force=1=2"])
def test_malformed_edits_are_bad_input(word: str) -> None:
    """Each is one line, not a traceback."""
    with pytest.raises(BadInputError):
        edit(word)
