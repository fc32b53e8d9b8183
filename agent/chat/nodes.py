"""The nodes of the conversation around the task graph: hear, choose the next tool, use it, tell (a ReAct loop).

As in the task graph a node is a few lines, tells what happened as a typed step, and returns an update.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Literal, cast

from langchain_core.messages import AIMessage, HumanMessage, RemoveMessage
from langgraph.runtime import Runtime

from agent import events
from agent.agenda import finish
from agent.attempt import Attempt
from agent.chat import keep as lasting
from agent.chat.call import Call
from agent.chat.compare import compare as compared
from agent.chat.events import Noted
from agent.chat.explain import explain
from agent.chat.hear import hear as read
from agent.chat.report import report as reported
from agent.chat.steer import STOPPED, steered
from agent.chat.whatif import whatif as simulated
from agent.context import AgentContext
from agent.goal import Goal, Query
from agent.state import State, Update, merged
from kb.constraint import Constraints
from kb.errors import BadInputError

Run = Runtime[AgentContext]

KEPT_MESSAGES = 200
"""Messages that the conversation keeps."""
KEPT_DISPLACED = 40
"""Entries of what was put somewhere that are kept."""


def hear(state: State, runtime: Run) -> Update:
    """What the person said -> tool calls; a face may have given them already ("/why")."""
    context = runtime.context
    context.start_memory = lasting.as_memory(runtime.store)
    said = HumanMessage(state.instruction, id=f"said-{state.turn + 1}")
    old = [RemoveMessage(id=str(m.id)) for m in state.messages[: max(0, len(state.messages) + 2 - KEPT_MESSAGES)]]
    update = Update(
        said=state.instruction, messages=cast(Any, [*old, said]), hops=0, call=None, answer="", question=None, refused=False,
        displaced=state.displaced[-KEPT_DISPLACED:],
    )  # fmt: skip
    if state.calls:
        return update
    try:
        calls = read(state.instruction, state)
    except BadInputError as error:
        calls = (Call(tool="say", words=f"{error}."),)
    return merged(update, Update(calls=calls))


def next_call(state: State, runtime: Run) -> Update:
    """The next tool call; after a task what it was about is noted, for "that", "again" and "the other one"."""
    del runtime
    update = Update(call=None)
    if state.call is not None and state.call.tool == "task":
        asked = tuple(goal for goal in state.goals if goal.parent is None)
        about = tuple(goal for goal in asked if goal.reference is not None and not _back(goal))
        deed = tuple(goal for goal in asked if goal.moves and not _back(goal))
        update["asked"] = about or state.asked
        update["deed"] = deed or state.deed
    if not state.calls:
        return merged(update, Update(instruction=state.said or state.instruction))
    call, rest = state.calls[0], state.calls[1:]
    update |= Update(call=call, calls=rest, hops=state.hops + 1)
    if call.tool == "task":
        update |= Update(instruction=call.words, demands=call.demands)
    return update


def _back(goal: Goal) -> bool:
    return goal.placement is not None and goal.placement.kind == "back"


def heed(state: State, runtime: Run) -> Update:
    """Before a motion: what the person has said meanwhile, and whether anything may move."""
    context = runtime.context
    update = Update()
    for words in context.mail():
        now = replace(state, **update)  # messages are added, not replaced, but the next word does not look at them
        update = _both(update, steered(now, words, context=context))
    state = replace(state, **update)
    if context.stopped and state.agenda:
        context.emit(Noted(text=STOPPED, goal=state.current))
        ended = finish(state, claimed=False, note=STOPPED)
        return merged(update, ended, Update(agenda=()))
    return update


def _both(first: Update, second: Update) -> Update:
    """Two updates in one, both with their messages."""
    messages = [*first.get("messages", []), *second.get("messages", [])]
    return merged(first, second, Update(messages=messages)) if messages else merged(first, second)


# Tools that answer from what is recorded -----------------------------------------------------------------------------


def why(state: State, runtime: Run) -> Update:
    """Why a grasp was chosen."""
    attempt = _attempt(state, "attempt")
    if attempt is None:
        return _tell(state, runtime, no_attempt(state), query="why")
    step = explain(attempt, runtime.context.tools.store)
    return _tell(state, runtime, step.text, step, query="why")


def no_attempt(state: State) -> str:
    """That there is none of that number, and which there are."""
    if not state.attempts:
        return "I have not grasped anything yet in this conversation."
    first, last = state.attempts[0].number + 1, state.attempts[-1].number + 1
    if first == last:
        return f"There is only attempt {last} in this conversation."
    return f"I have attempts {first} to {last} of this conversation."


def compare(state: State, runtime: Run) -> Update:
    """Two attempts side by side: the last two, or those that were named."""
    first, second = _attempt(state, "first", -2), _attempt(state, "second", -1)
    if first is None or second is None or first.number == second.number:
        return _tell(state, runtime, f"{no_attempt(state)} Comparing needs two different ones.")
    step = compared(first, second)
    return _tell(state, runtime, step.text, step)


def whatif(state: State, runtime: Run) -> Update:
    """A change of an attempt, simulated from the saved moment before it."""
    assert state.call is not None
    values = dict(state.call.values)
    number = values.pop("attempt", None)
    saved = [a for a in state.attempts if a.before]
    attempt = (
        next((a for a in saved if number in (None, a.number)), None) if number is not None else (saved or [None])[-1]
    )
    if attempt is None:
        text = "I have grasped nothing yet in this conversation, so there is nothing to simulate."
        if number is not None and state.attempts:
            text = f"The moment before attempt {int(number) + 1} is not kept; I keep the last {len(saved)}."
        return _tell(state, runtime, text, query="what_if")
    times: dict[str, float] = {}
    try:
        with runtime.context.timed("execution", times):
            step = simulated(attempt, values, runtime.context, runtime.context.folder)
    except BadInputError as error:
        return _tell(state, runtime, f"{error}.", query="what_if")
    return merged(_tell(state, runtime, step.text, step, query="what_if"), Update(times=times))


def remember_that(state: State, runtime: Run) -> Update:
    """Keeps what worked last for every later conversation."""
    return _tell(state, runtime, lasting.keep(runtime.store, state, runtime.context.thread))


def forget(state: State, runtime: Run) -> Update:
    """Drops what was kept for later conversations."""
    assert state.call is not None
    return _tell(state, runtime, lasting.forget(runtime.store, state.call.values.get("category")))


def recall(state: State, runtime: Run) -> Update:
    """Says what is remembered."""
    return _tell(state, runtime, lasting.recalled(state.memory.items, lasting.kept(runtime.store)))


def report(state: State, runtime: Run) -> Update:
    """Says what was done in this conversation."""
    return _tell(state, runtime, reported(state))


def reply(state: State, runtime: Run) -> Update:
    """Says what the conversation itself has to say."""
    assert state.call is not None
    return _tell(state, runtime, state.call.words)


def _attempt(state: State, name: str, place: int = -1) -> Attempt | None:
    """The attempt of that number, or counted from the end."""
    assert state.call is not None
    number = state.call.values.get(name)
    if number is not None:
        return next((a for a in state.attempts if a.number == number), None)
    return state.attempts[place] if len(state.attempts) >= -place else None


def _tell(
    state: State, runtime: Run, text: str, step: events.BaseStep | None = None, *, query: Query | None = None
) -> Update:
    """Answers; the first tool of an utterance begins a turn, a later one adds to it."""
    if step is not None:
        runtime.context.emit(step)
    else:
        runtime.context.emit(events.Answer(text=text))
    first = state.hops <= 1
    turn = state.turn + 1 if first else state.turn
    update = Update(
        answer=text if first or not state.answer else f"{state.answer}\n{text}",
        messages=[AIMessage(text, id=f"turn-{turn}-tool-{state.hops}")],
    )
    if not first:
        return update
    goal = Goal(kind="answer", query=query, status="done", claimed=True)
    return merged(
        update,
        Update(
            scene=runtime.context.scene, seed=runtime.context.seed, turn=turn, goals=(goal,), agenda=(), executed=False,
            motions={}, shown=None, graph=None, constraints=Constraints(), question=None, refused=False,
        ),
    )  # fmt: skip


# Where to go next ----------------------------------------------------------------------------------------------------

TOOLS: dict[str, Any] = {
    "why": why, "compare": compare, "whatif": whatif, "remember": remember_that, "forget": forget, "recall": recall,
    "report": report, "say": reply,
}  # fmt: skip
"""Tool of a call -> its node; "task" is the task graph."""

NextNode = Literal[
    "understand", "why", "compare", "whatif", "remember_that", "forget", "recall", "report", "reply", "__end__"
]


def after_next_call(state: State) -> NextNode:
    """The node of the call in work, or the end of the turn."""
    if state.call is None:
        return "__end__"
    return "understand" if state.call.tool == "task" else TOOLS[state.call.tool].__name__


def after_heed(
    state: State, runtime: Run
) -> Literal["answer", "look", "ground", "plan", "place", "approve_place", "approve", "act"]:
    """To the motion, unless the person's word or a stop has changed what is to be done."""
    if state.refused or not state.agenda:
        return "answer"
    if state.stale:
        return "look"
    goal = state.goal
    if state.held is not None and goal.target == state.held.object.id and goal.placement is not None:
        return "approve_place" if runtime.context.approve else "place"
    if goal.target is None:
        return "ground"
    if state.plan is None:
        return "plan"
    return "approve" if runtime.context.approve else "act"
