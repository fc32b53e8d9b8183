"""The observer never reaches the agent: a lying one changes no grasp."""

from __future__ import annotations

from typing import Any

from agent import build_agent
from agent.checkpoint import TYPES
from agent.state import State
from kb.verdict import ObservedAttempt


class Liar:
    """An observer that says the opposite of the true one."""

    def __init__(self, honest: Any) -> None:
        self._honest = honest

    def judge(self, *args: Any, **options: Any) -> ObservedAttempt:
        """The verdict, inverted."""
        truth = self._honest.judge(*args, **options)
        verdict = truth.verdict.model_copy(update={"contact": not truth.verdict.contact, "lifted_m": -1.0})
        return truth.model_copy(update={"success": not truth.success, "verdict": verdict})

    def __getattr__(self, name: str) -> Any:
        return getattr(self._honest, name)


def test_inverted_verdicts_leave_every_grasp_identical() -> None:
    """With each verdict inverted, grasps, claims, corrections and answers are the same; only the verdicts differ."""
    results = []
    for lie in (False, True):
        agent = build_agent("clear_table", 10_001, perception="oracle")
        if lie:
            agent.opened.observer = Liar(agent.opened.observer)
        results.append(agent.run("put the cube in the bin and then pick up the apple"))
    honest, lied = results
    assert [a.grasp for g in honest.goals for a in g.attempts] == [a.grasp for g in lied.goals for a in g.attempts]
    assert [g.claimed for g in honest.goals] == [g.claimed for g in lied.goals]
    assert honest.answer == lied.answer
    assert [a.success for g in honest.goals for a in g.attempts] != [a.success for g in lied.goals for a in g.attempts]


def test_no_type_of_the_observer_is_in_the_state() -> None:
    """Neither the state's fields nor the checkpoint's types know verdicts."""
    assert not any("erdict" in name or "Observed" in name for _, name in TYPES)
    assert not any("verdict" in name or "observ" in name for name in State.__dataclass_fields__)


class Mourner:
    """An observer that saw something break after the grasps were judged."""

    def __init__(self, honest: Any) -> None:
        self._honest = honest

    def damaged(self, since: int = 0) -> tuple[str, ...]:
        """The cube, whatever the motion."""
        return ("cube",)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._honest, name)


def test_what_breaks_after_a_grasp_spoils_the_run() -> None:
    """Every goal succeeded by itself, but something came to harm in another motion: no success, and it is counted."""
    agent = build_agent("clear_table", 10_001, perception="oracle")
    agent.opened.observer = Mourner(agent.opened.observer)
    result = agent.run("pick up the apple")
    assert all(goal.success for goal in result.goals)
    assert result.damage_events == 1
    assert not result.success


def test_what_is_handed_over_touches_nothing_on_the_way() -> None:
    """Seed 13151: carried as a line instead of in its full width, the phone knocked over the glass on its way out."""
    result = build_agent("phone_near_wine_glass", 13_151).run("hand me the smartphone, mind the wine glass")
    assert result.success
    assert result.damage_events == 0
