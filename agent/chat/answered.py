"""What a person says while a motion waits for approval, or while the robot works."""

from __future__ import annotations

from typing import Any

from agent import events
from agent.attempt import Attempt
from agent.chat.events import Noted
from agent.chat.explain import explain
from agent.chat.hear import hear, thing_instead
from agent.chat.read_demand import only_demand, plain
from agent.chat.steer import place_instead
from agent.language.read_command import understand
from agent.placed import putting
from agent.state import State
from kb.errors import BadInputError
from kb.sensing import Sensing

YES = frozenset(
    "y|yes|ok|okay|approve|approved|go|go ahead|go on|do it|do that|yes please|yes do it|sure|fine|right|yes go ahead|"
    "please do|alright|all right|yep|yeah|you may|continue|proceed|good|yes you may".split("|")
)
NO = frozenset(
    "n|no|reject|rejected|no thanks|no thank you|do not|no do not|do not do it|do not do that|cancel|nope|leave it|"
    "better not|not now|never mind|nevermind|forget it|abort".split("|")
)


def stops(words: str) -> bool:
    """Whether the words only say that the robot is to stop."""
    got = understand(words[:200]) if words else None
    return got is not None and bool(got.goals) and all(goal.query == "stop" for goal in got.goals)


def verdict(words: str, state: State) -> dict[str, Any] | None:
    """The decision that the words are, as plain data of `agent.approval.Decision`; None if they are none."""
    line = plain(words).strip(" ,.;")
    bare = line.replace(" ,", "")
    if bare in YES:
        return {"verdict": "approve"}
    if bare in NO or stops(words):
        return {"verdict": "reject"}
    if steers(words, state):
        return {"verdict": "steer", "words": words}
    return None


def steers(words: str, state: State) -> bool:
    """Whether the words say how else, what else or where else."""
    line = plain(words)
    goal = state.goal if state.agenda else None
    try:
        if only_demand(line) is not None:
            return not placing(state)  # how a thing is taken, not how it is put down
    except BadInputError:
        return False
    if goal is None or goal.parent is not None:
        return False
    if thing_instead(line, state) is not None:
        return True
    return goal.kind == "place" and place_instead(words) is not None


def about_pending(words: str, state: State, store: Any) -> events.BaseStep:
    """The answer to what is no decision: why this grasp, or that a decision is waited for."""
    calls = hear(words, state) if len(words) < 500 else ()
    if placing(state):
        return _about_placing(state, why=any(call.tool == "why" for call in calls))
    if any(call.tool == "why" for call in calls) and state.plan is not None and state.percept is not None:
        target = state.percept.object(state.plan.target)
        proposed = Attempt(
            number=len(state.attempts), turn=state.turn, goal=state.agenda[-1], level=state.level, plan=state.plan,
            target=target, constraints=state.constraints, sensing=Sensing(), thought=state.thought,
        )  # fmt: skip
        return explain(proposed, store)
    try:
        only_demand(plain(words))
    except BadInputError as error:
        return Noted(text=f"{error}. The motion still waits: yes, no, or how else.")
    return Noted(
        text="The motion waits for your word first: yes, no, how else (by the handle, gentler, with 5 N), or why. "
        "I have done nothing about what you said."
    )


def placing(state: State) -> bool:
    """Whether what is asked about is a placing: the thing is in the hand already."""
    return bool(state.agenda) and state.held is not None and state.goal.target == state.held.object.id


def _about_placing(state: State, *, why: bool) -> events.BaseStep:
    """While a placing waits: why there, or what can be answered."""
    goal, held = state.goal, state.held
    assert held is not None
    if why:
        asked = "you asked me to" if goal.parent is None else "it has to be done before what you asked for"
        return Noted(
            text=f"I would {putting(goal, held)} because {asked}; it is the free place within my reach that "
            "fits best. The motion still waits: yes, no, or where else."
        )
    return Noted(
        text="The motion waits for your word first: yes, no, where else (put it on the right), or why. "
        "I have done nothing about what you said."
    )
