"""The agenda: which goal is in work, sub-goals pushed before it, and what comes next when one is over.

Pure functions from state to update; they move nothing.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

from agent.attempt import Held
from agent.goal import Goal, Placement, Reference
from agent.ladder import MAX_EXTRA_ACTIONS
from agent.lanes import has_room, in_the_way
from agent.state import State, Update, merged
from kb.percept import PerceivedObject, Percept
from kb.scene_graph import SceneGraph

NO_PLACE = "I found no free place within reach."
"""Note of a goal that failed because what was taken could not be put anywhere."""

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
        placement=Placement(kind="back", point=held.object.position[:2]),
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
    """The goals that are parts of a clear or sort, without what only freed the hand for it.

    Of a part that was taken up again the last one counts.
    """
    parts = {
        g.target: g
        for g in goals
        if g.parent == index and g.placement is not None and g.placement.kind in ("bin", "lane")
    }
    return tuple(parts.values())


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
    if goal.kind == "sort":
        return _next_to_sort(state, left or _once_more(state, percept), percept)
    if not left:
        return None
    carries = {e.source for e in graph.edges if e.relation == "SUPPORTS"} if graph else set[str]()
    chosen = min(left, key=lambda obj: (obj.id in carries, round(obj.position[0], 2), obj.position[1]))
    return _child(chosen, Placement(kind="bin"))


def _next_to_sort(state: State, left: list[PerceivedObject], percept: Percept) -> Goal | None:
    """The next object in the order that was fixed when the sort began (`goal.reference.ids`), y ascending.

    Those whose lanes have room come first, then those whose lanes are empty: with them their own places become free.
    """
    if not left:
        return None
    order = state.goal.reference.ids if state.goal.reference else ()

    def lane(obj: PerceivedObject) -> tuple[int, int]:
        return len(order) - 1 - order.index(obj.id), len(order)

    def wanted(obj: PerceivedObject) -> tuple[bool, int, int]:
        others = [other for other in percept.objects if other.id != obj.id and on_table(other, percept)]
        waiting = [other for other in left if other.id != obj.id]
        return not has_room(lane(obj), obj, waiting), in_the_way(lane(obj), others), order.index(obj.id)

    chosen = min(left, key=wanted)
    return _child(chosen, Placement(kind="lane", lane=lane(chosen)))


def _once_more(state: State, percept: Percept) -> list[PerceivedObject]:
    """Objects for whose placing there was no room when their turn came, each taken up once more at the end."""
    index = state.agenda[-1]
    times = Counter(g.target for g in state.goals if g.parent == index and g.placement and g.placement.kind == "lane")
    again = {g.target for g in parts_of(state.goals, index) if g.note == NO_PLACE and times[g.target] == 1}
    return [obj for obj in percept.objects if obj.id in again and on_table(obj, percept)]


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
