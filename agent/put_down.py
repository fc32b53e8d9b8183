"""The nodes that put down what is in the hand, and look whether it is where it was to go.

What the robot itself sensed of a placing says that it let go, not that a ball did not roll off afterwards: it claims a
placing only after a look, and takes up again what is not where it should be.
"""

from __future__ import annotations

from langgraph.runtime import Runtime

from agent import events
from agent.agenda import finish
from agent.attempt import Moved
from agent.context import AgentContext
from agent.in_bin import with_another
from agent.ladder import MAX_RELOOKS, budget
from agent.nodes import look
from agent.placed import placed, placing
from agent.placing import origin_of, place_args
from agent.seen_placed import called_as_before, seen_placed
from agent.state import State, Update, merged
from agent.traced_tools import place_object

Run = Runtime[AgentContext]


def place(state: State, runtime: Run) -> Update:
    """Puts down (or hands over) what is in the hand."""
    context, times = runtime.context, dict[str, float]()
    assert state.held is not None
    opened = context.world.at(state.world)
    context.emit(
        events.Action(
            text=placing(state.goal, state.held), goal=state.current, tool="place_object", motion=opened.motions
        )
    )
    context.world.moving()
    with context.timed("execution", times):
        sensing = place_object(place_args(state), context.tool("place", opened.motions))
    claimed, note = placed(sensing, state.goal, origin_of(state))
    context.emit(events.Observation(text=note, goal=state.current, sensing=sensing, claimed=claimed))
    handed = claimed and state.goal.placement is not None and state.goal.placement.kind == "hand_over"
    still = state.held.model_copy(update={"handed_over": handed}) if opened.robot.holding else None
    update = Update(
        world=context.world.moved(),
        stale=True,
        executed=True,
        sensing=sensing,
        held=still,
        moved=Moved(id=state.held.object.id, category=state.held.category, origin=state.held.object.position),
        displaced=(*state.displaced, state.held.object.id),
        motions={**state.motions, state.agenda[-1]: opened.motions},
        times=times,
    )
    if still is None and (claimed or sensing.lost):
        return merged(update, Update(put_down=state.held, relooks=0))
    if still is None and not claimed and _may_try_again(state, context):
        return update  # it is no longer in the hand: the goal goes on with another attempt from where it lies now
    return merged(update, finish(state, claimed=claimed, note="" if claimed else note))


def look_at_placed(state: State, runtime: Run) -> Update:
    """After a placing: is the thing where it was put, standing as it stood? If not, the goal goes on, or ends honestly."""
    context, put = runtime.context, state.put_down
    assert put is not None
    assert state.percept is not None
    update = look(state, runtime)
    percept = update.get("percept")
    assert percept is not None
    percept = called_as_before(percept, state.percept, put.object, state.sensing)
    update["percept"] = percept
    seen = seen_placed(percept, state.goal, put.object, state.sensing)
    if seen.thing is None and state.relooks < MAX_RELOOKS:
        return merged(update, Update(relooks=state.relooks + 1))  # other noise may show it
    if seen.well:
        if state.goal.placement is not None and state.goal.placement.kind == "bin":
            update["in_bin"] = with_another(state.in_bin, put.object, state.sensing, percept.bin)
        return merged(update, Update(put_down=None), finish(state, claimed=True))
    context.emit(events.Observation(text=seen.words, goal=state.current, sensing=state.sensing, claimed=False))
    if seen.thing is not None and not seen.fallen and _may_try_again(state, context):
        return merged(update, Update(put_down=None, plan=None, correction=None, camera=None, relooks=0))
    return merged(update, Update(put_down=None), finish(state, claimed=False, note=seen.words))


def _may_try_again(state: State, context: AgentContext) -> bool:
    """Whether the goal's budget allows another grasp; what was taken for another goal is not taken again for this one."""
    return bool(state.tries()) and len(state.tries()) < budget(context.switches) and not context.stopped
