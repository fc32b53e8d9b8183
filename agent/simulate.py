"""What would have happened otherwise: the saved moment before an attempt, run again in a world apart, never guessed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from langgraph.runtime import Runtime

from agent import events, phrases
from agent.agenda import finish
from agent.attempt import Attempt
from agent.context import AgentContext
from agent.draws import draws
from agent.kept_force import held_with
from agent.state import State, Update, merged
from kb.percept import Percept
from kb.sensing import Evidence, Plan, Sensing
from tools.classify_failure import ClassifyArgs, Diagnosis, classify_failure
from tools.context import ToolContext
from tools.execute_grasp import ExecuteArgs, execute_grasp
from tools.plan_grasp import PlanArgs, PlanOutcome, plan_grasp
from tools.planning.demand import Demand
from tools.retrieve_haarag import RetrieveArgs, retrieve_haarag


def simulate(state: State, runtime: Runtime[AgentContext]) -> Update:
    """Runs the last attempt again with the asked force in a separate world; this world stays untouched."""
    context, force = runtime.context, state.goal.force
    last = last_grasp(state)
    if last is None or force is None:
        return finish(
            state,
            claimed=False,
            note="I have grasped nothing yet in this conversation, so there is nothing to simulate.",
        )
    grasp = last.plan.grasp.model_copy(update={"force": force})
    plan = last.plan.model_copy(update={"grasp": grasp, "own_force": last.plan.grasp.force})
    name = phrases.object_name(last.target.category)
    text = f"I simulate the grasp of the {name} from the saved moment before it, with {force:g} N instead of "
    context.emit(events.Thought(text=f"{text}{held_with(last):.1f} N.", goal=state.current))
    times: dict[str, float] = {}
    with context.timed("execution", times):
        run = rerun(context, last, plan)
    note = told(run, f"{force:g} N", last)
    context.emit(
        events.Observation(text=note, goal=state.current, claimed=run.diagnosis.claimed, failure=run.diagnosis.failure)
    )
    return merged(Update(times=times), finish(state, claimed=True, note=note))


@dataclass(frozen=True)
class Rerun:
    """How a grasp ended in the world apart."""

    diagnosis: Diagnosis
    sensing: Sensing
    views: tuple[Any, ...] = ()
    """Pictures of the end (`kb.rgbd.RgbdView`), if they were asked for."""


def last_grasp(state: State) -> Attempt | None:
    """The latest attempt whose moment was saved."""
    return next((a for a in reversed(state.attempts) if a.before), None)


def rerun(context: AgentContext, attempt: Attempt, plan: Plan, *, pictures: bool = False) -> Rerun:
    """Executes `plan` in another world from the moment before `attempt`.

    Args:
        context: The agent's; its own world stays untouched.
        attempt: The attempt whose saved moment is gone back to.
        plan: What is executed there.
        pictures: Whether to look at the end.
    """
    tools = _apart(context, attempt)
    percept = _percept(attempt)
    weigh = attempt.correction is not None and attempt.correction.weigh
    sensing = execute_grasp(ExecuteArgs(plan=plan, percept=percept, target=attempt.target.id, weigh=weigh), tools)
    views = tuple(tools.robot.look(draws(context.seed, "whatif", attempt.number))) if pictures else ()
    diagnosis = classify_failure(
        ClassifyArgs(
            plan=plan,
            evidence=Evidence(sensing=sensing),
            constraints=attempt.constraints,
            target=attempt.target,
            percept=percept,
        ),
        tools,
    )
    return Rerun(diagnosis, sensing, views)


def replan(context: AgentContext, attempt: Attempt, demands: tuple[Demand, ...]) -> PlanOutcome:
    """A grasp for the moment before `attempt` that does what is demanded, on the same look and the same experiences."""
    target = attempt.target
    tools = _apart(context, attempt)
    retrieval = None
    if context.switches.retrieval != "none":
        retrieval = retrieve_haarag(
            RetrieveArgs(category=target.category, affordance=target.affordance, embedding=target.embedding), tools
        )
    args = PlanArgs(
        percept=_percept(attempt),
        target=target.id,
        retrieval=retrieval,
        constraints=attempt.constraints,
        correction=attempt.correction,
        demands=demands,
    )
    return plan_grasp(args, tools)


def _apart(context: AgentContext, attempt: Attempt) -> ToolContext:
    """The tools in the world apart, at the moment before the attempt."""
    other = context.world.apart()
    other.restore(attempt.before)
    tools = context.tools.with_rng(draws(context.seed, "act", attempt.number))
    tools.robot, tools.stop = other.robot, other.stop
    return tools


def _percept(attempt: Attempt) -> Percept:
    return attempt.percept or Percept(look=0, perception="rgbd", objects=(attempt.target,))


def told(run: Rerun, changed: str, attempt: Attempt) -> str:
    """The outcome in words, beside what really happened."""
    diagnosis, name = run.diagnosis, phrases.object_name(attempt.target.category)
    if run.sensing.stopped_by == "stop":
        return f"I was stopped while I simulated {changed}, so I do not know."
    if diagnosis.claimed:
        load = run.sensing.load_end * 1000
        what = f"Simulated with {changed}: the {name} would have been lifted and held ({load:.0f} g in the hand)."
    else:
        kind = phrases.plain(diagnosis.failure or "UNKNOWN").lower()
        what = f"Simulated with {changed}: it would have failed by {kind} ({'; '.join(diagnosis.reasons)})."
    return f"{what} In truth, with {held_with(attempt):.1f} N, it {phrases.ended(attempt)}."
