"""Sentences about facts in the state: what was seen, retrieved, inferred, planned, done and sensed. No reasoning here."""

from __future__ import annotations

import math

from agent.agenda import parts_of
from agent.approval import Decision
from agent.attempt import Attempt
from agent.goal import Goal, Understanding
from agent.language.describe import describe, listing, spoken
from agent.language.single_out import leftness
from agent.state import State
from kb.constraint import Constraints
from kb.experience import Retrieval
from kb.percept import PerceivedObject, Percept
from kb.run_result import ModelUse
from kb.scene_graph import SceneGraph
from kb.sensing import Plan
from kb.vocabulary import INVERSE, UNKNOWN_CATEGORY

PLACES = {
    "bin": "in the bin", "back": "back where it was", "aside": "out of the way", "hand_over": "to you", "lane": "in its lane",
}  # fmt: skip

QUESTIONS = {
    "see": "say what I see", "where": "find {thing}", "near": "say what is near", "why": "explain the last grasp",
    "why_failed": "explain the failure", "what_if": "simulate the last grasp with another force", "help": "explain what I can do",
    "stop": "stop", "held": "say what I hold", "properties": "describe {thing}", "count": "count {thing}",
}  # fmt: skip
"""What a question asks for, in words."""


def sentence(text: str) -> str:
    """The text with a capital letter and a full stop."""
    text = text.strip()
    if not text:
        return ""
    return text[0].upper() + text[1:] + ("" if text[-1] in ".?!" else ".")


def a(name: str) -> str:
    """The name with its indefinite article."""
    return ("an " if name[0] in "aeiou" else "a ") + plain(name)


def plain(name: str) -> str:
    """A category or constant in words."""
    return name.replace("_", " ")


def object_name(category: str | None) -> str:
    """What stands after "the": a category in words, or that it is of no known kind."""
    return "unknown object" if category == UNKNOWN_CATEGORY else plain(category or "object")


def goal_words(goal: Goal) -> str:
    """A goal as a person would say it."""
    thing = spoken(goal.reference) if goal.reference else "it"
    if goal.kind == "pick":
        if goal.placement:
            return f"hand {thing} over" if thing in ("it", "them") else f"hand over {thing}"
        return f"pick {thing} up" if thing in ("it", "them") else f"pick up {thing}"
    if goal.kind == "place":
        return f"put {thing} {place_words(goal)}"
    if goal.kind == "clear":
        return "clear the table"
    if goal.kind == "sort":
        return f"sort by {goal.measure}" + (", descending" if goal.descending else "")
    return {"see": "say what I see", "where": f"find {thing}", "near": "say what is near"}.get(
        goal.query or "", "answer"
    )


def place_words(goal: Goal) -> str:
    """Where a thing goes, in words."""
    placement = goal.placement
    if placement is None:
        return "down"
    if placement.kind == "aside" and placement.point is not None:
        return "where you chose"
    if placement.kind == "side":
        return {"middle": "in the middle", "front": "at the front", "back": "at the back"}.get(
            placement.side or "", f"on the {placement.side}"
        )
    if placement.kind in ("beside", "on") and placement.reference is not None:
        relation = "on" if placement.kind == "on" else plain(placement.relation or "near").replace("near", "next to")
        if placement.relation == "between":
            return placement.reference.words
        return f"{relation} {spoken(placement.reference)}"
    return PLACES.get(placement.kind, "down")


def understood(got: Understanding) -> str:
    """The goals, or that there are none."""
    if got.refusal or got.question:
        return sentence(got.refusal or got.question or "")
    return sentence(", then ".join(goal_words(goal) for goal in got.goals))


def nouns(goals: tuple[Goal, ...]) -> tuple[str, ...]:
    """Categories that the instruction speaks of."""
    said = [c for goal in goals if goal.reference for c in goal.reference.categories]
    return tuple(dict.fromkeys(said))


def seen(percept: Percept) -> str:
    """What a look shows."""
    how = " (oracle: read from the truth)" if percept.perception == "oracle" else ""
    return f"I see {listing(percept.objects)}{how}."


def named(count: int, dropped: tuple[str, ...]) -> str:
    """What became of a model's names and relations."""
    if not dropped:
        return f"The model named {count} object{'s' if count != 1 else ''}."
    return f"The model named {count} object{'s' if count != 1 else ''}; dropped: {'; '.join(dropped)}."


def fallbacks(use: ModelUse) -> str:
    """That the rules decided in a model's place; empty where they did not."""
    if not use.fallbacks:
        return ""
    times = "once" if len(use.fallbacks) == 1 else f"{len(use.fallbacks)} times"
    return f" (The rules decided {times} in the model's place, first for {use.fallbacks[0]}.)"


def target_of(state: State) -> PerceivedObject:
    """The target as perceived now."""
    assert state.percept is not None
    assert state.goal.target is not None
    return state.percept.object(state.goal.target)


def retrieved(got: Retrieval) -> str:
    """The experiences and the funnel."""
    best = got.best()
    funnel = f"{got.funnel.total} > {got.funnel.level1} > {got.funnel.level2} > {got.funnel.level3}"
    if best is None:
        return f"No success among {len(got.top)} experiences (funnel {funnel})."
    e = best.experience
    return (
        f"Best of {len(got.top)} experiences is {e.id}, {a(e.category)}: score {best.score:.2f}, "
        f"{e.n_success} of {e.n_trials} trials succeeded (funnel {funnel})."
    )


