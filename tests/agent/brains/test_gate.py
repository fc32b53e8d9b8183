"""Laws of the gate: whatever is chosen, what passes keeps the limits, and what is left unchanged passes as it is."""

from __future__ import annotations

from functools import cache

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from agent.brain import Deliberation, Reflected, Situation, Spoken
from agent.goal import Goal
from agent.language.read_command import understand
from agent.safety.gate import (
    RefusedError,
    judged_answer,
    judged_reflection,
    judged_thought,
    judged_understanding,
)
from agent.safety.limits import BrainLimits
from kb.grasp import MAX_APERTURE, MAX_FORCE, Grasp
from kb.run_result import ModelUse
from kb.sensing import Correction, Plan
from sim.placement import REACH, TABLE_LOWER, TABLE_UPPER
from sim.quality import maximum_force
from tests.planning_fixtures import context, cup, experience, percept, retrieval, solid
from tools.choose_grasp import ChooseArgs, choose_grasp
from tools.plan_grasp import PlanArgs, plan_grasp
from tools.planning.force_choice import CLOSING_PEAK, DAMAGE_SPREAD
from tools.planning.grasp_limits import force_bounds, outside, refuse_grasp

SCENE = percept(cup("obj_0", 0.5, 0.0), solid("obj_1", "wine_glass", 0.62, 0.05))


@cache
def planned() -> Plan:
    """A plan for the cup beside the glass."""
    entry = experience("e1", SCENE.objects[0], region="rim", force=12.0)
    plan = plan_grasp(PlanArgs(percept=SCENE, target="obj_0", retrieval=retrieval(entry)), context()).plan
    assert plan is not None
    return plan


NUMBERS = st.one_of(
    st.floats(), st.floats(-1, 100), st.sampled_from([0.0, 500.0, -1.0, 1e300, float("nan"), float("inf")])
)


@settings(max_examples=120)
@given(
    candidate=st.one_of(st.none(), st.sampled_from([name for name in ("nothing", "")]), st.integers(0, 3)),
    changes=st.dictionaries(
        st.sampled_from(["force", "aperture", "standoff", "speed", "yaw", "position", "type"]), NUMBERS, max_size=4
    ),
)
def test_what_passes_keeps_every_limit(candidate: object, changes: dict[str, float]) -> None:
    """Any choice is refused with a reason, or gives a plan for the same target within workspace, opening, force and speed."""
    plan = planned()
    names = (plan.candidate, *(name for _, _, name in plan.alternatives))
    name = names[candidate % len(names)] if isinstance(candidate, int) else candidate
    try:
        args = ChooseArgs.model_validate({"plan": plan, "percept": SCENE, "candidate": name, "changes": changes})
    except ValueError:
        return  # not finite: it never even becomes a choice
    got = choose_grasp(args, context())
    if got.plan is None:
        assert got.refused
        return
    target, grasp = SCENE.objects[0], got.plan.grasp
    assert got.plan.target == plan.target
    assert len(got.plan.joints) == 7
    assert TABLE_LOWER[0] <= grasp.position[0] <= TABLE_UPPER[0]
    assert TABLE_LOWER[1] <= grasp.position[1] <= TABLE_UPPER[1]
    assert (grasp.position[0] ** 2 + grasp.position[1] ** 2) ** 0.5 <= REACH
    assert outside(grasp, target) <= 0.02
    assert got.plan.local_width + 0.002 <= grasp.aperture + 1e-9 or grasp.aperture == MAX_APERTURE
    assert grasp.force <= MAX_FORCE
    bears = CLOSING_PEAK * DAMAGE_SPREAD * maximum_force(target.affordance.fragility)
    alternatives = {n: g for g, _, n in plan.alternatives}
    base = alternatives.get(got.plan.candidate, plan.grasp)
    assert grasp.force <= max(bears, base.force) + 1e-9
    assert grasp.speed <= base.speed
    for field in changes:
        assert any(item.id == "brain" for item in got.plan.provenance[field])  # type: ignore[index]


def test_the_plan_itself_passes_untouched() -> None:
    """Acting on the plan as it is gives the very plan."""
    situation = Situation(plan=planned(), percept=SCENE, goal=Goal(kind="pick", target="obj_0"))
    got, plan = judged_thought(Deliberation(text="go"), situation, lambda a: choose_grasp(a, context()), 0)
    assert plan is planned()
    assert got.choice == "act"


def test_a_plan_for_what_is_not_there_or_not_meant_is_refused() -> None:
    """An absent target, and a target that the task is not about."""
    absent = Situation(plan=planned().model_copy(update={"target": "obj_7"}), percept=SCENE)
    other = Situation(plan=planned(), percept=SCENE, goal=Goal(kind="pick", target="obj_1"))
    for situation, says in ((absent, "not on the table"), (other, "the task is about")):
        with pytest.raises(RefusedError, match=says):
            judged_thought(Deliberation(text="go"), situation, lambda a: choose_grasp(a, context()), 0)


