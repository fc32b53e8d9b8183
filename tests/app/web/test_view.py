"""Candidate grasps in the live view: grippers with one text at a time."""

from __future__ import annotations

from typing import Any

import pytest


@pytest.fixture
def view() -> Any:
    """A view of its own server; no browser looks at it."""
    viser = pytest.importorskip("viser", reason="needs the extra web: pip install 'agentic-rag-vlm[web]'")
    from app.web.view import View

    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    yield View(server)
    server.stop()


def _three(view: Any) -> None:
    from app.web.view import Candidate
    from kb.grasp import Grasp

    grasp = Grasp(position=(0.5, 0.0, 0.1), approach=(0.0, 0.0, -1.0), yaw=0.0, aperture=0.05, force=8.0, type="power")
    view.candidates([Candidate(f"g{n}", grasp, 0.9 - 0.1 * n, chosen=n == 0) for n in range(3)])


def _texts(view: Any) -> list[str]:
    return [label.text for _, label in view._grippers.values() if label.visible]


def test_one_gripper_at_a_time_has_its_text(view: Any) -> None:
    """The chosen grasp has its score; a row or a click sets off another instead; a second click goes back."""
    _three(view)
    assert [text.split()[:3] for text in _texts(view)] == [["#1", "score", "0.90"]]
    view.point("g1")
    assert [text.split()[:3] for text in _texts(view)] == [["#2", "score", "0.80"]]
    view.point(None)
    view._click("g2")
    assert [text.split()[:3] for text in _texts(view)] == [["#3", "score", "0.70"]]
    view._click("g2")
    assert [text.split()[0] for text in _texts(view)] == ["#1"]


def test_what_was_clicked_outlasts_pointing(view: Any) -> None:
    """The pointer passes over other grippers; what was clicked has its text again when the pointer leaves."""
    _three(view)
    view._click("g2")
    view.point("g1")
    assert [text.split()[0] for text in _texts(view)] == ["#2"]
    view.point(None)
    assert [text.split()[0] for text in _texts(view)] == ["#3"]


def test_after_the_motion_a_gripper_comes_back_for_its_row_only(view: Any) -> None:
    """At rest none is drawn; pointing at a row draws that one alone; a new plan is drawn whole."""

    def drawn() -> list[bool]:
        return [gripper.visible for gripper, _ in view._grippers.values()]

    _three(view)
    assert drawn() == [True, True, True]
    view.rest()
    assert drawn() == [False, False, False]
    assert _texts(view) == []
    view.point("g1")
    assert drawn() == [False, True, False]
    assert [text.split()[0] for text in _texts(view)] == ["#2"]
    view.point(None)
    assert drawn() == [False, False, False]
    _three(view)
    assert drawn() == [True, True, True]


def test_a_gripper_can_be_clicked(view: Any) -> None:
    """Each gripper is clickable for viser, and the colours tell chosen, pointed and others apart."""
    from app.web.view import CHOSEN, OTHER, POINTED

    _three(view)
    view.point("g2")
    assert [tuple(gripper.color) for gripper, _ in view._grippers.values()] == [CHOSEN, OTHER, POINTED]
    assert all(gripper._impl.click_cb for gripper, _ in view._grippers.values())
