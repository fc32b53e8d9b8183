"""A conversation with the robot, the same for every face (terminal, web page, Python).

A face opens one, says what the person said, and shows the typed events that come back while things happen:

    with Conversation.open("cup_near_vase", 3, thread="kitchen", asks=True) as talk:
        for event in talk.say("pick up the cup"):        # agent.events.BaseStep and agent.chat.events
            show(event)                                  # event.kind, event.text, typed fields
        if talk.pending is not None:                     # the turn waits: its last event was `Asked`
            for event in talk.edit(force=6.0):           # or approve(), reject(), say("no, by the handle")
                show(event)
        for event in talk.whatif(force=4.0):             # why(), compare(), remember(), undo(), report(), ...
            show(event)

Rules that a face may rely on:

- Only one turn runs at a time. Everything that returns an iterator runs while it is iterated (the graph in a thread of its
  own, so that a slow face does not slow the robot down). Leaving one early stops the robot. A turn ends with `Finished`
  (with its RunResult), `Asked` or `Refused`.
- Errors of a command are events (`Refused`), never exceptions; only `open`, `fork` and the functions of
  `agent.chat.sessions` raise RagVlmErrors.
- `stop`, `release` and `steer` may be called from any thread at any time. A stop latches: until `release`, whatever would
  move is refused. `steer(text)` is heard before the next motion of the running turn; idle, say the same words with `say`.
- Text that comes back is inert: no control characters, no escape sequences. It is not HTML; a page must escape it.
- With a thread, everything is saved before the next step begins. Open the same thread again and the conversation, the
  memory, the world and a pending approval are there; `unfinished` names a turn that was cut off, `resume()` goes on.
- `history()` lists the points to which one can go back, `fork(id)` goes there; both branches stay.
"""

from __future__ import annotations

import datetime
import functools
import queue
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from agent.chat.heard import heard
from agent.chat.session_lock import SessionLock
from agent.chat.sessions import folder_of, threads_file, write_card
from agent.conversation import Agent, begin, checked
from kb.errors import BadInputError, EnvironmentFaultError, RagVlmError

if TYPE_CHECKING:
    from agent.approval import Proposal
    from agent.chat.call import ToolName
    from agent.chat.history import Point
    from agent.events import BaseStep
    from agent.state import State
    from kb.run_result import RunResult
    from memory import MemoryItem


MAX_STEERING = 500
"""Longest thing said between two steps [characters]; the rest is cut off."""


