"""A language model after a failure, and what it is shown: corrections to choose from, numbered marks on the picture."""

from __future__ import annotations

import io
import json
from typing import Any

import numpy as np
import pytest

from agent import build_agent, motions
from agent.brains.model import ModelBrain
from kb.sensing import Sensing
from tests.brain_fixtures import GOOD, ScriptedChat
from tools.draw_scene_graph import box_corners, project
from tools.execute_grasp import execute_grasp


def reflecting(monkeypatch: pytest.MonkeyPatch, *replies: dict[str, Any]) -> tuple[Any, list[Any], ScriptedChat]:
    """Result, steps and chat of a run whose first grasp is felt to close on nothing; the model reflects as in `replies`."""
    given, tries = iter(replies), iter((True,))

    def once_missed(args: Any, context: Any) -> Sensing:
        if next(tries, False):
            return Sensing(phase="close", aperture_start=0.08)
        return execute_grasp(args, context)

    monkeypatch.setattr(motions, "execute_grasp", once_missed)
    chat = ScriptedChat(lambda p, _n: json.dumps(next(given)) if p.role == "reflect" else GOOD[p.role])
    robot = build_agent("single_cube", 10_001, brain=ModelBrain(chat), perception="oracle")
    steps: list[Any] = []
    return robot.run("pick up the cube", steps.append), steps, chat


def offered(chat: ScriptedChat) -> list[dict[str, Any]]:
    """The corrections that the prompt of the first reflection lists."""
    text = next(p for p in chat.prompts if p.role == "reflect").messages[1].text
    return json.loads(text.split("orrections to choose from: <data>")[-1].split("</data>")[0].split("<data>")[-1])


def test_the_chosen_correction_is_applied(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of the listed corrections the second is chosen, of a higher level: the next attempt is of that level, and succeeds."""
    result, steps, chat = reflecting(monkeypatch, {"thought": "Elsewhere.", "choice": 1, "give_up": False})
    listed = offered(chat)
    assert [row["number"] for row in listed] == [0, 1, 2]
    told = next(step for step in steps if step.kind == "reflection")
    assert (told.text, told.level, told.correction.rule) == ("Elsewhere.", listed[1]["level"], listed[1]["rule"])
    assert [attempt.level for attempt in result.goals[0].attempts] == [0, listed[1]["level"]]
    assert result.success


def test_a_correction_that_was_not_listed_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """Number 7 comes back with the reason; number 0, chosen then, is applied."""
    wrong, right = ({"thought": "So.", "choice": number, "give_up": False} for number in (7, 0))
    result, steps, _ = reflecting(monkeypatch, wrong, right)
    assert [step.reason for step in steps if step.kind == "reply_refused"] == ["there is no correction 7"]
    assert result.model_use.fallbacks == ()
    assert len(result.goals[0].attempts) == 2


def test_giving_up_ends_the_run_honestly(monkeypatch: pytest.MonkeyPatch) -> None:
    """No second attempt, no success, and the recorded sentence stands before the model's words."""
    result, _, _ = reflecting(monkeypatch, {"thought": "It is too risky.", "choice": 0, "give_up": True})
    assert (result.success, len(result.goals[0].attempts)) == (False, 1)
    assert "too risky" in result.answer


def test_marks_are_drawn_where_the_objects_are() -> None:
    """The picture that goes out differs from the camera's around every object and nowhere far from all of them."""
    from PIL import Image

    chat = ScriptedChat()
    robot = build_agent("phone_near_wine_glass", 10_001, brain=ModelBrain(chat), perception="oracle", dry_run=True)
    steps: list[Any] = []
    robot.run("pick up the phone", steps.append)
    thinking = next(p for p in chat.prompts if p.role == "think" and p.messages[1].pictures)
    drawn = np.asarray(Image.open(io.BytesIO(thinking.messages[1].pictures[0])).convert("RGB")).astype(int)
    view = next(view for view in robot.views if view.name == "front")
    assert drawn.shape == view.rgb.shape
    changed = np.abs(drawn - view.rgb.astype(int)).max(axis=2) > 8
    percept = next(step.percept for step in steps if step.kind == "look")
    assert len(percept.objects) == 2
    near_any = np.zeros(changed.shape, dtype=bool)
    rows, columns = np.indices(changed.shape)
    for thing in percept.objects:
        u, v = project(view, np.array([thing.position]))[0]
        near = np.hypot(columns - u, rows - v) < 30
        assert changed[near].mean() > 0.02
        corners = project(view, box_corners(thing))
        reach = 40 + np.hypot(*(corners - (u, v)).T).max()
        near_any |= np.hypot(columns - u, rows - v) < reach
    assert not changed[~near_any].any()
