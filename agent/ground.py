"""Stage 2: from references to perceived objects, for the goal in work and, before anything moves, for all of them."""

from __future__ import annotations

import math

from agent import events
from agent.agenda import changed, finish, fresh, push, put_back
from agent.ask_which import ask, choices, one_of, several
from agent.attempt import Held
from agent.goal import Goal, Placement, Reference
from agent.grounded import Grounded, say
from agent.ladder import MAX_RELOOKS
from agent.language.describe import describe, listing, spoken
from agent.language.resolve import Resolution, Scope, resolve
from agent.possible import EMPTY_HAND, impossible, lets_go_of_nothing, single
from agent.state import State, Update, merged
from agent.told_of_bin import binned, not_back
from kb.percept import PerceivedObject, Percept

BACK_ALREADY = 0.02
"""A thing this near to where it stood before it was moved has been put back [m]."""
SAME_PLACE = 0.15
"""An object of the same category within this distance of where the target was is taken to be the target [m]."""


def ground_goals(state: State) -> Grounded:
    """Grounds the goal in work; on the turn's first look every goal's reference is checked first."""
    percept, goal = state.percept, state.goal
    assert percept is not None
    if not any(g.status != "open" or g.target for g in state.goals):
        refused = _refusal(state, percept)
        if refused is not None:
            return refused
    if goal.target is not None and goal.kind in ("pick", "place"):
        return _again(state, percept)
    if goal.kind in ("pick", "place"):
        return _thing(state, percept)
    if goal.kind in ("clear", "sort"):
        return _many(state, percept)
    return _asked(state)


def scope_of(state: State) -> Scope:
    """What references are resolved in; for "undo" and "put it back", "it" is what was moved last, whatever was asked since."""
    assert state.percept is not None
    last, goal = state.last_target, state.goal if state.agenda else None
    if state.held is None and state.moved is not None and goal is not None:
        last = state.moved.id if goal.placement is not None and goal.placement.kind == "back" else last
    return Scope(percept=state.percept, held=state.held.object if state.held else None, last=last)


def _refusal(state: State, percept: Percept) -> Grounded | None:
    """The first goal whose thing (or place) is absent or ambiguous: then nothing moves at all."""
    scope = scope_of(state)
    meant: PerceivedObject | None = None
    hidden = tuple(obj for obj in state.in_bin if all(seen.id != obj.id for seen in percept.objects))
    for index, goal in enumerate(state.goals):
        if goal.kind == "clear" and percept.bin is None:
            return say(state, "There is no bin here to clear anything into.")
        for reference in (goal.reference, goal.placement.reference if goal.placement else None):
            if reference is None or not goal.moves or _later(reference, index):
                continue
            if reference.pronoun and lets_go_of_nothing(scope.held, goal, None, earlier=index > 0):
                return say(state, EMPTY_HAND)
            inside = not_back(goal, state.moved.id if state.moved else None, hidden) if scope.held is None else None
            if inside is not None and index == 0:
                return say(state, inside)
            got = resolve(reference, scope) if not _only_place(reference) else Resolution(ids=("",))
            if not got.ids:
                return say(state, binned(reference, hidden) or got.problem or "I see nothing like that.")
            if reference is goal.reference and _too_few(reference, got):
                return say(state, f"I see only one: {choices(got, percept)[0]}.")
            if goal.kind in ("pick", "place") and len(got.ids) > 1:
                if reference is goal.reference and (reference.plural or reference.pronoun):
                    if goal.placement is not None and goal.placement.kind == "bin":
                        return several(state, index, got, percept)
                    return one_of(state, index, got, percept)
                return ask(state, index, reference, got, percept)
        if goal.kind in ("pick", "place") and goal.reference is not None:
            if not _later(goal.reference, index):
                meant = single(goal.reference, scope)
            problem = impossible(goal, meant, scope, earlier=index > 0)
            if problem is not None:
                return say(state, problem)
    return None


