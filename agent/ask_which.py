"""Several things fit: which one is meant, which one first, or a clearing of exactly these."""

from __future__ import annotations

from agent import events
from agent.goal import Goal, Reference
from agent.grounded import Grounded, failed, say
from agent.language.describe import describe, spoken
from agent.language.resolve import Resolution
from agent.phrases import object_name
from agent.state import State, Update
from kb.percept import Percept


def choices(got: Resolution, percept: Percept) -> tuple[str, tuple[str, ...]]:
    """What fits, as "a, b or c", and one by one."""
    things = [obj for obj in percept.objects if obj.id in got.ids]
    names = tuple(describe(obj, percept.objects) for obj in things)
    return (", ".join(names[:-1]) + " or " + names[-1] if len(names) > 1 else names[0] if names else ""), names


def ask(state: State, index: int, reference: Reference, got: Resolution, percept: Percept) -> Grounded:
    """Asks back which one is meant, and remembers what the question was about."""
    text, names = choices(got, percept)
    question = f"Which one do you mean by {spoken(reference)}: {text}?"
    update = Update(
        refused=True, answer=question, question=question, agenda=(), goals=failed(state, "asked back"),
        pending=state.goals[index],
    )  # fmt: skip
    return Grounded(update, (events.Grounding(text=f"{len(names)} objects fit.", goal=state.current),))


def one_of(state: State, index: int, got: Resolution, percept: Percept) -> Grounded:
    """One hand for several things: asks with which to begin, and says what can be done with all of them."""
    goal = state.goals[index]
    assert goal.reference is not None
    all_of_them = len(got.ids) == len(percept.objects)
    names = "everything" if all_of_them else spoken(goal.reference)
    others = [f'"put {names} in the bin"'] if percept.bin is not None else []
    others += ['"sort by size"'] if all_of_them else []
    what = f" For all of them say {' or '.join(others)}." if others else ""
    text = choices(got, percept)[0]
    held = state.held.object if state.held is not None else None
    if held is not None and held.id in got.ids and all(obj.id != held.id for obj in percept.objects):
        text += f" or the {object_name(held.category)} in my hand"
    question = f"I can hold only one thing at a time. Which one first: {text}?{what}"
    single = Reference(words="the one", noun="one", ids=())
    update = Update(
        refused=True, answer=question, question=question, agenda=(), goals=failed(state, "asked back"),
        pending=goal.model_copy(update={"reference": single}),
    )  # fmt: skip
    return Grounded(update, (events.Grounding(text=f"{len(got.ids)} objects fit.", goal=state.current),))


def several(state: State, index: int, got: Resolution, percept: Percept) -> Grounded:
    """For "put the blocks in the bin": a clear goal for exactly these objects."""
    goal = state.goals[index]
    assert goal.reference is not None
    ids = got.ids[: goal.reference.count] if goal.reference.count else got.ids
    if goal.reference.count and len(got.ids) < goal.reference.count:
        return say(state, f"I see only {len(got.ids)} of them: {choices(got, percept)[0]}.")
    clear = Goal(kind="clear", reference=goal.reference.model_copy(update={"ids": ids}), placement=goal.placement)
    goals = (*state.goals[:index], clear, *state.goals[index + 1 :])
    names = choices(Resolution(ids=ids), percept)[0].replace(" or ", " and ")
    return Grounded(Update(goals=goals), (events.Grounding(text=f"That is {names}.", goal=index),))