def graphed(graph: SceneGraph, state: State) -> str:
    """The relations of the target, each pair once."""
    target = state.goal.target if state.agenda else None
    names = {node.id: plain(node.category) for node in graph.nodes}
    told: set[frozenset[str]] = set()
    parts: list[str] = []
    for edge in graph.edges:
        pair = frozenset(
            (edge.source, edge.target, *sorted((edge.relation, INVERSE.get(edge.relation, edge.relation))))
        )
        if (
            target not in (None, edge.source)
            or pair in told
            or edge.relation in ("LEFT_OF", "RIGHT_OF", "ABOVE", "BELOW")
        ):
            continue
        told.add(pair)
        gap = f" ({edge.gap * 100:.0f} cm)" if edge.gap is not None else ""
        parts.append(f"{names[edge.source]} {edge.relation} {names[edge.target]}{gap}")
    return (
        f"{len(graph.nodes)} objects, {len(graph.edges)} relations"
        + (": " + "; ".join(parts[:6]) if parts else "")
        + "."
    )


def constrained(constraints: Constraints) -> str:
    """The active constraints with their reasons."""
    if not constraints.active:
        return "No constraint is active."
    return " ".join(sentence(f"{c.kind}: {c.reason}") for c in constraints.active)


def removal(sub: Goal, state: State) -> str:
    """That something must go first."""
    return (
        f"The {plain(sub.target_category or 'object')} stands on the {_target_name(state)}, so I move it aside first."
    )


def _target_name(state: State) -> str:
    return plain(state.goal.target_category or "object")


def next_object(sub: Goal) -> str:
    """Which object of a clear or sort comes next."""
    return f"Next is the {plain(sub.target_category or 'object')}: {place_words(sub)}."


def children(state: State) -> tuple[bool, str]:
    """Whether all objects of a clear or sort were handled, and a note."""
    parts = parts_of(state.goals, state.agenda[-1])
    failed = [plain(goal.target_category or "object") for goal in parts if goal.status == "failed"]
    if failed:
        return False, f"{len(parts) - len(failed)} of {len(parts)} done; not the {', '.join(failed)}"
    return bool(parts), f"{len(parts)} of {len(parts)} done"


def planned(plan: Plan | None, reason: str) -> str:
    """The grasp, or why there is none."""
    if plan is None:
        return sentence(f"no grasp found: {reason}")
    grasp = plan.grasp
    return (
        f"{grasp.type.capitalize()} grasp of the {plan.region}, {tilt_words(plan)}, opening {grasp.aperture * 1000:.0f} mm, "
        f"{grasp.force:.1f} N, quality {plan.quality.q:.2f}."
    )


def tilt_words(plan: Plan) -> str:
    """From where the hand arrives."""
    tilt = math.degrees(math.acos(max(-1.0, min(1.0, -plan.grasp.approach[2]))))
    if tilt < 20:
        return "from above"
    return f"tilted {tilt:.0f} degrees" if tilt <= 65 else "from the side"


def action(plan: Plan, level: int) -> str:
    """The motion that begins."""
    rung = f", correction level {level}" if level else ""
    return (
        f"execute_grasp on {plan.target}: {plan.grasp.type} grasp of the {plan.region}, {plan.grasp.force:.1f} N{rung}."
    )


def decided(decision: Decision, *, motion: str = "grasp") -> str:
    """A person's word."""
    return {
        "approve": "You approved the motion.",
        "reject": "You did not approve the motion.",
        "edit": f"You changed the {motion}.",
        "steer": f"You want it otherwise: {decision.words}.",
    }[decision.verdict]


def observed(attempt: Attempt) -> str:
    """What was sensed and what it means."""
    reasons = "; ".join(attempt.reasons)
    if attempt.claimed:
        return sentence(f"I hold it: {reasons}")
    if attempt.stopped:
        return sentence(reasons)
    return sentence(f"{plain(attempt.failure or 'UNKNOWN').lower()}: {reasons}")


def ended(attempt: Attempt) -> str:
    """How an attempt ended, as what stands after "it": held, was stopped, or failed by a type of failure."""
    if attempt.claimed:
        return "held"
    return "was stopped" if attempt.stopped else f"failed by {plain(attempt.failure or 'UNKNOWN').lower()}"


def exhausted(tries: tuple[Attempt, ...]) -> str:
    """That the budget is used up."""
    kinds = ", ".join(plain(a.failure or "UNKNOWN").lower() for a in tries)
    return f"{len(tries)} attempt{'s' if len(tries) != 1 else ''} failed ({kinds})"


def give_up(why: str, last: Attempt) -> str:
    """The honest end."""
    return sentence(f"I give up on the {object_name(last.target.category)}: {why}")


def no_plan(reason: str) -> str:
    """That no grasp was found."""
    return f"I found no grasp that the hand and the arm can do: {reason.rstrip('.')}"


def remembered(last: Attempt) -> str:
    """What goes into the memory."""
    return f"Remembered for {plain(last.target.category)}: {last.plan.grasp.type} grasp of the {last.plan.region}."


def whereabouts(obj: PerceivedObject, percept: Percept) -> str:
    """Where it stands, as in "45 cm in front of my base, 10 cm to your left"."""
    left = leftness(obj)
    side = (
        "straight ahead" if abs(left) < 0.015 else f"{abs(left) * 100:.0f} cm to your {'left' if left > 0 else 'right'}"
    )
    return f"{describe(obj, percept.objects)} stands {obj.position[0] * 100:.0f} cm in front of my base, {side}"
