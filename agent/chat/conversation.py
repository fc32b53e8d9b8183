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

import functools
import queue
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from agent.chat.heard import heard
from agent.chat.questions import Questions
from agent.chat.session_lock import SessionLock
from agent.chat.sessions import folder_of, kept_asks, threads_file
from agent.chat.turns import refused
from agent.conversation import Agent, begin, checked
from kb.errors import BadInputError, RagVlmError

if TYPE_CHECKING:
    from agent.chat.history import Point
    from agent.chat.spans import Spans
    from agent.events import BaseStep


MAX_STEERING = 500
"""Longest thing said between two steps [characters]; the rest is cut off."""


class Conversation(Questions):
    """One person, one robot, one scene at a time. Close it, or use it in a `with` statement."""

    def __init__(self, agent: Agent, *, folder: Path | None = None, lock: SessionLock | None = None) -> None:
        """Use `open`."""
        super().__init__(agent, folder=folder, lock=lock)
        self._spans: Spans | None = None
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
    ) -> Self:
        """Opens the world and takes up the thread; nothing moves yet.

        Args:
            scene: As `build_agent`.
            seed: As `build_agent`.
            thread: Name under which everything is kept; None forgets it with the process.
            threads: File that keeps threads (default: in the user's data folder).
            asks: Ask before every motion; a thread whose person wanted it goes on asking.
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

            talk._spans = Spans(folder, thread)
            agent.config["callbacks"] = [talk._spans]
        talk.asks = asks or (folder is not None and kept_asks(folder))
        talk._stand()
        return talk

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Stops the robot and gives the thread free."""
        self.agent.stop()
        if self._spans is not None:
            self._spans.close()
        if self._lock is not None:
            self._lock.release()

    # Speaking -----------------------------------------------------------------------------------------------------

    def say(self, text: str) -> Iterator[BaseStep]:
        """One utterance of the person; while a motion waits for approval it is the answer to that.

        What was said by `steer` too late to be heard in this turn becomes a turn of its own right after it.
        """
        yield from self._one(text)
        yield from self.unheard()

    @property
    def has_unheard(self) -> bool:
        """Whether something said by `steer` was not dealt with yet."""
        return not self._mail.empty()

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
            yield refused(error)
            return
        if self.pending is None:
            yield from self._turn(begin(words))
        else:
            yield from self._answered(words)

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

    def undo(self) -> Iterator[BaseStep]:
        """Puts back what was taken or moved last."""
        yield from self.say("undo")

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
            yield refused(BadInputError("I am busy; stop me first", where="scene"))
            return
        context = self.agent.context
        try:
            wanted = context.seed if seed is None else seed
            enter(context, scene, wanted, self.agent.perception)
            self.agent.graph.update_state(self.agent.config, emptied(scene, wanted), as_node="next_call")
            self._note()
            yield Noted(text=f"I am in {self.place} now.")
        except RagVlmError as error:
            yield refused(error)
        finally:
            self._busy.release()

    def _stand(self) -> None:
        """Brings the living world to where the state says, for those who look at it."""
        from agent.chat.change_scene import enter

        state, context = self.state, self.agent.context
        if state.scene and (state.scene, state.seed) != (context.scene, context.seed):
            enter(context, state.scene, state.seed, self.agent.perception)
        context.world.at(state.world)
