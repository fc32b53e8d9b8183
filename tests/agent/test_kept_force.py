"""A force that a person names is kept, told honestly, and never raised behind their back."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from agent.attempt import Attempt
from agent.chat import Conversation
from agent.chat.explain import explain
from agent.chat.hear import relative
from agent.kept_force import force_kept, raised, warned
from agent.phrases import ended
from agent.run_result import run_result
from agent.state import State
from kb.sensing import Plan, Sensing
from tests.planning_fixtures import context, cup, percept
from tools.context import ToolContext
from tools.execute_grasp import ExecuteArgs, execute_grasp, trial_lift_cap
from tools.plan_grasp import PlanArgs, plan_grasp
from tools.planning.demand import Demand

SEEN = percept(cup("t", 0.5, 0.0).model_copy(update={"category": "unknown", "fragility_range": (0.1, 0.6)}))


def plan(*demands: Demand) -> Plan:
    """The plan for an object of unknown kind, as demanded."""
    made = plan_grasp(PlanArgs(percept=SEEN, target="t", demands=demands), context()).plan
    assert made is not None
    return made


def attempt(made: Plan, failure: Any = None, **sensed: Any) -> Attempt:
    """An attempt with that plan."""
    return Attempt(
        number=0, turn=0, goal=0, level=0, plan=made, target=SEEN.objects[0], sensing=Sensing(**sensed),
        claimed=failure is None, failure=failure,
    )  # fmt: skip


class Recorder:
    """A robot that only writes down up to which force a test lift may go."""

    most: float | None = 0.0

    def grasp(self, grasp: Any, **options: Any) -> Sensing:
        self.most = options["most_force"]
        return Sensing()


@pytest.mark.parametrize(
    ("demands", "raisable"),
    [
        ((), True),
        ((Demand(words="gently", force_scale=0.7),), True),
        ((Demand(words="with 3 N", force=3.0),), False),
    ],
)
def test_no_test_lift_raises_a_force_that_was_named(demands: tuple[Demand, ...], raisable: bool) -> None:
    """With a number of the person's the grip stays there; without one, or with a wish, an unknown thing is tried out."""
    robot = Recorder()
    execute_grasp(ExecuteArgs(plan=plan(*demands), percept=SEEN, target="t"), ToolContext(robot=robot))
    assert robot.most == (trial_lift_cap(SEEN.objects[0], plan(*demands).region) if raisable else None)
    assert trial_lift_cap(SEEN.objects[0]) is not None


def test_what_slips_at_a_named_force_ends_with_an_offer() -> None:
    """The correction of a slip is more force, which may not be taken; without a named force nothing is said."""
    named = plan(Demand(words="with 3 N", force=3.0))
    assert named.own_force == plan().grasp.force
    told = force_kept(attempt(named, "SLIP", load_lifted=0.05))
    assert told is not None
    assert '3.0 N, which I kept because you said "with 3 N"' in told
    assert f"I would take {named.own_force:.0f} N" in told
    assert force_kept(attempt(plan(), "SLIP", load_lifted=0.05)) is None
    assert force_kept(attempt(named, "COLLISION")) is None
    assert "it may slip" in warned(named)
    assert warned(plan()) == ""


def test_what_breaks_at_a_named_force_is_offered_less() -> None:
    """After a damage the offer is less force, at most what the planner would have taken."""
    named = plan(Demand(words="with 60 N", force=60.0))
    told = force_kept(attempt(named, "DEFORMATION"))
    assert told is not None
    assert f"I would take {named.own_force:.0f} N" in told
    assert "it may be pressed too hard" in warned(named)


def test_a_raised_grip_is_told() -> None:
    """Beyond a softer wish the raise is said, it is a source of the number in /why, and "gentler" counts from there."""
    wish = attempt(plan(Demand(words="gently", force_scale=0.7)), grip_raised=5.0)
    held = wish.plan.grasp.force + 5.0
    assert f"gripped it with {held:.1f} N" in raised(wish)
    assert f"raised it to {held:.1f} N" in explain(wish, None).text
    assert raised(attempt(plan(), grip_raised=5.0)) == ""
    (gentler,) = relative((Demand(words="gentler", force_scale=0.7),), State(attempts=(wish,)))
    assert gentler.force == pytest.approx(0.7 * held, abs=0.01)


def test_a_stop_is_no_type_of_failure() -> None:
    """Neither the agent's label nor the observer's stands beside a stop in the result, and it is called one."""
    stopped = attempt(plan(), "UNKNOWN", stopped_by="stop")
    from agent.goal import Goal

    state = State(attempts=(stopped,), turn=0, goals=(Goal(kind="pick", target="t", status="failed"),))
    result = run_result(
        state, None, configuration="full", brain="rules", perception="rgbd", evaluator="physics", total=1.0
    )
    (record,) = result.goals[0].attempts
    assert record.evidence["stopped_by"] == "stop"
    assert record.failure is None
    assert record.observed_failure is None
    assert ended(stopped) == "was stopped"


@pytest.fixture(scope="module")
def talk() -> Iterator[Conversation]:
    """A conversation with true positions and real physics."""
    with Conversation.open("cup_near_vase", 10_003, perception="oracle") as conversation:
        yield conversation


def test_too_little_force_is_tried_once_and_more_is_offered(talk: Conversation) -> None:
    """A cup slips out of 3 N: one attempt at 3 N, and the answer names the number and a better one."""
    events: dict[str, Any] = {event.kind: event for event in talk.say("pick up the cup with 3 newtons")}
    told = events["finished"].result
    assert not told.success
    assert [a.plan.grasp.force for a in talk.state.attempts] == [3.0]
    assert max(a.sensing.motor_force_closed for a in talk.state.attempts) < 3.3
    assert 'because you said "with 3 newtons"' in told.answer
    assert "I would take" in told.answer
