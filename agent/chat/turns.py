"""What every part of a conversation stands on: the agent, its saved state, one turn at a time, and the stop."""

from __future__ import annotations

import datetime
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from agent.chat.session_lock import SessionLock
from agent.chat.sessions import keep_asks, write_card
from agent.conversation import Agent
from kb.errors import BadInputError, EnvironmentFaultError, RagVlmError

if TYPE_CHECKING:
    from agent.approval import Proposal
    from agent.events import BaseStep
    from agent.state import State
    from kb.run_result import RunResult
    from memory import MemoryItem


class Turns:
    """Runs turns and tells where the conversation stands; `Conversation` is made of it."""

    def __init__(self, agent: Agent, *, folder: Path | None = None, lock: SessionLock | None = None) -> None:
        self.agent = agent
        """The agent with its world: `agent.opened` for pictures, `agent.views` for the last look."""
        self.folder = folder
        """Folder of the session (pictures, spans), or None where nothing is kept."""
        self._lock = lock
        self._busy = threading.Lock()

    # What a face may look at --------------------------------------------------------------------------------------

    @property
    def asks(self) -> bool:
        """Whether the person is asked before every motion; may be set at any time, and is kept with the session."""
        return self.agent.context.approve

    @asks.setter
    def asks(self, wanted: bool) -> None:
        self.agent.context.approve = wanted
        if self.folder is not None:
            keep_asks(self.folder, wanted)

    @property
    def place(self) -> str:
        """Scene and seed, in words."""
        return f"scene {self.agent.opened.scene}, seed {self.agent.opened.seed}"

    @property
    def busy(self) -> bool:
        """Whether a turn is running."""
        return self._busy.locked()

    @property
    def stopped(self) -> bool:
        """Whether the robot was stopped and not released."""
        return bool(self.agent.opened.stop.pressed)

    @property
    def pending(self) -> Proposal | None:
        """The motion that waits for a person's word, or None; survives a restart."""
        from agent.approval import Proposal

        waiting = self.agent.waiting
        return None if waiting is None else Proposal.model_validate(waiting)

    @property
    def unfinished(self) -> str | None:
        """What was said in a turn that was cut off (a killed process), or None."""
        return self.agent.interrupted if self.agent.waiting is None else None

    @property
    def state(self) -> State:
        """The state as last saved: percept, attempts, memory, messages, held, ..."""
        return self.agent.state

    @property
    def result(self) -> RunResult | None:
        """Result of the last turn."""
        return self.agent.result

    @property
    def messages(self) -> tuple[tuple[str, str], ...]:
        """The conversation so far: ("person" or "robot", text)."""
        return tuple(("person" if m.type == "human" else "robot", str(m.content)) for m in self.state.messages)

    @property
    def memory(self) -> tuple[MemoryItem, ...]:
        """What worked in this conversation."""
        return self.state.memory.items

    # Stopping -----------------------------------------------------------------------------------------------------

    def stop(self) -> None:
        """Stops the robot at once and latches: nothing moves until `release`. From any thread, at any time."""
        self.agent.stop()

    def release(self) -> None:
        """Lets the robot move again, after the turn in work at the earliest; nothing moves by itself after that."""
        self.agent.release()

    # Running ------------------------------------------------------------------------------------------------------

    def _turn(self, entry: Any) -> Iterator[BaseStep]:
        """Runs the graph until the turn ends or waits."""
        from agent.chat.events import Asked, Finished, Stopped

        if not self._busy.acquire(blocking=False):
            yield refused(BadInputError("I am busy; stop me or steer", where="conversation"))
            return
        try:
            begun = self.agent.context.clock()
            yield from self.agent.steps(entry)
            waiting = self.pending
            if waiting is not None:
                self._note()
                yield Asked(
                    text=waiting.question,
                    goal=waiting.goal,
                    plan=waiting.plan,
                    thought=waiting.thought,
                    clearance=waiting.clearance,
                    motion=waiting.motion,
                    point=waiting.point,
                )
                return
            result = self.agent.conclude(self.agent.context.clock() - begun)
            self._note()
            if self.stopped:
                yield Stopped(text="I am stopped and hold still; nothing moves until you release me (/release).")
            _give_back()
            yield Finished(text=result.answer, result=result)
        except RagVlmError as error:
            yield refused(error)
        finally:
            self._busy.release()

    def _note(self) -> None:
        """Writes the session's card for the list; that it cannot be written is no reason to lose the turn."""
        if self.folder is None:
            return
        state = self.state
        card = {
            "scene": state.scene,
            "seed": state.seed,
            "turns": state.turn + 1,
            "last": state.instruction[:200],
            "updated": datetime.datetime.now().isoformat(timespec="seconds"),
        }
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            write_card(self.folder, card)
        except OSError:
            return


def _give_back() -> None:
    """Returns to the system what a turn's pictures and physics took and do not need any more (3 ms).

    Each turn runs in threads of its own; the C library (glibc; elsewhere this does nothing) would keep an arena for each,
    and the process would seem to grow by a tenth from one turn to the next.
    """
    import ctypes

    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
    if trim is not None:
        trim(0)


def refused(error: RagVlmError) -> BaseStep:
    """The error as an event."""
    from agent.chat.events import Refused

    return Refused(text=str(error), code=3 if isinstance(error, EnvironmentFaultError) else 2)
