"""Answers from what is recorded: what was done, why a grasp was chosen, why it failed, what is seen. Nothing is invented."""

from __future__ import annotations

from collections.abc import Callable

from agent import phrases
from agent.attempt import Attempt
from agent.brain import Situation, Spoken
from agent.goal import Goal, Query
from agent.kept_force import raised, raised_words
from agent.language.describe import describe, listing, spoken
from agent.language.resolve import Scope, resolve
from agent.language.single_out import leftness
from agent.told_of_bin import binned, contents, means_bin
from kb.grasp import GraspField, Provenance
from kb.percept import PerceivedObject
from prompts import load_prompt

FIELD_WORDS: dict[GraspField, str] = {
    "position": "place", "approach": "direction of approach", "yaw": "turn of the hand", "aperture": "opening",
    "force": "force", "type": "grasp type", "standoff": "stand-off", "speed": "speed",
}  # fmt: skip
SOURCE_WORDS = {
    "experience": "experience", "memory": "an earlier success here", "constraint": "the constraint",
    "geometry": "the measured shape", "correction": "the correction", "default": "the default",
}  # fmt: skip


def answer(situation: Situation) -> Spoken:
    """The last word of a run."""
    goal = situation.goals[0] if situation.goals else None
    if goal is None:
        return Spoken(text="There was nothing to do.")
    if goal.query is not None:
        return Spoken(text=_ANSWERS[goal.query](situation, goal))
    return Spoken(text=report(situation))


def report(situation: Situation) -> str:
    """What became of the goals of this turn."""
    asked = [goal for goal in situation.goals if goal.parent is None]
    parts = [_outcome(situation, goal) for goal in asked]
    notes = [goal.note for goal in asked if goal.status == "done" and goal.note and goal.note not in " ".join(parts)]
    held = [a for a in situation.attempts if a.turn == situation.turn and a.claimed]
    notes += [said for said in map(raised, held) if said]
    if situation.dry_run:
        return " ".join([*parts, "This was a dry run: nothing was moved."])
    return " ".join([*parts, *notes])


def _outcome(situation: Situation, goal: Goal) -> str:
    index = situation.goals.index(goal)
    tries = [a for a in situation.attempts if a.turn == situation.turn and a.goal == index]
    name = phrases.object_name(goal.target_category)
    if goal.status == "open":
        return phrases.sentence(f"I did not get to it: {phrases.goal_words(goal)}")
    if goal.status == "failed":
        if goal.note.endswith((".", "?")) and not tries:
            return goal.note
        what = name if goal.target else phrases.goal_words(goal)
        why = goal.note.rstrip(".") or "it did not work"
        verb = f"I could not {phrases.goal_words(goal)}" if goal.reference else f"I failed with the {what}"
        return phrases.sentence(f"{verb}: {why}")
    if situation.dry_run:
        plan = situation.plan
        return f"I would {phrases.goal_words(goal)}." + (f" {phrases.planned(plan, '')}" if plan else "")
    many = f" at attempt {len(tries)}" if len(tries) > 1 else ""
    if goal.kind == "pick":
        if goal.placement is not None:
            return f"Here is the {name}{many}; I hold it out to you."
        if situation.held is None or situation.held.object.id != goal.target:
            return f"I picked up the {name}{many} and put it down again."
        return f"I hold the {name}{many}."
    if goal.kind == "place":
        return f"I put the {name} {phrases.place_words(goal)}{many}."
    if goal.kind == "clear":
        return phrases.sentence(f"cleared: {goal.note}")
    if goal.kind == "sort":
        return phrases.sentence(f"sorted by {goal.measure}: {goal.note}")
    return phrases.sentence(goal.note or "done")


def _see(situation: Situation, goal: Goal) -> str:
    del goal
    assert situation.percept is not None
    objects = situation.percept.objects
    if not objects:
        return "I see nothing on the table."
    lines = [_properties_of(obj, situation) for obj in sorted(objects, key=leftness, reverse=True)]
    return f"I see {listing(objects)}. " + " ".join(lines)


