"""The agenda: which goal is in work, sub-goals pushed before it, and what comes next when one is over.

Pure functions from state to update; they move nothing.
"""

from __future__ import annotations

from dataclasses import replace

from agent.attempt import Held
from agent.goal import Goal, Placement, Reference
from agent.ladder import MAX_EXTRA_ACTIONS
from agent.state import State, Update, merged
from kb.percept import PerceivedObject, Percept
from kb.scene_graph import SceneGraph

_FRESH: Update = {
    "experiences": None, "plan": None, "plan_reason": "", "level": 0, "sensing": None, "camera": None,
    "diagnosis": None, "correction": None, "relooks": 0, "thought": "",
}  # fmt: skip
"""What belongs to one goal and must not leak into the next."""


def ordered(goals: tuple[Goal, ...]) -> tuple[int, ...]:
    """The agenda for what was asked: in the order of speaking, but what was to come first before its parent."""
    stack: list[int] = []
    for index in reversed(range(len(goals))):
        if goals[index].parent is None:
            stack.append(index)
            stack += [i for i in reversed(range(len(goals))) if goals[i].parent == index]
    return tuple(stack)


def fresh() -> Update:
    """The update that clears what belonged to the last goal."""
    return _FRESH.copy()


def changed(state: State, goal: Goal) -> tuple[Goal, ...]:
    """All goals, with the one in work replaced by `goal`."""
    index = state.agenda[-1]
    return (*state.goals[:index], goal, *state.goals[index + 1 :])


def push(state: State, goal: Goal) -> Update:
    """Adds a sub-goal and puts it in work."""
    index = len(state.goals)
    pushed = goal.model_copy(update={"parent": state.agenda[-1]})
    return merged(Update(goals=(*state.goals, pushed), agenda=(*state.agenda, index)), fresh())


def finish(state: State, *, claimed: bool, note: str = "") -> Update:
    """Ends the goal in work and takes the one below it up again; a failed removal ends its parent, too."""
    goal = state.goal
    done = goal.model_copy(
        update={"status": "done" if claimed else "failed", "claimed": claimed, "note": note or goal.note}
    )
    goals, agenda = changed(state, done), state.agenda[:-1]
    if not claimed and agenda and goal.parent == agenda[-1] and goals[agenda[-1]].kind in ("pick", "place"):
        below = replace(state, goals=goals, agenda=agenda)
        why = f"{describe(goal)} had to come first, and that failed" + (f": {note}" if note else "")
        return finish(below, claimed=False, note=why)
    over = Update(goals=goals, agenda=agenda, last_target=goal.target or state.last_target)
    return merged(over, fresh())


def describe(goal: Goal) -> str:
    """What a sub-goal is, in words."""
    what = (goal.target_category or "object").replace("_", " ")
    if goal.placement is None:
        return f"taking the {what}"
    if goal.placement.kind == "back":
        return f"putting the {what} back"
    return f"moving the {what} out of the way" if goal.placement.kind == "aside" else f"placing the {what}"


def put_back(held: Held) -> Goal:
    """The sub-goal that frees the hand."""
    return Goal(
        kind="place",
        reference=Reference(words=f"the {held.category.replace('_', ' ')}", ids=(held.object.id,)),
        placement=Placement(kind="back"),
        target=held.object.id,
        target_category=held.category,
        target_position=held.object.position,
        taken_in=held.motion,
    )


def removal(state: State, object_id: str) -> Goal | None:
    """The sub-goal that moves an object out of the way, or None if too many were moved already (ledger G52)."""
    if state.extra_actions >= MAX_EXTRA_ACTIONS or state.percept is None:
        return None
    obj = state.percept.object(object_id)
    return Goal(
        kind="place",
        reference=Reference(words=f"the {obj.category.replace('_', ' ')}", ids=(object_id,)),
        placement=Placement(kind="aside"),
        target=object_id,
        target_category=obj.category,
        target_position=obj.position,
    )


def parts_of(goals: tuple[Goal, ...], index: int) -> tuple[Goal, ...]:
    """The goals that are parts of a clear or sort, without what only freed the hand for it."""
    return tuple(
        g for g in goals if g.parent == index and g.placement is not None and g.placement.kind in ("bin", "lane")
    )


def next_to_handle(state: State, percept: Percept, graph: SceneGraph | None) -> Goal | None:
    """The next object of a clear or sort goal, or None when all were handled.

    Things that carry others come after what they carry; otherwise the near before the far, so that the arm never
    reaches over what is still there (ledger A3.8).
    """
    goal = state.goal
    handled = {g.target for g in parts_of(state.goals, state.agenda[-1])}
    left = [obj for obj in percept.objects if obj.id not in handled and on_table(obj, percept)]
    if goal.reference is not None and goal.reference.ids:
        left = [obj for obj in left if obj.id in goal.reference.ids]
    if not left:
        return None
    if goal.kind == "sort":
        return _next_to_sort(goal, left)
    carries = {e.source for e in graph.edges if e.relation == "SUPPORTS"} if graph else set[str]()
    chosen = min(left, key=lambda obj: (obj.id in carries, round(obj.position[0], 2), obj.position[1]))
    return _child(chosen, Placement(kind="bin"))


def _next_to_sort(goal: Goal, left: list[PerceivedObject]) -> Goal:
    """The next object in the order that was fixed when the sort began (`goal.reference.ids`), y ascending."""
    order = goal.reference.ids if goal.reference else ()
    chosen = min(left, key=lambda obj: order.index(obj.id))
    return _child(chosen, Placement(kind="lane", lane=(len(order) - 1 - order.index(chosen.id), len(order))))


def _child(obj: PerceivedObject, placement: Placement) -> Goal:
    return Goal(
        kind="place",
        reference=Reference(words=f"the {obj.category.replace('_', ' ')}", ids=(obj.id,)),
        placement=placement,
        target=obj.id,
        target_category=obj.category,
        target_position=obj.position,
    )


def on_table(obj: PerceivedObject, percept: Percept) -> bool:
    """Whether the object stands on the table rather than in the bin."""
    if percept.bin is None:
        return True
    low, high = percept.bin
    return not all(low[i] - 0.03 <= obj.position[i] <= high[i] + 0.03 for i in range(2))
