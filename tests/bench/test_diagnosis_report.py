"""The diagnosis report: what is counted, and that provocations bend plans in the respect they name."""

from __future__ import annotations

import numpy as np
import pytest

from bench.attempt_once import attempt_once
from bench.diagnosis_report import Case, DiagnosisReport, markdown
from bench.provocations import PROVOCATIONS, Provocation
from kb.vocabulary import FAILURE_TYPES
from tests.planning_fixtures import bottle, context, percept, screwdriver, solid
from tools.plan_grasp import PlanArgs, plan_grasp


def case(observed: str | None, diagnosed: str | None, number: int = 0) -> Case:
    return Case(
        provocation="p",
        scene="s",
        seed=number,
        observed_success=observed is None,
        observed=observed,
        claimed=diagnosed is None,
        diagnosed=diagnosed,
    )


def test_accuracy_counts_types_with_enough_failed_attempts() -> None:
    """15 slips with 12 right count, 14 drops do not; a claim of a failure is a false claim."""
    cases = [case("SLIP", "SLIP", k) for k in range(12)] + [case("SLIP", "DROP", k) for k in range(3)]
    cases += [case("DROP", "DROP", k) for k in range(13)] + [case("DROP", None), case(None, None), case(None, "SLIP")]
    report = DiagnosisReport(cases=tuple(cases))
    assert report.accuracies() == {"SLIP": (12, 15)}
    assert report.macro_accuracy() == pytest.approx(0.8)
    assert report.false_claims() == (1, 2)
    assert report.missed_successes() == (1, 2)
    assert "| SLIP |" in markdown(report)


def test_the_provocations_aim_at_at_least_ten_types() -> None:
    """Each names its type; together ten or more."""
    meant = {item.meant for item in PROVOCATIONS}
    assert meant <= set(FAILURE_TYPES)
    assert len(meant) >= 10


@pytest.mark.parametrize("provocation", PROVOCATIONS, ids=lambda item: item.name)
def test_a_provocation_changes_the_grasp_and_nothing_else(provocation: Provocation) -> None:
    """The bent plan has another grasp and no stored posture; candidate and expected width stay."""
    seen = screwdriver("t", 0.5, 0.05, 0.4) if provocation.meant == "ORIENTATION" else solid("t", "cube", 0.5, 0.05)
    if provocation.name == "off its centre":
        seen = solid("t", "smartphone", 0.5, 0.05)
    if provocation.meant == "FORCE_DAMAGE":
        seen = solid("t", "smartphone", 0.5, 0.05)
    scene = percept(seen, bottle("n", 0.5, 0.25))
    plan = plan_grasp(PlanArgs(percept=scene, target="t"), context()).plan
    assert plan is not None
    bent = provocation.bend(plan, scene, seen, np.random.default_rng(1))
    assert bent is not None
    assert bent.grasp != plan.grasp
    assert (bent.candidate, bent.local_width, bent.joints) == (plan.candidate, plan.local_width, ())


def test_a_provoked_failure_is_what_the_observer_says_and_the_robot_names_it() -> None:
    """Closing above a cube: the observer sees a position error and so does the robot."""
    above = next(item for item in PROVOCATIONS if item.name == "above it")
    once = attempt_once("single_cube", 10001, bend=above.bend)
    assert once is not None
    assert once.observed is not None
    assert once.diagnosis is not None
    assert (once.observed.success, once.observed.failure) == (False, "POSITION_ERROR")
    assert (once.diagnosis.claimed, once.diagnosis.failure) == (False, "POSITION_ERROR")