def _properties_of(obj: PerceivedObject, situation: Situation) -> str:
    assert situation.percept is not None
    size = " x ".join(f"{side * 100:.0f}" for side in obj.size)
    sure = "" if obj.confidence >= 0.8 else f", I am {obj.confidence:.0%} sure"
    state = "" if obj.state == "empty" else f", {obj.state}"
    return (
        f"{phrases.sentence(describe(obj, situation.percept.objects))[:-1]} ({obj.id}) is {obj.affordance.material}, "
        f"{size} cm, fragility {obj.affordance.fragility:.1f}{state}{sure}."
    )


def _where(situation: Situation, goal: Goal) -> str:
    assert situation.percept is not None
    ids = goal.reference.ids if goal.reference else ()
    if not ids:
        return binned(goal.reference, situation.in_bin) or goal.note or "I do not see that."
    held = situation.held
    if held is not None and held.object.id in ids:
        return f"The {phrases.plain(held.category)} is in my hand."
    things = [obj for obj in situation.percept.objects if obj.id in ids]
    lines: list[str] = []
    for obj in things:
        near = _beside(situation, obj)
        lines.append(phrases.sentence(phrases.whereabouts(obj, situation.percept) + (f", {near}" if near else "")))
    note = f"{goal.note} " if goal.note else ""
    return note + " ".join(lines)


def _beside(situation: Situation, obj: PerceivedObject) -> str:
    """The nearest neighbour by the scene graph."""
    graph, percept = situation.graph, situation.percept
    if graph is None or percept is None:
        return ""
    by_id = {o.id: o for o in percept.objects}
    words = {
        "ON_TOP_OF": "on",
        "INSIDE": "in",
        "LEANING_ON": "leaning on",
        "TOUCHING": "touching",
        "ADJACENT_TO": "next to",
    }
    for relation, word in words.items():
        edges = [e for e in graph.edges if e.source == obj.id and e.relation == relation and e.target in by_id]
        if edges:
            nearest = min(edges, key=lambda e: e.gap if e.gap is not None else 0.0)
            return f"{word} {describe(by_id[nearest.target], percept.objects)}"
    return ""


def _near(situation: Situation, goal: Goal) -> str:
    assert situation.percept is not None
    if means_bin(goal.reference):
        return contents(situation.in_bin, situation.percept)
    relation = goal.reference.relation if goal.reference else None
    name = spoken(relation.others[0]) if relation and relation.others else "it"
    word = phrases.plain(relation.relation) if relation else "near"
    ids = goal.reference.ids if goal.reference else ()
    things = tuple(obj for obj in situation.percept.objects if obj.id in ids)
    if not things:
        anchor = resolve(relation.others[0], Scope(percept=situation.percept)) if relation and relation.others else None
        if anchor is not None and not anchor.ids:
            return anchor.problem or f"I do not see {name}."
        return f"There is nothing {word} {name}."
    return f"{phrases.sentence(word + ' ' + name)[:-1]} I see {listing(things)}."


def _count(situation: Situation, goal: Goal) -> str:
    ids = goal.reference.ids if goal.reference else ()
    name = goal.reference.words if goal.reference else "objects"
    return f"I count {len(ids)}: {name}." if ids else f"I see none: {goal.note}"


def _properties(situation: Situation, goal: Goal) -> str:
    assert situation.percept is not None
    ids = goal.reference.ids if goal.reference else ()
    things = [obj for obj in situation.percept.objects if obj.id in ids]
    if not things:
        if means_bin(goal.reference):
            return contents(situation.in_bin, situation.percept)
        return binned(goal.reference, situation.in_bin) or goal.note or "I do not see that."
    lines: list[str] = []
    for obj in things:
        low, high = obj.mass
        weight = f"{low * 1000:.0f} to {high * 1000:.0f} g" if high > low else f"{low * 1000:.0f} g"
        lines.append(f"{_properties_of(obj, situation)} I guess that it weighs {weight}; it looks {obj.colour_name}.")
    return " ".join(lines)