class Conversation:
    """One person, one robot, one scene at a time. Close it, or use it in a `with` statement."""

    def __init__(self, agent: Agent, *, folder: Path | None = None, lock: SessionLock | None = None) -> None:
        """Use `open`."""
        self.agent = agent
        """The agent with its world: `agent.opened` for pictures, `agent.views` for the last look."""
        self.folder = folder
        """Folder of the session (pictures, spans), or None where nothing is kept."""
        self._lock = lock
        self._busy = threading.Lock()
        self._mail: queue.SimpleQueue[str] = queue.SimpleQueue()
        agent.context.mail = self._letters
        agent.context.folder = folder
        agent.context.thread = agent.thread or "here"

    @classmethod
    def open(
        cls,
        scene: str | None = None,
        seed: int | None = None,
        *,
        thread: str | None = None,
        threads: str | Path | None = None,
        asks: bool = False,
        **options: Any,
    ) -> Conversation:
        """Opens the world and takes up the thread; nothing moves yet.

        Args:
            scene: As `build_agent`.
            seed: As `build_agent`.
            thread: Name under which everything is kept; None forgets it with the process.
            threads: File that keeps threads (default: in the user's data folder).
            asks: Ask before every motion.
            options: Further arguments of `build_agent` (brain, perception, evaluator, configuration, dry_run, base_url, ...).

        Raises:
            BadInputError: an unknown name, or a thread of another world.
            EnvironmentFaultError: the machine cannot do it, or another process holds the thread (with its pid).
        """
        from agent.build_agent import build_agent
        from agent.chat.graph import compile_chat
        from agent.chat.keep import open_store

        folder = folder_of(thread, threads) if thread else None
        lock = SessionLock(folder) if folder else None
        try:
            lasting = open_store(threads_file(threads).with_name("memory.sqlite") if thread else None)
            graph = functools.partial(compile_chat, store=lasting)
            agent = build_agent(scene, seed, thread=thread, threads=threads, graph=graph, **options)
        except BaseException:
            if lock is not None:
                lock.release()
            raise
        talk = cls(agent, folder=folder, lock=lock)
        if folder is not None and thread is not None:
            from agent.chat.spans import Spans

            agent.config["callbacks"] = [Spans(folder, thread)]
        talk.asks = asks
        talk._stand()
        return talk

    def __enter__(self) -> Conversation:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Stops the robot and gives the thread free."""
        self.agent.stop()
        if self._lock is not None:
            self._lock.release()

    # What a face may look at --------------------------------------------------------------------------------------

    @property
    def asks(self) -> bool:
        """Whether the person is asked before every motion; may be set at any time."""
        return self.agent.context.approve

    @asks.setter
    def asks(self, wanted: bool) -> None:
        self.agent.context.approve = wanted

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

    # Speaking -----------------------------------------------------------------------------------------------------

    def say(self, text: str) -> Iterator[BaseStep]:
        """One utterance of the person; while a motion waits for approval it is the answer to that.

        What was said by `steer` too late to be heard in this turn becomes a turn of its own right after it.
        """
        yield from self._one(text)
        yield from self.unheard()

    def unheard(self) -> Iterator[BaseStep]:
        """Deals with what was said by `steer` and came too late for its turn; after a stop it is dropped."""
        from agent.chat.events import Noted, Said

        while (letter := self._letter()) is not None:
            yield Said(text=letter)
            if self.stopped:
                yield Noted(text=f'I am stopped, so I do nothing about "{letter}".')
            else:
                yield from self._one(letter)

    def _one(self, text: str) -> Iterator[BaseStep]:
        try:
            words = checked(heard(text))
        except RagVlmError as error:
            yield _refused(error)
            return
        if self.pending is None:
            yield from self._turn(begin(words))
        else:
            yield from self._answered(words)

    def _answered(self, words: str) -> Iterator[BaseStep]:
        """What was said while a motion waits: yes, no, how else, or why."""
        from agent.chat.answered import about_pending, verdict

        said = verdict(words, self.state)
        if said is not None:
            yield from self.decide(said)
        else:
            yield about_pending(words, self.state, self.agent.context.tools.store)

    def steer(self, text: str) -> None:
        """Something said while the robot works: heard before the next motion; a plain "stop" stops at once."""
        from agent.chat.answered import stops

        words = heard(text).strip()
        if stops(words):
            self.stop()
        elif words:
            self._mail.put(words[:MAX_STEERING])

    def _letters(self) -> tuple[str, ...]:
        """What was said since the last call."""
        letters: list[str] = []
        while (letter := self._letter()) is not None:
            letters.append(letter)
        return tuple(letters)

    def _letter(self) -> str | None:
        try:
            return self._mail.get_nowait()
        except queue.Empty:
            return None

    def resume(self) -> Iterator[BaseStep]:
        """Goes on with the turn that was cut off."""
        yield from self._turn(None)

    def approve(self) -> Iterator[BaseStep]:
        """Lets the pending motion happen."""
        yield from self.decide({"verdict": "approve"})

    def reject(self) -> Iterator[BaseStep]:
        """Refuses the pending motion."""
        yield from self.decide({"verdict": "reject"})

    def edit(self, **changes: Any) -> Iterator[BaseStep]:
        """Lets the pending motion happen with other numbers: fields of `kb.grasp.Grasp`, within the hand's limits."""
        from pydantic import ValidationError

        from kb.grasp import Grasp

        waiting = self.pending
        if waiting is None:
            yield _refused(BadInputError("nothing waits for approval", where="edit"))
            return
        try:
            unknown = set(changes) - set(Grasp.model_fields)
            if unknown:
                raise BadInputError(f"a grasp has no {min(unknown)!r}", where="edit", choices=Grasp.model_fields)
            grasp = Grasp.model_validate({**waiting.plan.grasp.model_dump(), **changes})
        except ValidationError as error:
            first = error.errors()[0]
            yield _refused(BadInputError(str(first["msg"]), where=str(first["loc"][0])))
            return
        except BadInputError as error:
            yield _refused(error)
            return
        yield from self.decide({"verdict": "edit", "grasp": grasp.model_dump(mode="json")})

    def decide(self, decision: dict[str, Any]) -> Iterator[BaseStep]:
        """The person's word on the pending motion, as plain data of `agent.approval.Decision`."""
        from langgraph.types import Command

        if self.agent.waiting is None:
            yield _refused(BadInputError("nothing waits for approval", where="approval"))
            return
        yield from self._turn(Command(resume=decision))

    # Questions about what was done --------------------------------------------------------------------------------

    def why(self, attempt: int | None = None) -> Iterator[BaseStep]:
        """Why a grasp was chosen (`Explained`): of the attempt of that number, or the last."""
        yield from self._use("why", "why", {} if attempt is None else {"attempt": attempt})

    def compare(self, first: int | None = None, second: int | None = None) -> Iterator[BaseStep]:
        """Two attempts side by side (`Compared`), by their numbers (`state.attempts[i].number`); the last two by default."""
        given = {"first": first, "second": second}
        yield from self._use("compare", "compare", {k: v for k, v in given.items() if v is not None})

    def whatif(self, attempt: int | None = None, **changes: Any) -> Iterator[BaseStep]:
        """Simulates an attempt otherwise, from the saved moment before it (`WhatIf`); the world stays as it is.

        Args:
            attempt: Number of the attempt; the last by default.
            changes: force [N], aperture [m], yaw [rad], speed, type, approach ("top", "tilted", "side"), region,
                candidate (a name, or "other").
        """
        from agent.chat.whatif import check_changes

        try:
            check_changes(changes)
        except RagVlmError as error:
            yield _refused(error)
            return
        said = " ".join(f"{name}={value}" for name, value in changes.items())
        values = changes if attempt is None else {**changes, "attempt": attempt}
        yield from self._use("whatif", f"what if {said}", values)

    def remember(self) -> Iterator[BaseStep]:
        """Keeps what worked last for every later conversation."""
        yield from self._use("remember", "remember that", {})

    def forget(self, category: str | None = None) -> Iterator[BaseStep]:
        """Drops what was kept for later conversations, of a category or all."""
        yield from self._use("forget", "forget what you remember", {} if category is None else {"category": category})

    def recall(self) -> Iterator[BaseStep]:
        """Says what is remembered of this conversation and for good."""
        yield from self._use("recall", "what do you remember", {})

    def report(self) -> Iterator[BaseStep]:
        """Says what was done in this conversation."""
        yield from self._use("report", "report", {})

    def undo(self) -> Iterator[BaseStep]:
        """Puts back what was taken or moved last."""
        yield from self.say("undo")

    def _use(self, tool: ToolName, words: str, values: dict[str, Any]) -> Iterator[BaseStep]:
        from agent.chat.call import Call

        if self.pending is not None:
            yield from self._answered(words)
            return
        call = Call(tool=tool, words=words, values=values)
        yield from self._turn({**begin(words), "calls": (call,)})

    # Where in the conversation, and where in the world -----------------------------------------------------------

    def history(self, limit: int | None = None) -> tuple[Point, ...]:
        """Saved steps to which one can go back, the latest first."""
        from agent.chat.history import points

        return points(self.agent.graph, self.agent.config, limit)

    def fork(self, point: str) -> None:
        """Goes back to a saved step; what is said next goes on from there, and both branches stay.

        A step within a turn leaves that turn unfinished: `resume()` goes on with it, saying something else does not.

        Raises:
            BadInputError: there is no such step, or a turn is running.
        """
        from agent.chat.history import go_to

        if not self._busy.acquire(blocking=False):
            raise BadInputError("I am busy; stop me first", where="fork")
        try:
            go_to(self.agent.graph, self.agent.config, point)
            self._stand()
        finally:
            self._busy.release()

    def change_scene(self, scene: str, seed: int | None = None) -> Iterator[BaseStep]:
        """Another scene; what was said and learnt stays."""
        from agent.chat.change_scene import emptied, enter
        from agent.chat.events import Noted

        if not self._busy.acquire(blocking=False):
            yield _refused(BadInputError("I am busy; stop me first", where="scene"))
            return
        context = self.agent.context
        try:
            wanted = context.seed if seed is None else seed
            enter(context, scene, wanted, self.agent.perception)
            self.agent.graph.update_state(self.agent.config, emptied(scene, wanted), as_node="next_call")
            self._note()
            yield Noted(text=f"I am in {self.place} now.")
        except RagVlmError as error:
            yield _refused(error)
        finally:
            self._busy.release()

    def _stand(self) -> None:
        """Brings the living world to where the state says, for those who look at it."""
        from agent.chat.change_scene import enter

        state, context = self.state, self.agent.context
        if state.scene and (state.scene, state.seed) != (context.scene, context.seed):
            enter(context, state.scene, state.seed, self.agent.perception)
        context.world.at(state.world)

    # Stopping -----------------------------------------------------------------------------------------------------

    def stop(self) -> None:
        """Stops the robot at once and latches: nothing moves until `release`. From any thread, at any time."""
        self.agent.stop()

    def release(self) -> None:
        """Lets the robot move again; nothing moves by itself after that."""
        self.agent.release()

    # Running ------------------------------------------------------------------------------------------------------

    def _turn(self, entry: Any) -> Iterator[BaseStep]:
        """Runs the graph until the turn ends or waits."""
        from agent.chat.events import Asked, Finished, Stopped

        if not self._busy.acquire(blocking=False):
            yield _refused(BadInputError("I am busy; stop me or steer", where="conversation"))
            return
        try:
            begun = self.agent.context.clock()
            yield from self.agent.steps(entry)
            waiting = self.pending
            if waiting is not None:
                self._note()
                yield Asked(
                    text="May I do this?",
                    goal=waiting.goal,
                    plan=waiting.plan,
                    thought=waiting.thought,
                    clearance=waiting.clearance,
                )
                return
            result = self.agent.conclude(self.agent.context.clock() - begun)
            self._note()
            if self.stopped:
                yield Stopped(text="I am stopped and hold still; nothing moves until you release me (/release).")
            yield Finished(text=result.answer, result=result)
        except RagVlmError as error:
            yield _refused(error)
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


def _refused(error: RagVlmError) -> BaseStep:
    from agent.chat.events import Refused

    return Refused(text=str(error), code=3 if isinstance(error, EnvironmentFaultError) else 2)
