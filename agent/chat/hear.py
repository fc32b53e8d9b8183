"""What an utterance means within a conversation: references to what was done before become tool calls.

Anything that is a plain instruction or question is a task, and the brain reads it. Nothing here moves anything.
"""

from __future__ import annotations

import re
from typing import Any

from agent.chat.call import Call
from agent.chat.forms import (
    AGAIN,
    AND_REMEMBER,
    AND_THE,
    COMPARE,
    FORGET,
    GO_ON,
    HOW,
    INSTEAD,
    MANNERS,
    OTHER,
    RECALL,
    REMEMBER,
    REPORT,
    SAME_WITH,
    TALK,
    WHAT_IF,
)
from agent.chat.read_demand import only_demand, plain, read_demand
from agent.goal import Goal, Placement, Reference
from agent.kept_force import held_with
from agent.language.clauses import trim
from agent.language.lexicon import NOUNS
from agent.language.read_question import read_question
from agent.language.read_reference import is_reference, read_reference
from agent.state import State
from kb.errors import BadInputError
from tools.planning.demand import Demand


def hear(text: str, state: State) -> tuple[Call, ...]:
    """The tool calls that an utterance asks for, in order.

    Raises:
        BadInputError: a demand that the hand cannot meet (a force of 300 N).
    """
    if state.pending is not None and not _clearly(plain(text)):
        return (Call(tool="task", words=text),)
    line = _trimmed(plain(text))
    both = AND_REMEMBER.match(line)
    if both is not None and not _clearly(line):
        return (*hear(both["first"], state), Call(tool="remember", words=text))
    return _tool(line, text) or _again(line, state) or _elliptic(line, state) or (_task(line, text),)


def _trimmed(line: str) -> str:
    """Without courtesies at both ends, but with the manner: in an order "gently" is one, in a conversation it is a wish."""
    said = line.split()
    kept = trim(said)
    return " ".join([*kept, *(word for word in MANNERS if word in said and word not in kept)])


def _clearly(line: str) -> bool:
    """Whether the words are one of the conversation's own tools, whatever was asked back."""
    return any(regex.match(line) for regex in (REMEMBER, FORGET, RECALL, COMPARE, REPORT))


def _tool(line: str, text: str) -> tuple[Call, ...]:
    """A tool of the conversation that is asked for by its own words."""
    if REMEMBER.match(line):
        return (Call(tool="remember", words=text),)
    for tool, regex in (("forget", FORGET), ("recall", RECALL)):
        found = regex.match(line)
        if found is not None:
            groups = found.groupdict()
            what = _kind((groups.get("what") or groups.get("thing") or "").strip())
            return (Call(tool=tool, words=text, values={"category": what} if what else {}),)  # pyright: ignore[reportArgumentType]
    found = COMPARE.match(line)
    if found is not None:
        return (Call(tool="compare", words=text, values=_numbers(found["rest"])),)
    if REPORT.match(line):
        return (Call(tool="report", words=text),)
    for regex, reply in TALK:
        if regex.match(line):
            return (Call(tool="say", words=reply),)
    asked = read_question(line)
    if isinstance(asked, Goal) and (asked.query == "why" or (asked.query == "why_failed" and HOW.search(line))):
        return (Call(tool="why", words=text),)
    found = WHAT_IF.match(line)
    if found is not None:
        _, demand = read_demand(line)
        changes = changes_of(demand) if demand is not None else {}
        if re.search(r"\b(?:an)?other (?:candidate|grasp|way|place|option)\b|\balternative\b", line):
            changes["candidate"] = "other"
        if changes:
            return (Call(tool="whatif", words=text, values=changes),)
    return ()


def _kind(name: str) -> str:
    """The category that a name stands for, if it is one of a single kind: "phone" is a smartphone."""
    kinds = NOUNS.get(name, ())
    return kinds[0] if len(kinds) == 1 else name


def changes_of(demand: Demand) -> dict[str, Any]:
    """The demand as plain arguments of a what-if."""
    return demand.model_dump(exclude={"words"}, exclude_defaults=True)


def _numbers(rest: str) -> dict[str, Any]:
    """Which attempts: numbers as shown to the person (from 1), "first" and "last"."""
    counted = [int(n) - 1 for n in re.findall(r"\d+", rest)]
    if "first" in rest.split():
        counted = [0, *counted]
    if len(counted) >= 2:
        return {"first": counted[0], "second": counted[1]}
    return {"first": counted[0]} if counted else {}


def _again(line: str, state: State) -> tuple[Call, ...]:
    """What was done last, once more: "do that again but gentler", "no, by the handle"; or the rest of it: "go on"."""
    if GO_ON.match(line) and state.deed:
        rest_of_it = tuple(_anew(goal) for goal in state.deed)
        return (Call(tool="task", words=line, goals=rest_of_it, demands=state.demands),)
    demand = only_demand(line)
    rest = line
    if demand is None:
        rest, demand = read_demand(line)
        if not AGAIN.match(rest):
            return ()
    if not state.deed:
        return (Call(tool="say", words="I have done nothing yet that I could do again."),)
    kept = () if demand is None else (demand,)
    demands = merged_demands(state.demands, relative(kept, state))
    return (Call(tool="task", words=line, goals=repeated(state), demands=demands),)