def _held(situation: Situation, goal: Goal) -> str:
    del goal
    if situation.held is None:
        return "My hand is empty."
    load = f"; it weighs about {situation.held.load * 1000:.0f} g" if situation.held.load > 0 else ""
    return f"I hold the {phrases.object_name(situation.held.category)}{load}."


def _why(situation: Situation, goal: Goal) -> str:
    """Every number of the last grasp with its recorded source."""
    del goal
    if not situation.attempts:
        return "I have not grasped anything yet in this conversation."
    last = situation.attempts[-1]
    plan, target = last.plan, phrases.plain(last.target.category)
    lines = [last.thought] if last.thought else []
    lines.append(f"The numbers of the grasp of the {target} and where they come from:")
    for field, sources in plan.provenance.items():
        told = [*map(_source, sources), *(raised_words(last) if field == "force" else ())]
        lines.append(f"- {FIELD_WORDS[field]} {_value(getattr(plan.grasp, field))}: {'; '.join(told)}")
    if last.constraints.active:
        lines.append("Constraints: " + " ".join(phrases.sentence(c.reason) for c in last.constraints.active))
    if plan.rejected:
        most = sorted(plan.rejected.items(), key=lambda item: -item[1])[:3]
        lines.append("Rejected: " + ", ".join(f"{count} for {reason}" for reason, count in most) + ".")
    return "\n".join(lines)


def _source(item: Provenance) -> str:
    words = SOURCE_WORDS[item.source]
    return f"{words} {item.id} ({_value(item.value)})" if item.id else f"{words} ({_value(item.value)})"


def _value(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.3g}"
    if isinstance(value, tuple | list):
        return "(" + ", ".join(_value(v) for v in value) + ")"
    if isinstance(value, dict):
        return ", ".join(f"{k} {_value(v)}" for k, v in value.items())
    return str(value)


def _why_failed(situation: Situation, goal: Goal) -> str:
    """The recorded diagnoses, each with its readings and the correction that followed."""
    del goal
    failed = [a for a in situation.attempts if not a.claimed]
    if not situation.attempts:
        return "Nothing has been tried yet in this conversation."
    if not failed:
        return "As far as I can tell nothing failed: " + phrases.observed(situation.attempts[-1])
    last_turn = failed[-1].turn
    lines = [_failure(a) for a in failed if a.turn == last_turn]
    last = situation.attempts[-1]
    if last.claimed and last.turn == last_turn:
        lines.append(f"The next attempt worked: {last.plan.grasp.type} grasp of the {last.plan.region}.")
    return " ".join(lines)


def _failure(attempt: Attempt) -> str:
    reasons = "; ".join(attempt.reasons) or "no reading tells why"
    if attempt.stopped:
        return f"The attempt with {attempt.plan.grasp.force:.1f} N did not fail: you stopped it."
    text = f"Attempt at level {attempt.level} with {attempt.plan.grasp.force:.1f} N ended in "
    return text + f"{phrases.plain(attempt.failure or 'UNKNOWN').lower()} ({attempt.confidence:.0%} sure): {reasons}."


def _what_if(situation: Situation, goal: Goal) -> str:
    return goal.note or "I could not simulate that."


def _help(situation: Situation, goal: Goal) -> str:
    del situation, goal
    return load_prompt("help")


def _stop(situation: Situation, goal: Goal) -> str:
    del goal
    held = f" I still hold the {phrases.plain(situation.held.category)}." if situation.held else ""
    return f"Stopped: nothing moves, and nothing is left to do.{held}"


_ANSWERS: dict[Query, Callable[[Situation, Goal], str]] = {
    "see": _see, "where": _where, "near": _near, "why": _why, "why_failed": _why_failed, "what_if": _what_if, "help": _help,
    "stop": _stop, "held": _held, "properties": _properties, "count": _count,
}  # fmt: skip
"""Query -> how it is answered."""
