"""What a brain's word must satisfy before it counts: pure functions that give the value back, or raise why it is refused.

The physical half, whether hand, object and arm allow a chosen grasp, is the tool `choose_grasp`; it is handed in, so that
this file knows no robot.
"""

from __future__ import annotations

import re
from collections.abc import Callable

from agent.brain import Deliberation, Reflected, Situation, Spoken
from agent.goal import Goal, Reference, Understanding
from agent.ladder import MAX_RELOOKS
from agent.language.read_command import understand as read
from agent.language.refusals import refuse
from agent.language.words import words
from kb.constraint import Constraints
from kb.percept import Percept
from kb.seen import Seen
from kb.sensing import Plan
from tools.choose_grasp import Choice, ChooseArgs

LONGEST_ANSWER = 1200
"""Characters of an answer."""
UNNAMED = frozenset({"thing", "object", "one", "item", "everything", "it", "them", "something", "anything", "stuff"})
"""Nouns that name nothing in particular, so that nobody needs to have said them."""
NUMBER = re.compile(r"\d+(?:\.\d+)?")


class RefusedError(Exception):
    """A brain's word does not count, for this reason. It never leaves `agent.safety`."""

    def __init__(self, reason: str) -> None:
        self.reason = reason
        super().__init__(reason)


def judged_understanding(got: Understanding, situation: Situation) -> Understanding:
    """Goals are of what the person said, and nothing moves on a question, a stop, or what the robot cannot do.

    Raises:
        RefusedError: otherwise.
    """
    if not any(goal.moves for goal in got.goals):
        return got
    own = read(situation.instruction, pending=situation.pending)
    if own.goals and not any(goal.moves for goal in own.goals):
        raise RefusedError("the person asked something or wants you to stop, and nothing is to be moved for that")
    cannot = refuse(" ".join(words(situation.instruction)))
    if cannot is not None:
        raise RefusedError(f"the robot cannot do what was asked: {cannot}")
    if own.goals and not any(_of_many(goal) for goal in own.goals) and any(_of_many(goal) for goal in got.goals):
        raise RefusedError("the person spoke of single things, and nothing else is to be moved")
    said = frozenset(words(situation.instruction))
    if situation.pending is not None and situation.pending.reference is not None:
        said |= frozenset(words(situation.pending.reference.words))
    for goal in got.goals:
        _said_by_person(goal, said)
    return got


def _of_many(goal: Goal) -> bool:
    """Whether a goal moves more than one thing."""
    return goal.kind in ("clear", "sort") or (
        goal.moves and goal.reference is not None and goal.reference.plural and goal.reference.count != 1
    )


def _said_by_person(goal: Goal, said: frozenset[str]) -> None:
    """Every noun of a goal that moves something was spoken by the person."""
    if not goal.moves:
        return
    for reference in (goal.reference, goal.placement.reference if goal.placement else None):
        for noun in _nouns(reference):
            if noun not in UNNAMED and not said & _forms(noun):
                raise RefusedError(f"the person did not speak of a {noun}; use their own words")


def _nouns(reference: Reference | None) -> tuple[str, ...]:
    if reference is None:
        return ()
    others = reference.relation.others if reference.relation is not None else ()
    inner = tuple(noun for other in (*others, *reference.excluding) for noun in _nouns(other))
    own = (f"obj {item.rsplit('_', 1)[-1]}" for item in reference.ids)
    return (*([reference.noun] if reference.noun else []), *(part.split()[-1] for part in own), *inner)


def _forms(noun: str) -> frozenset[str]:
    """The noun's words, singular and plural."""
    last = noun.split()[-1]
    return frozenset({noun, last, f"{last}s", f"{last}es", f"{last[:-1]}ies" if last.endswith("y") else last})


def judged_thought(
    got: Deliberation,
    situation: Situation,
    choose: Callable[[ChooseArgs], Choice],
    relooks: int,
) -> tuple[Deliberation, Plan | None]:
    """The plan to execute, as planned or as chosen within the limits; None where the brain does not act.

    Args:
        got: What the brain decided.
        situation: The facts.
        choose: The tool that checks a choice.
        relooks: Looks taken again for this goal so far.

    Raises:
        RefusedError: a choice outside the limits, a look too many, a question without words.
    """
    if got.choice == "look_again" and relooks >= MAX_RELOOKS:
        raise RefusedError("there is no further look: decide with what is known")
    if got.choice == "ask" and not (got.question or "").strip():
        raise RefusedError("the question is empty")
    if got.choice != "act":
        return got, None
    plan, percept = situation.plan, situation.percept
    if plan is None or percept is None:
        raise RefusedError("there is no plan to act on")
    _target_seen(plan, percept, situation.goal)
    args = ChooseArgs(
        plan=plan,
        percept=percept,
        constraints=situation.constraints or Constraints(),
        candidate=got.candidate,
        changes=got.changes,
    )
    choice = choose(args)
    if choice.plan is None:
        raise RefusedError(choice.refused or "the choice cannot be executed")
    return got, choice.plan


def _target_seen(plan: Plan, percept: Percept, goal: Goal | None) -> None:
    if all(obj.id != plan.target for obj in percept.objects):
        raise RefusedError(f"{plan.target} is not on the table")
    if goal is not None and goal.target not in (None, plan.target):
        raise RefusedError(f"the plan is for {plan.target}, and the task is about {goal.target}")


def judged_reflection(got: Reflected, situation: Situation) -> Reflected:
    """The correction is one of those allowed, as it was offered.

    Raises:
        RefusedError: it is another one.
    """
    if got.give_up or (got.correction is None and not situation.allowed):
        return got
    if got.correction not in situation.allowed:
        raise RefusedError("this correction is not among those allowed")
    return got


def judged_answer(got: Spoken, situation: Situation) -> Spoken:
    """The answer is short and has no number that the recorded facts do not have.

    Raises:
        RefusedError: it is empty or too long, or invents a number.
    """
    text = got.text.strip()
    if not text:
        raise RefusedError("the answer is empty")
    if len(text) > LONGEST_ANSWER:
        raise RefusedError(f"the answer has {len(text)} characters, and {LONGEST_ANSWER} are enough")
    known = {float(number) for number in NUMBER.findall(situation.facts)}
    for number in NUMBER.findall(text):
        if not any(abs(float(number) - fact) <= 0.5 * 10.0 ** -_decimals(number) for fact in known):
            raise RefusedError(f"the number {number} does not stand in the facts")
    return got


def _decimals(number: str) -> int:
    return len(number.partition(".")[2])


def judged_names(got: Seen, situation: Situation) -> Seen:
    """Names are for objects that were measured, one each.

    Raises:
        RefusedError: an object was not measured, or is named twice.
    """
    known = {obj.id for obj in situation.percept.objects} if situation.percept is not None else set[str]()
    named = [item.id for item in got.objects]
    strange = sorted({*named, *(r.source for r in got.relations), *(r.target for r in got.relations)} - known)
    if strange:
        raise RefusedError(f"there is no object {', '.join(strange)}")
    if len(set(named)) < len(named):
        raise RefusedError("an object is named twice")
    return got
