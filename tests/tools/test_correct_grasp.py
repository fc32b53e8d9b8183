"""Corrections by failure type and level (Sec. IV-B; ledger G18, G19)."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, get_args

import pytest

from kb.sensing import Correction, Evidence, Plan, Sensing
from kb.vocabulary import FAILURE_TYPES, FailureType, GraspType
from sim.quality import minimum_force
from tests.planning_fixtures import context, cup, experience, percept, retrieval, solid
from tools.correct_grasp import CorrectArgs, correct_grasp, squeezed_out, used_experiences
from tools.plan_grasp import PlanArgs, plan_grasp


def a_plan(category: str = "cube") -> Plan:
    seen = cup("t", 0.5, 0.1) if category == "cup" else solid("t", category, 0.5, 0.1)
    args = PlanArgs(percept=percept(seen), target="t", retrieval=retrieval(experience("e-1", seen, region="body")))
    plan = plan_grasp(args, context()).plan
    assert plan is not None
    return plan


def corrected(failure: FailureType, level: int = 1, plan: Plan | None = None, **sensed: Any) -> Correction:
    args = CorrectArgs(
        failure=failure, level=level, plan=plan or a_plan(), evidence=Evidence(sensing=Sensing(**sensed))
    )
    return correct_grasp(args, context())


def test_slip_means_a_fifth_more_force() -> None:
    """The paper's own rule: f' = 1.2 f, when the object sank rather than was squeezed out."""
    plan = a_plan()
    change = corrected("SLIP", plan=plan, load_lifted=0.06, aperture_closed=plan.local_width)
    assert change.changes["force"] == pytest.approx(1.2 * plan.grasp.force)
    assert change.offset == (0.0, 0.0, 0.0)


def test_squeezed_out_means_lower_not_stronger() -> None:
    """Leaving while the fingers close is no lack of force: 8 mm lower, force as it was (ledger G18)."""
    change = corrected("SLIP", load_lifted=0.0, aperture_closed=0.004)
    assert "force" not in change.changes
    assert change.offset == pytest.approx((0.0, 0.0, -0.008))


def test_squeeze_out_is_told_from_gravity_by_opening_and_load() -> None:
    """Nothing between the fingers and nothing on the wrist: squeezed out; something between them: it sank."""
    plan = a_plan()
    gone = CorrectArgs(failure="SLIP", level=1, plan=plan, evidence=Evidence(sensing=Sensing(aperture_closed=0.002)))
    there = CorrectArgs(
        failure="SLIP", level=1, plan=plan, evidence=Evidence(sensing=Sensing(aperture_closed=plan.local_width))
    )
    assert squeezed_out(gone)
    assert not squeezed_out(there)


def test_a_wrist_that_has_weighed_the_object_sets_the_force() -> None:
    """Half a kilogram was felt: the force is at least what holds that at low friction."""
    change = corrected("DROP", load_lifted=0.5, aperture_closed=0.05)
    assert float(str(change.changes["force"])) >= minimum_force(0.5, 0.4)


def test_width_mismatch_opens_a_centimetre_more() -> None:
    """The paper's own rule: w' = w + 0.01 m; a hand that was fully open looks for another place instead."""
    plan = a_plan()
    narrow = plan.model_copy(update={"grasp": plan.grasp.model_copy(update={"aperture": 0.06})})
    assert corrected("WIDTH_MISMATCH", plan=narrow).changes["aperture"] == pytest.approx(0.07)
    wide = plan.model_copy(update={"grasp": plan.grasp.model_copy(update={"aperture": 0.08})})
    change = corrected("WIDTH_MISMATCH", plan=wide)
    assert "aperture" not in change.changes
    assert plan.candidate in change.exclude


def test_damage_means_less_force_and_a_collision_means_another_place() -> None:
    """FORCE_DAMAGE x 0.7, DEFORMATION x 0.8; a collision raises h by 3 cm and isn't repeated."""
    plan = a_plan()
    assert corrected("FORCE_DAMAGE", plan=plan).changes["force"] == pytest.approx(0.7 * plan.grasp.force)
    assert corrected("DEFORMATION", plan=plan).changes["force"] == pytest.approx(0.8 * plan.grasp.force)
    hit = corrected("COLLISION", plan=plan)
    assert hit.changes["standoff"] == pytest.approx(plan.grasp.standoff + 0.03)
    assert plan.candidate in hit.exclude
    assert hit.margin == pytest.approx(1.5)