def _too_few(reference: Reference, got: Resolution) -> bool:
    """Two cups were asked for, and there is one: taking it would not be what was asked."""
    singled = reference.anyone or reference.extreme is not None or reference.side is not None
    return reference.plural and not singled and reference.ordinal is None and len(got.ids) == 1 < (reference.count or 1)


def _later(reference: Reference, index: int) -> bool:
    """A pronoun in a later clause means what the clause before dealt with."""
    return index > 0 and (reference.pronoun or reference.other)


def _only_place(reference: Reference) -> bool:
    """As a destination "between A and B" has no thing of its own."""
    return reference.noun is None and reference.relation is not None


def _thing(state: State, percept: Percept) -> Grounded:
    """The object of a pick or place goal."""
    goal, scope, held = state.goal, scope_of(state), state.held
    assert goal.reference is not None
    got = resolve(goal.reference, scope)
    if not got.clear:
        if not got.ids:
            return _over(state, got.problem or "I do not see it.")
        return ask(state, state.agenda[-1], goal.reference, got, percept)
    obj = next(o for o in scope.objects if o.id == got.ids[0])
    if held is not None and obj.id != held.object.id:
        return _free_hand(state, held)
    placement, problem = destination(goal.placement, scope)
    if held is None and placement is not None and placement.kind == "back":
        if state.moved is None or state.moved.id != obj.id:
            return _over(state, "I have moved nothing that I could put back.")
        if math.dist(obj.position[:2], state.moved.origin[:2]) < BACK_ALREADY:
            return _over(state, f"{describe(obj, percept.objects).capitalize()} stands where it stood before already.")
        placement = placement.model_copy(update={"point": state.moved.origin[:2]})
    if placement is not None and placement.kind == "bin" and percept.bin is None:
        problem = None if placement.or_aside else "There is no bin here."
        placement = placement.model_copy(update={"kind": "aside"}) if placement.or_aside else placement
    if problem is not None:
        return _over(state, problem)
    said = goal.reference.categories
    grounded = goal.model_copy(
        update={
            "target": obj.id,
            "target_category": obj.category if obj.category in said or len(said) != 1 else said[0],
            "target_position": obj.position,
            "taken_in": held.motion if held is not None else None,
            "placement": placement,
            "note": got.note,
        }
    )
    said_as, seen = spoken(goal.reference), f"{describe(obj, percept.objects)} ({obj.id})"
    text = f"There is one: {seen}." if goal.reference.plural else f"{said_as.capitalize()} is {seen}."
    text += f" {got.note}" if got.note else ""
    step = events.Grounding(text=text, goal=state.current, target=obj.id)
    return Grounded(Update(goals=changed(state, grounded), last_target=obj.id), (step,))


def _free_hand(state: State, held: Held) -> Grounded:
    """Puts what is held back first; if that failed once, it is not tried for ever."""
    name = held.category.replace("_", " ")
    if any(g.status == "failed" and g.placement is not None and g.placement.kind == "back" for g in state.goals):
        return _over(state, f"My hand is not free: I could not put the {name} back.")
    back = put_back(held)
    text = f"My hand is not free: first I put the {name} back."
    return Grounded(push(state, back), (events.SubGoal(text=text, goal=state.current, pushed=back),))


def destination(placement: Placement | None, scope: Scope) -> tuple[Placement | None, str | None]:
    """The placement with its reference grounded, or what is wrong with it."""
    if placement is None or placement.reference is None:
        return placement, None
    reference = placement.reference
    if _only_place(reference) and reference.relation is not None:
        reference = reference.relation.others[0]
    got = resolve(reference, scope)
    if not got.ids:
        return None, got.problem
    return placement.model_copy(update={"target": got.ids[0]}), None


def _over(state: State, text: str) -> Grounded:
    """The goal in work cannot be done; if nothing has moved yet this is the answer, too."""
    update = finish(state, claimed=False, note=text)
    if not state.executed:
        update = merged(update, Update(refused=True, answer=text, agenda=()))
    return Grounded(update, (events.Grounding(text=text, goal=state.current),))