def relative(demands: tuple[Demand, ...], state: State) -> tuple[Demand, ...]:
    """The word "gentler" means gentler than the last time: scales become numbers where there was a last time."""
    plan = state.plan or (state.attempts[-1].plan if state.attempts else None)
    if plan is None:
        return demands
    # What was held with more than was planned is not gentle at the planned number.
    last = state.attempts[-1] if state.attempts else None
    used = held_with(last) if last is not None and last.plan == plan else plan.grasp.force
    fixed: list[Demand] = []
    for demand in demands:
        update: dict[str, Any] = {}
        if demand.force_scale != 1.0:
            update |= {
                "force_scale": 1.0,
                "force": round(min(70.0, max(1.0, used * demand.force_scale)), 2),
            }
        if demand.speed_scale != 1.0:
            update |= {"speed_scale": 1.0, "speed": round(min(1.0, max(0.1, plan.grasp.speed * demand.speed_scale)), 3)}
        fixed.append(demand.model_copy(update=update))
    return tuple(fixed)


def merged_demands(old: tuple[Demand, ...], new: tuple[Demand, ...]) -> tuple[Demand, ...]:
    """All demands; of the earlier ones those go that a later one contradicts."""

    def told(demand: Demand) -> set[str]:
        names = set(demand.model_dump(exclude={"words"}, exclude_defaults=True))
        return {
            "place" if name in ("region", "not_region", "candidate") else name.removesuffix("_scale") for name in names
        }

    later = {name for demand in new for name in told(demand)}
    return (*(demand for demand in old if not told(demand) & later), *new)


def repeated(state: State) -> tuple[Goal, ...]:
    """The goals of the last deed from the beginning; what it took or moved goes back first."""
    back = Goal(kind="place", reference=Reference(words="it", pronoun=True), placement=Placement(kind="back"))
    goals = tuple(_fresh(goal) for goal in state.deed)
    thing = state.held.object.id if state.held is not None else state.moved.id if state.moved is not None else None
    again = any(goal.reference is not None and thing in goal.reference.ids for goal in goals)
    if thing is None or not again or any(g.placement is not None and g.placement.kind == "back" for g in goals):
        return goals
    return (back, *goals)


def _anew(goal: Goal) -> Goal:
    """The goal as asked; what it was about is looked for again, so that what was done already is not done twice."""
    fresh = _fresh(goal)
    if goal.kind in ("clear", "sort") and fresh.reference is not None:
        return fresh.model_copy(update={"reference": fresh.reference.model_copy(update={"ids": ()})})
    return fresh


def _fresh(goal: Goal) -> Goal:
    """The goal as it was when it was asked, about the very thing that it was about."""
    reference = goal.reference
    if goal.target is not None and reference is not None and goal.kind in ("pick", "place"):
        name = (goal.target_category or "object").replace("_", " ")
        reference = Reference(words=f"the {name}", ids=(goal.target,))
    return Goal(
        kind=goal.kind, reference=reference, placement=goal.placement, query=goal.query, measure=goal.measure,
        descending=goal.descending,
    )  # fmt: skip


def _elliptic(line: str, state: State) -> tuple[Call, ...]:
    """The same with another thing: "and the apple?", "the other one", "the same with the red one"."""
    reference = thing_instead(line, state)
    if reference is None or not state.asked or state.asked[-1].reference is None:
        return ()
    fresh = _fresh(state.asked[-1]).model_copy(update={"reference": reference})
    return (Call(tool="task", words=line, goals=(fresh,)),)


def thing_instead(line: str, state: State) -> Reference | None:
    """The other thing that "and the apple?", "no, the other one" or "the same with the red one" speak of."""
    found = OTHER.match(line) or SAME_WITH.match(line) or AND_THE.match(line) or INSTEAD.match(line)
    if found is None:
        return None
    groups = found.groupdict()
    what = groups.get("what") or groups.get("too") or ""
    reading = read_reference(what.split())
    if reading.unknown or reading.contradiction or not is_reference(reading):
        return None
    reference = Reference(**reading.found)
    if reference.other and not reference.categories:
        reference = reference.model_copy(update={"categories": _category(state), "noun": None})
    return reference


def _category(state: State) -> tuple[str, ...]:
    """Of "the other one": the kind of thing that was spoken of, if there are several of them."""
    last = state.asked[-1].target_category if state.asked else None
    seen = state.percept.objects if state.percept is not None else ()
    several = any(obj.category == last and obj.id != state.last_target for obj in seen)
    return (last,) if several and last is not None else ()


def _task(line: str, text: str) -> Call:
    """An instruction or question for the brain, with what it says about the manner."""
    try:
        rest, demand = read_demand(line)
    except BadInputError:
        if re.match(
            r"^(?:pick|take|grab|grasp|grip|lift|get|hold|hand|give|put|place|bring|fetch|squeeze|close)\b", line
        ):
            raise
        return Call(tool="task", words=text)
    verb = re.match(
        r"^(?:please |now |then |gently |carefully )*(?:pick|take|grab|grasp|grip|lift|get|hold|hand|give|bring|fetch|put|place|move)\b",
        rest,
    )
    if demand is None or verb is None:
        return Call(tool="task", words=text)
    return Call(tool="task", words=rest, demands=(demand,))
