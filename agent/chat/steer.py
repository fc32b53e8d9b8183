"""A person's word between two steps: another manner, another thing, another place, or no more at all."""

from __future__ import annotations

import re

from langchain_core.messages import HumanMessage

from agent.agenda import changed, finish, fresh
from agent.chat.events import Heeded, Noted
from agent.chat.hear import hear, merged_demands, relative, thing_instead
from agent.chat.read_demand import only_demand, plain
from agent.context import AgentContext
from agent.goal import Goal, Placement, Reference
from agent.ground import destination, scope_of
from agent.language.read_command import understand
from agent.language.read_reference import is_reference, read_reference
from agent.language.resolve import resolve
from agent.state import State, Update, merged
from kb.errors import BadInputError

SPARE = re.compile(
    r"^(?:no ,? ?|but |and |please |wait ,? ?)*(?:not|leave|keep|skip|spare|except|without|but not|do not (?:take|touch|move|clear|sort))"
    r" (?P<what>.+?)(?: alone| there| where (?:it|they) (?:is|are)| as (?:it|they) (?:is|are)| please| out)*$"
)
AROUND_A_PLACE = re.compile(
    r"^(?:(?:no|nope|not there|not that|wait|but|and|please|rather|better|instead)(?: ,)? )+|(?: ,)?(?: (?:instead|rather|please))+$"
)
"""What may stand around another place."""
STOPPED = "I am stopped. Nothing moves until you release me (/release)."


def steered(state: State, words: str, *, context: AgentContext) -> Update:
    """What the person's words change in the work at hand; what is something else is done afterwards."""
    said = Update(messages=[HumanMessage(words, id=f"steer-{state.turn}-{len(state.messages)}")])
    try:
        update = (
            _manner(state, words, context)
            or _spare(state, words, context)
            or _thing(state, words, context)
            or _place(state, words, context)
        )
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


def _spare(state: State, words: str, context: AgentContext) -> Update | None:
    """For "not the apple" while a table is cleared or sorted: that thing stays where it is."""
    index = next((i for i in state.agenda if state.goals[i].kind in ("clear", "sort")), None)
    found = SPARE.match(plain(words).strip(" ,.;"))
    if index is None or found is None or state.percept is None:
        return None
    whole = state.goals[index]
    reading = read_reference(found["what"].split())
    if whole.reference is None or reading.unknown or not is_reference(reading):
        return None
    spared = set(resolve(Reference(**{**reading.found, "plural": True}), scope_of(state)).ids)
    left = tuple(name for name in whole.reference.ids if name not in spared)
    if not left or left == whole.reference.ids:
        raise BadInputError(f"I see nothing of that kind to leave alone: {found['what']}", where="steering")
    goals = list(state.goals)
    goals[index] = whole.model_copy(update={"reference": whole.reference.model_copy(update={"ids": left})})
    update = Update(goals=tuple(goals))
    current = state.goal
    if current.target in spared and state.held is None and current.parent == index:
        # It is in work but not in the hand yet: dropped, and not counted among what was to be done.
        goals[state.agenda[-1]] = Goal(kind="answer", status="done", claimed=True, note="left alone as you said")
        update = merged(Update(goals=tuple(goals), agenda=state.agenda[:-1], plan=None), fresh())
    context.emit(Heeded(text=f"I leave {found['what']} alone.", goal=state.current, words=words, demand={}))
    return update


def _place(state: State, words: str, context: AgentContext) -> Update | None:
    """For "no, put it on the left": another place for what is taken or to be taken."""
    goal, wanted = state.goal, place_instead(words)
    if wanted is None or goal.kind != "place" or goal.parent is not None:
        return None
    placement, problem = destination(wanted, scope_of(state))
    if problem is not None:
        raise BadInputError(problem.rstrip("."), where="placement")
    context.emit(Heeded(text=f"Another place: {words}.", goal=state.current, words=words, demand={}))
    return Update(goals=changed(state, goal.model_copy(update={"placement": placement})))


def place_instead(words: str) -> Placement | None:
    """The other place that "no, on the right" or "put it next to the vase instead" speaks of."""
    line = AROUND_A_PLACE.sub("", plain(words).strip(" ,.;"))
    got = understand(line if line.startswith(("put ", "place ", "set ", "move ")) else f"put it {line}")
    one = got.goals[0] if len(got.goals) == 1 else None
    return one.placement if one is not None and one.reference is not None and one.reference.pronoun else None


def _no_more(words: str) -> bool:
    """Whether the words only say that it should not be done."""
    got = understand(words)
    plainly = plain(words).strip(" ,.")
    return plainly in ("no", "nope", "wait", "not that") or any(goal.query == "stop" for goal in got.goals)