def _again(state: State, percept: Percept) -> Grounded:
    """The target after another look: the same id, or the thing of its kind near where it was."""
    goal, held = state.goal, state.held
    if held is not None and held.object.id == goal.target:
        return Grounded(Update())
    if held is not None:
        return _free_hand(state, held)
    if any(obj.id == goal.target for obj in percept.objects):
        return Grounded(Update())
    found = _nearest_like(goal, percept)
    if found is not None:
        renamed = goal.model_copy(update={"target": found.id})
        text = f"The object now called {found.id} is the one I mean."
        step = events.Grounding(text=text, goal=state.current, target=found.id)
        return Grounded(Update(goals=changed(state, renamed), last_target=found.id), (step,))
    if state.relooks < MAX_RELOOKS:
        step = events.Grounding(text="I do not see it any more. I look again.", goal=state.current)
        return Grounded(Update(relooks=state.relooks + 1, stale=True), (step,))
    text = f"It is no longer on the table. I see {listing(percept.objects)}."
    return Grounded(finish(state, claimed=False, note=text), (events.Grounding(text=text, goal=state.current),))


def _nearest_like(goal: Goal, percept: Percept) -> PerceivedObject | None:
    if goal.target_position is None:
        return None
    x, y = goal.target_position[0], goal.target_position[1]
    like = [
        obj
        for obj in percept.objects
        if obj.id != goal.target
        and (obj.category == goal.target_category or goal.target_category in obj.posterior)
        and (obj.category == goal.target_category or obj.posterior[goal.target_category or ""] > 0.1)
        and ((obj.position[0] - x) ** 2 + (obj.position[1] - y) ** 2) ** 0.5 < SAME_PLACE
    ]
    return min(like, key=lambda o: (o.position[0] - x) ** 2 + (o.position[1] - y) ** 2, default=None)


def _many(state: State, percept: Percept) -> Grounded:
    """Clear and sort: fixes once which objects are meant and, for a sort, their order."""
    goal = state.goal
    if state.held is not None:
        return _free_hand(state, state.held)
    if goal.reference is not None and goal.reference.ids:
        return Grounded(Update())
    reference = goal.reference or Reference(words="everything", noun="everything", plural=True)
    got = resolve(reference, scope_of(state))
    if not got.ids:
        return _over(state, got.problem or "There is nothing to do.")
    ids = got.ids
    if goal.kind == "sort":
        key = {"fragility": _fragility, "size": _size, "weight": _weight}[goal.measure or "fragility"]
        order = sorted((percept.object(i) for i in ids), key=lambda o: (key(o), o.id), reverse=goal.descending)
        ids = tuple(obj.id for obj in order)
    fixed = goal.model_copy(update={"reference": reference.model_copy(update={"ids": ids, "plural": True})})
    names = ", ".join(percept.object(i).category.replace("_", " ") for i in ids)
    text = f"In this order, from your left to your right: {names}." if goal.kind == "sort" else f"That is: {names}."
    return Grounded(
        merged(Update(goals=changed(state, fixed)), fresh()), (events.Grounding(text=text, goal=state.current),)
    )


def _fragility(obj: PerceivedObject) -> float:
    return obj.affordance.fragility


def _size(obj: PerceivedObject) -> float:
    return obj.size[0] * obj.size[1] * obj.size[2]


def _weight(obj: PerceivedObject) -> float:
    return sum(obj.mass) / 2


def _asked(state: State) -> Grounded:
    """What a question is about; that it is absent is an answer, not a refusal, except to where it is."""
    goal = state.goal
    if goal.reference is None:
        return Grounded(Update())
    got = resolve(goal.reference, scope_of(state))
    target = got.ids[0] if got.ids else None
    grounded = goal.model_copy(
        update={
            "target": target,
            "reference": goal.reference.model_copy(update={"ids": got.ids}) if got.ids else goal.reference,
            "note": got.problem or got.note,
        }
    )
    return Grounded(Update(goals=changed(state, grounded), last_target=target or state.last_target))
