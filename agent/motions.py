"""The nodes around a motion: approval, Action, Observation, reflection and memory (Algorithm 1; stages 6 and 7)."""

from __future__ import annotations

from langgraph.runtime import Runtime
from langgraph.types import interrupt

from agent import events, phrases
from agent.agenda import finish
from agent.approval import Decision, apply_decision, proposal
from agent.ask_brain import ask_reflection
from agent.attempt import Attempt, Held, in_hand
from agent.chat.steer import steered
from agent.compare_looks import compare_looks
from agent.context import AgentContext
from agent.episode import history, with_success
from agent.kept_force import force_kept
from agent.ladder import budget, irreversible, level_of
from agent.nodes import look
from agent.placing import put_back_args
from agent.state import State, Update, merged
from agent.traced_tools import classify_failure, correct_grasp, execute_grasp, place_object
from kb.percept import Percept
from kb.sensing import Correction, Evidence
from tools.classify_failure import ClassifyArgs, Diagnosis
from tools.correct_grasp import CorrectArgs
from tools.diagnosis.held_look import look_at_places, worth_a_look
from tools.execute_grasp import ExecuteArgs
from tools.planning.obstacles import obstacles

Run = Runtime[AgentContext]


def approve(state: State, runtime: Run) -> Update:
    """A person decides about the motion; the graph waits here, even over a restart."""
    assert state.plan is not None
    decision = Decision.model_validate(interrupt(proposal(state)))
    text = phrases.decided(decision)
    runtime.context.emit(events.Approval(text=text, goal=state.current, plan=state.plan, decision=decision.verdict))
    if decision.verdict == "reject":
        return Update(agenda=(), goals=finish(state, claimed=False, note="you did not approve it").get("goals", ()))
    if decision.verdict == "steer":
        changed = steered(state, decision.words, context=runtime.context)
        if "agenda" in changed or changed.get("plan", state.plan) is None:
            return changed
        decision = Decision(verdict="reject")  # nothing was understood that could be heeded: nothing may move
        return merged(
            changed,
            Update(agenda=(), goals=finish(state, claimed=False, note="you wanted it otherwise").get("goals", ())),
        )
    return Update(plan=apply_decision(state.plan, decision))


def act(state: State, runtime: Run) -> Update:
    """Action: the robot moves."""
    context, times = runtime.context, dict[str, float]()
    assert state.plan is not None
    assert state.percept is not None
    assert state.goal.target is not None
    opened = context.world.at(state.world)
    number = state.attempts[-1].number + 1 if state.attempts else 0
    context.emit(
        events.Action(
            text=phrases.action(state.plan, state.level),
            goal=state.current,
            tool="execute_grasp",
            plan=state.plan,
            level=state.level,
            attempt=len(state.tries()),
            motion=opened.motions,
        )
    )
    context.world.moving()
    weigh = state.correction is not None and state.correction.weigh
    args = ExecuteArgs(plan=state.plan, percept=state.percept, target=state.goal.target, weigh=weigh)
    with context.timed("execution", times):
        sensing = execute_grasp(args, context.tool("act", number))
    motion = opened.motions
    attempt = Attempt(
        number=number, turn=state.turn, goal=state.agenda[-1], level=state.level, plan=state.plan,
        target=phrases.target_of(state), percept=state.percept, constraints=state.constraints, sensing=sensing, correction=state.correction,
        thought=state.thought, motion=motion, before=opened.physics_of(context.world.before(state.world)),
    )  # fmt: skip
    return Update(
        sensing=sensing, camera=None, attempts=(attempt,), world=context.world.moved(), stale=True, executed=True,
        before=state.percept, times=times,
    )  # fmt: skip


def set_back(state: State, runtime: Run) -> Update:
    """After a failure something may still hang in the hand: it goes back onto the table before anybody looks.

    An empty hand drives home: from where it failed, the arm would hide the target from the cameras.
    """
    context, last, times = runtime.context, state.attempts[-1], dict[str, float]()
    opened = context.world.at(state.world)
    if context.stopped:
        return Update()
    if not opened.robot.holding:
        return _out_of_the_picture(state, context, times)
    context.emit(
        events.Action(
            text="I put back what is in my hand.", goal=state.current, tool="place_object", motion=opened.motions + 1
        )
    )
    context.world.moving()
    with context.timed("execution", times):
        back = put_back_args(last.model_copy(update={"target": in_hand(last)}))
        place_object(back, context.tool("place", opened.motions))
        if opened.robot.holding:  # no free place: better let go here than carry it into the next attempt
            opened.robot.release_and_home()
    return Update(world=context.world.moved(), stale=True, times=times)


def _out_of_the_picture(state: State, context: AgentContext, times: dict[str, float]) -> Update:
    """The empty arm drives home, if it has left home."""
    if state.attempts[-1].sensing.phase == "plan":
        return Update()
    opened = context.world.at(state.world)
    context.world.moving()
    with context.timed("execution", times):
        opened.robot.go_home(obstacles(_before(state)))
    return Update(world=context.world.moved(), stale=True, times=times)


def look_after(state: State, runtime: Run) -> Update:
    """Not sure, or failed: look, for the diagnosis now and for the next attempt (ledger G46)."""
    assert state.before is not None
    assert state.goal.target is not None
    update = look(state, runtime)
    after = update.get("percept")
    assert after is not None
    camera = compare_looks(state.before, after, state.goal.target)
    return merged(update, Update(camera=camera))


