"""What would have happened with another force: the saved moment before the last attempt, simulated again, never guessed."""

from __future__ import annotations

from langgraph.runtime import Runtime

from agent import events, phrases
from agent.agenda import finish
from agent.attempt import Attempt
from agent.context import AgentContext
from agent.draws import draws
from agent.state import State, Update, merged
from kb.percept import Percept
from kb.sensing import Evidence, Plan
from tools.classify_failure import ClassifyArgs, Diagnosis, classify_failure
from tools.execute_grasp import ExecuteArgs, execute_grasp


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
    plan = last.plan.model_copy(update={"grasp": last.plan.grasp.model_copy(update={"force": force})})
    name = phrases.plain(last.target.category)
    text = f"I simulate the grasp of the {name} from the saved moment before it, with {force:g} N instead of "
    context.emit(events.Thought(text=f"{text}{last.plan.grasp.force:.1f} N.", goal=state.current))
    times: dict[str, float] = {}
    with context.timed("execution", times):
        diagnosis, load = rerun(context, last, plan)
    note = told(diagnosis, force, last, name, load)
    context.emit(
        events.Observation(text=note, goal=state.current, claimed=diagnosis.claimed, failure=diagnosis.failure)
    )
    return merged(Update(times=times), finish(state, claimed=True, note=note))


def last_grasp(state: State) -> Attempt | None:
    """The latest attempt whose moment was saved."""
    return next((a for a in reversed(state.attempts) if a.before), None)


def rerun(context: AgentContext, last: Attempt, plan: Plan) -> tuple[Diagnosis, float]:
    """Executes `plan` in another world from the moment before `last`: the robot's own diagnosis, and the load [kg]."""
    other = context.world.opened.reopen()
    other.restore(last.before)
    percept = last.percept or Percept(look=0, perception="rgbd", objects=(last.target,))
    tools = context.tools.with_rng(draws(context.seed, "act", last.number))
    tools.robot, tools.stop = other.robot, other.stop
    sensing = execute_grasp(ExecuteArgs(plan=plan, percept=percept, target=last.target.id), tools)
    diagnosis = classify_failure(
        ClassifyArgs(
            plan=plan,
            evidence=Evidence(sensing=sensing),
            constraints=last.constraints,
            target=last.target,
            percept=percept,
        ),
        tools,
    )
    return diagnosis, sensing.load_end


def told(diagnosis: Diagnosis, force: float, last: Attempt, name: str, load: float) -> str:
    """The outcome in words, beside what really happened."""
    reasons = "; ".join(diagnosis.reasons)
    if diagnosis.claimed:
        what = (
            f"Simulated with {force:g} N: the {name} would have been lifted and held ({load * 1000:.0f} g in the hand)."
        )
    else:
        kind = phrases.plain(diagnosis.failure or "UNKNOWN").lower()
        what = f"Simulated with {force:g} N: it would have failed by {kind} ({reasons})."
    real = "it held" if last.claimed else f"it failed by {phrases.plain(last.failure or 'UNKNOWN').lower()}"
    return f"{what} In truth, with {last.plan.grasp.force:.1f} N, {real}."
