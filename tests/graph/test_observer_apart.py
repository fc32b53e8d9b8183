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
