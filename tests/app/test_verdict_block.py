"""The last lines of a run say no more than what happened."""

from __future__ import annotations

from typing import Any

import pytest

from app.verdict_block import approached, attempt_line
from kb.run_result import AttemptRecord, GoalRecord, RunResult


def attempt(**evidence: Any) -> AttemptRecord:
    return AttemptRecord.model_construct(
        level=0, success=False, claimed=False, failure="UNKNOWN", observed_failure="UNREACHABLE_POSE",
        evidence=evidence, verdict=None,
    )  # fmt: skip


def test_a_stopped_attempt_is_called_stopped() -> None:
    """A person's stop is none of the types of failure; every other end keeps both labels."""
    assert attempt_line(attempt(stopped_by="stop", phase="transit")) == "level 0: stopped before it was done"
    assert "observed UNREACHABLE_POSE" in attempt_line(attempt(stopped_by="unreachable", phase="plan"))


@pytest.mark.parametrize(("phase", "tested"), [("plan", False), ("transit", False), ("approach", True), ("lift", True)])
def test_a_constraint_is_put_to_the_test_by_an_approach(phase: str, tested: bool) -> None:
    """Where no hand went towards anything, a required constraint was not broken."""
    goal = GoalRecord.model_construct(attempts=(attempt(phase=phase),))
    assert approached(RunResult.model_construct(goals=(goal,))) is tested