def observe(state: State, runtime: Run) -> Update:
    """Observation: success or which of the 14 failures, from the robot's own sensing alone.

    Where another thing might be in the hand, or a reading is odd, it looks which place has become empty before it says.
    """
    context, times = runtime.context, dict[str, float]()
    attempt = state.attempts[-1]
    diagnosis = _diagnosed(state, attempt, context, times)
    sure = diagnosis.claimed
    if state.camera is None and worth_a_look(attempt.sensing, _before(state), attempt.target, sure=sure):
        context.world.at(state.world)
        tool = context.tool("look at places", attempt.number)
        with context.timed("perception", times):
            places = look_at_places(attempt.sensing, _before(state), attempt.target, tool)
        attempt = attempt.model_copy(update={"places": places})
        diagnosis = _diagnosed(state, attempt, context, times)
    if not diagnosis.claimed and context.oracle_failure is not None:
        diagnosis = diagnosis.model_copy(
            update={"failure": context.oracle_failure(attempt.motion, attempt.target) or diagnosis.failure}
        )
    judged = attempt.model_copy(
        update={
            "camera": state.camera, "claimed": diagnosis.claimed, "failure": diagnosis.failure,
            "confidence": diagnosis.confidence, "reasons": diagnosis.reasons,
        }
    )  # fmt: skip
    if diagnosis.claimed or state.camera is not None:
        context.emit(
            events.Observation(
                text=phrases.observed(judged),
                goal=state.current,
                sensing=attempt.sensing,
                claimed=diagnosis.claimed,
                failure=diagnosis.failure,
                attempt=len(state.tries()) - 1,
            )
        )
    return Update(diagnosis=diagnosis, attempts=(judged,), times=times)


def _before(state: State) -> Percept:
    """The look before the last motion."""
    assert state.before is not None
    return state.before


def _diagnosed(state: State, attempt: Attempt, context: AgentContext, times: dict[str, float]) -> Diagnosis:
    """What all that is known of the attempt by now says about it."""
    args = ClassifyArgs(
        plan=attempt.plan,
        evidence=Evidence(sensing=attempt.sensing, camera=state.camera, places=attempt.places),
        constraints=state.constraints,
        target=attempt.target,
        percept=_before(state),
    )
    with context.timed("brain", times):
        return classify_failure(args, context.tools)


def reflect(state: State, runtime: Run) -> Update:
    """Reflection: the correction at the level of the next attempt, or an honest end."""
    context, times = runtime.context, dict[str, float]()
    tries, last = state.tries(), state.attempts[-1]
    broken = irreversible(last.target, state.camera, last.sensing)
    if broken or context.stopped or (len(tries) >= budget(context.switches) and not force_kept(last)):
        why = broken or ("stopped" if context.stopped else phrases.exhausted(tries))
        context.emit(events.Reflection(text=phrases.give_up(why, last), goal=state.current, level=state.level))
        held = None
        if context.world.at(state.world).robot.holding:  # stopped in the middle: the next command must know
            held = Held(plan=last.plan, object=last.target, category=last.target.category, motion=last.motion)
        return merged(Update(held=held), finish(state, claimed=False, note=why))
    named = force_kept(last)
    if named is not None:
        context.emit(events.Reflection(text=phrases.give_up(named, last), goal=state.current, level=state.level))
        return finish(state, claimed=False, note=named)
    level, offered = level_of(len(tries), context.switches), None
    allowed: tuple[Correction, ...] = ()
    if context.switches.diagnosis_used:
        args = CorrectArgs(
            failure=last.failure or "UNKNOWN",
            level=level,
            plan=last.plan,
            evidence=Evidence(sensing=last.sensing, camera=state.camera),
            retrieval=state.experiences,
            constraints=state.constraints,
            history=history(state),
        )
        with context.timed("brain", times):
            offered = correct_grasp(args, context.tool("correct", last.number))
            allowed = allowed_corrections(args, offered, context) if context.guarded else (offered,)
    with context.timed("brain", times):
        decided = ask_reflection(state, context, offered, allowed)
    reflected = decided.value
    if reflected.correction is not None:
        level = reflected.correction.level
    context.emit(
        events.Reflection(text=reflected.text, goal=state.current, correction=reflected.correction, level=level)
    )
    if reflected.give_up:
        over = finish(state, claimed=False, note=reflected.text)
        return merged(Update(times=times, use=decided.use), over)
    return Update(correction=reflected.correction, level=level, times=times, use=decided.use)


def allowed_corrections(args: CorrectArgs, offered: Correction, context: AgentContext) -> tuple[Correction, ...]:
    """The corrections that a brain may choose from: the one of this level, and those of the levels above it."""
    higher = [
        correct_grasp(args.model_copy(update={"level": level}), context.tool("correct higher", level))
        for level in range(args.level + 1, 4)
    ]
    return (offered, *higher)


def remember(state: State, runtime: Run) -> Update:
    """Success: M <- M + (category, strategy); the object is in the hand now."""
    context, last = runtime.context, state.attempts[-1]
    held = Held(
        plan=last.plan,
        object=last.target,
        category=last.target.category,
        load=last.sensing.load_end,
        motion=last.motion,
    )
    memory = with_success(state) if context.switches.memory else state.memory
    if context.switches.memory:
        context.emit(
            events.Remembered(text=phrases.remembered(last), goal=state.current, category=last.target.category)
        )
    update = Update(memory=memory, held=held)
    if state.goal.placement is not None:
        return update
    return merged(update, finish(state, claimed=True))
