"""A person's word between two steps: another manner, another thing, another place, or no more at all."""

from __future__ import annotations

from langchain_core.messages import HumanMessage

from agent.agenda import changed, finish
from agent.chat.events import Heeded, Noted
from agent.chat.hear import hear, merged_demands, relative, thing_instead
from agent.chat.read_demand import only_demand, plain
from agent.context import AgentContext
from agent.goal import Goal
from agent.ground import destination, scope_of
from agent.language.read_command import understand
from agent.state import State, Update, merged
from kb.errors import BadInputError

STOPPED = "I am stopped. Nothing moves until you release me (/release)."


def steered(state: State, words: str, *, context: AgentContext) -> Update:
    """What the person's words change in the work at hand; what is something else is done afterwards."""
    said = Update(messages=[HumanMessage(words, id=f"steer-{state.turn}-{len(state.messages)}")])
    try:
        update = _manner(state, words, context) or _thing(state, words, context) or _place(state, words, context)
    except BadInputError as error:
        context.emit(Noted(text=f"{error}. I go on as I was.", goal=state.current))
        return said
    if update is not None:
        return merged(said, update)
    if _no_more(words):
        note = "you did not want it"
        return merged(said, Update(agenda=(), goals=finish(state, claimed=False, note=note).get("goals", ())))
    later = hear(words, state)
    context.emit(Noted(text=f'I heard "{words}" and come to it after this.', goal=state.current))
    return merged(said, Update(calls=(*state.calls, *later)))


def _manner(state: State, words: str, context: AgentContext) -> Update | None:
    """For "no, by the handle", "gentler": a demand on the grasp."""
    demand = only_demand(plain(words))
    if demand is None:
        return None
    (fixed,) = relative((demand,), state)
    told = fixed.model_dump(exclude={"words"}, exclude_defaults=True)
    context.emit(Heeded(text=f"You want it {demand.words}: I plan anew.", goal=state.current, words=words, demand=told))
    return Update(demands=merged_demands(state.demands, (fixed,)), plan=None)


def _thing(state: State, words: str, context: AgentContext) -> Update | None:
    """For "no, the other one": another object, as long as this one is not in the hand."""
    goal = state.goal
    reference = thing_instead(plain(words), state)
    if reference is None or goal.kind not in ("pick", "place") or state.held is not None or goal.parent is not None:
        return None
    other = Goal(kind=goal.kind, reference=reference, placement=goal.placement)
    context.emit(Heeded(text=f"You mean {reference.words}.", goal=state.current, words=words, demand={}))
    return merged(Update(goals=changed(state, other), plan=None, experiences=None, correction=None))


def _place(state: State, words: str, context: AgentContext) -> Update | None:
    """For "no, put it on the left": another place for what is taken or to be taken."""
    got = understand(f"put it {words}" if not words.lower().startswith(("put", "place", "no")) else words)
    goal = state.goal
    if len(got.goals) != 1 or got.goals[0].placement is None or goal.kind != "place" or goal.parent is not None:
        return None
    wanted = got.goals[0]
    if wanted.reference is None or not wanted.reference.pronoun:
        return None
    placement, problem = destination(wanted.placement, scope_of(state))
    if problem is not None:
        raise BadInputError(problem.rstrip("."), where="placement")
    context.emit(Heeded(text=f"Another place: {words}.", goal=state.current, words=words, demand={}))
    return Update(goals=changed(state, goal.model_copy(update={"placement": placement})))


def _no_more(words: str) -> bool:
    """Whether the words only say that it should not be done."""
    got = understand(words)
    plainly = plain(words).strip(" ,.")
    return plainly in ("no", "nope", "wait", "not that") or any(goal.query == "stop" for goal in got.goals)