def test_failed_experiences_bound_the_force() -> None:
    """10 N is known to slip, 16 N to break: the corrected force lies between, with a margin of a tenth."""
    seen, plan = solid("t", "cube", 0.5, 0.1), a_plan()
    slipped = experience("s", seen, success=False, region="body", force=10.0).model_copy(
        update={"failures": {"SLIP": 9}}
    )
    broke = experience("b", seen, success=False, region="body", force=16.0).model_copy(
        update={"failures": {"FORCE_DAMAGE": 9}}
    )
    for factor in (0.2, 5.0):
        bent = plan.model_copy(update={"grasp": plan.grasp.model_copy(update={"force": plan.grasp.force * factor})})
        args = CorrectArgs(
            failure="DROP",
            level=1,
            plan=bent,
            evidence=Evidence(sensing=Sensing()),
            retrieval=retrieval(slipped, broke),
        )
        assert 11.0 <= float(str(correct_grasp(args, context()).changes["force"])) <= 16.0 / 1.1


@pytest.mark.parametrize("failure", FAILURE_TYPES)
@pytest.mark.parametrize("level", [1, 2, 3])
def test_every_failure_has_a_correction_at_every_level(failure: FailureType, level: int) -> None:
    """Level and failure stay what they were asked for, and the rule has a name."""
    change = corrected(failure, level)
    assert (change.failure, change.level) == (failure, level)
    assert change.rule


@pytest.mark.parametrize("type_", get_args(GraspType))
def test_level_two_rotates_the_type_with_a_tenth_less_force(type_: GraspType) -> None:
    """Power -> pinch -> side -> power (G19b), force x 0.9."""
    plan = a_plan()
    plan = plan.model_copy(update={"grasp": plan.grasp.model_copy(update={"type": type_})})
    change = corrected("SLIP", 2, plan=plan)
    assert change.changes["type"] == {"power": "pinch", "pinch": "side", "side": "power"}[type_]
    assert change.changes["force"] == pytest.approx(0.9 * plan.grasp.force)


def test_level_two_skips_types_unfit_for_the_affordance() -> None:
    """An edge affordance scores power 0.1 < 0.4 (phi_4), so side is followed by pinch."""
    seen = solid("t", "bowl", 0.5, 0.1)
    plan = a_plan().model_copy(update={"region": "rim"})
    plan = plan.model_copy(update={"grasp": plan.grasp.model_copy(update={"type": "side"})})
    args = CorrectArgs(
        failure="SLIP",
        level=2,
        plan=plan,
        evidence=Evidence(sensing=Sensing()),
        retrieval=retrieval(experience("b-1", seen, region="rim")),
    )
    assert correct_grasp(args, context()).changes["type"] == "pinch"


def test_level_three_plans_anew_from_what_was_not_used_with_a_small_shift() -> None:
    """Used experiences and the candidate are excluded, the position is shifted by at most 1 cm per axis (G19c)."""
    plan = a_plan()
    change = corrected("SLIP", 3, plan=plan)
    assert {"e-1", plan.candidate} <= set(change.exclude)
    assert all(abs(value) <= 0.01 for value in change.offset)
    assert any(change.offset)
    assert change.changes == {}


def test_places_that_failed_before_stay_excluded() -> None:
    """What the history says of other places is carried on."""
    old = SimpleNamespace(candidate="body/top/power/yaw0", failure="COLLISION", region="body", experiences=())
    args = CorrectArgs(
        failure="ORIENTATION", level=1, plan=a_plan(), evidence=Evidence(sensing=Sensing()), history=(old,)
    )
    assert "body/top/power/yaw0" in correct_grasp(args, context()).exclude


def test_used_experiences_are_read_from_the_provenance() -> None:
    """The ids in the plan's provenance."""
    assert used_experiences(a_plan()) == ("e-1",)


@pytest.mark.parametrize("level", [2, 3])
def test_a_region_that_was_missed_twice_is_left_alone(level: int) -> None:
    """Met elsewhere than seen, and again after a new look: the region is not what it seems; once may be a bad picture."""
    plan = a_plan()
    once = SimpleNamespace(candidate="rim/a", region="rim", failure="POSITION_ERROR", grasp=plan.grasp, experiences=())
    other = SimpleNamespace(candidate="body/a", region="body", failure="SLIP", grasp=plan.grasp, experiences=())
    for history, avoided in (
        ((once,), ()),
        ((once, other), ()),
        ((once, once), ("rim",)),
        ((once, other, once), ("rim",)),
    ):
        args = CorrectArgs(
            failure="POSITION_ERROR", level=level, plan=plan, evidence=Evidence(sensing=Sensing()), history=history
        )
        assert correct_grasp(args, context()).avoid_regions == avoided


@pytest.mark.parametrize("level", [1, 2, 3])
def test_what_slipped_is_weighed_at_the_next_lift(level: int) -> None:
    """After a slip or a drop, also an earlier one of the same goal; a missed place says nothing of the weight."""
    slipped = SimpleNamespace(candidate="body/a", region="body", failure="SLIP", experiences=())
    assert corrected("DROP", level).weigh
    assert not corrected("POSITION_ERROR", level).weigh
    args = CorrectArgs(
        failure="POSITION_ERROR", level=level, plan=a_plan(), evidence=Evidence(sensing=Sensing()), history=(slipped,)
    )
    assert correct_grasp(args, context()).weigh