@given(force=st.floats(1.0, 70.0), fragility=st.floats(0.0, 1.0))
def test_force_bounds_contain_the_plan_and_never_grow_past_what_the_object_bears(
    force: float, fragility: float
) -> None:
    """Low <= planned <= high, and above the plan only up to what the weakest specimen bears."""
    target = SCENE.objects[0]
    target = target.model_copy(update={"affordance": target.affordance.model_copy(update={"fragility": fragility})})
    low, high = force_bounds(force, target)
    assert low <= force <= high <= MAX_FORCE
    assert high <= max(force, CLOSING_PEAK * DAMAGE_SPREAD * maximum_force(fragility))


@given(
    x=st.floats(-2, 2), y=st.floats(-2, 2), z=st.floats(-1, 2), aperture=st.floats(0, 0.08), force=st.floats(1, 70),
    speed=st.floats(0.1, 1.0), standoff=st.floats(0.02, 0.2), down=st.floats(-1.0, 1.0),
)  # fmt: skip
def test_limits_hold_for_any_grasp(
    x: float, y: float, z: float, aperture: float, force: float, speed: float, standoff: float, down: float
) -> None:
    """What is not refused is at the target, open enough, and no stronger or faster than allowed."""
    plan, target = planned(), SCENE.objects[0]
    grasp = Grasp(
        position=(x, y, z), approach=(0.0, (1 - down * down) ** 0.5, down), yaw=0.0, aperture=aperture, force=force,
        type="pinch", standoff=standoff, speed=speed,
    )  # fmt: skip
    if refuse_grasp(grasp, plan.grasp, target, plan.local_width) is None:
        low, high = force_bounds(plan.grasp.force, target)
        assert outside(grasp, target) <= 0.02
        assert low - 1e-6 <= force <= high + 1e-6
        assert speed <= plan.grasp.speed + 1e-6
        assert z >= 0.0
        assert down <= 0.35


@pytest.mark.parametrize(
    ("said", "meant", "passes"),
    [
        ("pick up the cup", "clear the table", False), ("pick up the cup", "sort by size", False),
        ("put the cup in the bin", "put all the cups in the bin", False), ("pick up the cup", "pick up the cup", True),
        ("clear the table", "clear the table", True), ("tidy up but keep the cup", "clear the table", True),
        ("put both cups in the bin", "put both cups in the bin", True), ("make this place spotless", "clear the table", True),
    ],
)  # fmt: skip
def test_who_speaks_of_one_thing_has_one_thing_moved(said: str, meant: str, passes: bool) -> None:
    """Where the grammar reads single things, a model may not make many of them; where it reads nothing, the model's word
    counts."""
    got, situation = understand(meant), Situation(instruction=said)
    assert got.goals
    if passes:
        assert judged_understanding(got, situation) is got
    else:
        with pytest.raises(RefusedError, match="single things"):
            judged_understanding(got, situation)


def test_only_offered_corrections_pass() -> None:
    """The correction must be one of those allowed, unchanged."""
    offered = Correction(failure="SLIP", level=1, rule="slip: force x 1.2", changes={"force": 12.0})
    stronger = offered.model_copy(update={"changes": {"force": 500.0}})
    situation = Situation(allowed=(offered,))
    assert judged_reflection(Reflected(text="x", correction=offered), situation).correction is offered
    with pytest.raises(RefusedError):
        judged_reflection(Reflected(text="x", correction=stronger), situation)
    with pytest.raises(RefusedError):
        judged_reflection(Reflected(text="x", correction=None), situation)


@pytest.mark.parametrize(
    ("text", "passes"),
    [("It took 12.3 N.", True), ("It took 12 N.", True), ("It took 13 N.", False), ("", False), ("x" * 1300, False)],
)
def test_answers_have_the_facts_numbers_only(text: str, passes: bool) -> None:
    """A number may be rounded, and may not be invented."""
    situation = Situation(facts="force 12.3 N, opening 80 mm")
    if passes:
        assert judged_answer(Spoken(text=text), situation).text == text
    else:
        with pytest.raises(RefusedError):
            judged_answer(Spoken(text=text), situation)


@given(calls=st.integers(0, 200), tokens=st.integers(0, 10**6), seconds=st.floats(0, 2000))
def test_the_budget_is_spent_exactly_when_one_part_is(calls: int, tokens: int, seconds: float) -> None:
    """Calls, tokens and seconds each end the model's part."""
    limits = BrainLimits()
    over = calls >= limits.calls or tokens >= limits.tokens or seconds >= limits.seconds
    assert (limits.spent(ModelUse(calls=calls, prompt_tokens=tokens), seconds) is not None) == over
