"""The agent as its users hold it: one conversation in one world, run or streamed, stopped and taken up again."""

from __future__ import annotations

import queue
import threading
import unicodedata
from collections.abc import Callable, Generator, Iterator
from typing import TYPE_CHECKING, Any

from agent.checkpoint import prune, settle
from kb.errors import BadInputError, EnvironmentFaultError

if TYPE_CHECKING:
    from agent.events import BaseStep
    from agent.state import State
    from kb.run_result import RunResult
    from tools.open_world import OpenedWorld

MAX_INSTRUCTION = 10_000
"""Longest instruction [characters]."""
STEP_LIMIT = 4_000
"""Graph steps per instruction: far above what twelve objects with four attempts each need (about 600)."""

Approve = Callable[[dict[str, Any]], dict[str, Any]]
"""Shown the proposed motion as plain data, returns a decision as plain data (`agent.approval.Decision`)."""


class Agent:
    """A robot agent in a world, and the conversation with it. Made by `build_agent`."""

    def __init__(
        self, context: Any, graph: Any, names: dict[str, str], *, thread: str | None, approve: Approve | None
    ) -> None:
        self.context = context
        """What the nodes are injected with (`agent.context.AgentContext`)."""
        self._graph = graph
        self._names = names
        self._approve = approve
        self._durability = "sync" if thread is not None else "exit"
        self._config = {"configurable": {"thread_id": thread or "here"}, "recursion_limit": STEP_LIMIT}
        self._running = threading.Lock()
        self._latch = threading.Lock()
        """Held while stop, release and the end of a turn are put in order."""
        self._at_work = self._release_after = False
        self.thread = thread
        """Name of the thread, or None."""
        self.result: RunResult | None = None
        """Result of the last run."""

    # What faces may look at --------------------------------------------------------------------------------------

    @property
    def opened(self) -> OpenedWorld:
        """The world with robot and observer; for pictures, videos and reports."""
        return self.context.world.opened

    @property
    def views(self) -> tuple[Any, ...]:
        """Pictures of the last look."""
        return self.context.tools.robot.views

    @property
    def state(self) -> State:
        """The state as last checkpointed."""
        from agent.state import State

        return State(**self._graph.get_state(self._config).values)

    @property
    def waiting(self) -> dict[str, Any] | None:
        """The proposal (`agent.approval.Proposal` as plain data) that waits for a person's word, or None."""
        found = [item for task in self._graph.get_state(self._config).tasks for item in task.interrupts]
        return found[0].value if found else None

    @property
    def interrupted(self) -> str | None:
        """The instruction that a killed process left unfinished in this thread, or None."""
        snapshot = self._graph.get_state(self._config)
        return snapshot.values.get("instruction") if snapshot.next else None

    @property
    def graph(self) -> Any:
        """The compiled graph with its checkpointer."""
        return self._graph

    @property
    def config(self) -> dict[str, Any]:
        """What names this conversation to the graph."""
        return self._config

    @property
    def perception(self) -> str:
        """Name of the perception."""
        return self._names["perception"]

    # Running -----------------------------------------------------------------------------------------------------

    def run(self, instruction: str, on_step: Callable[[BaseStep], None] | None = None) -> RunResult:
        """Carries out one instruction and returns what came of it; the world goes on from where it was.

        An instruction that equals the one a killed process left unfinished is taken up where it stopped.

        Raises:
            BadInputError: the instruction is empty or longer than `MAX_INSTRUCTION` characters.
        """
        for step in self.stream(instruction):
            if on_step is not None:
                on_step(step)
        assert self.result is not None
        return self.result

    def resume(self, on_step: Callable[[BaseStep], None] | None = None) -> RunResult | None:
        """Finishes what a killed process left unfinished; None if there is nothing."""
        unfinished = self.interrupted
        return None if unfinished is None else self.run(unfinished, on_step)

    def stream(self, instruction: str) -> Iterator[BaseStep]:
        """Like `run`, as an iterator of typed steps that come while they happen; `result` is set at its end.

        Leaving the iterator early stops the robot; what was done until then is saved.
        """
        text = checked(instruction)
        if not self._running.acquire(blocking=False):
            raise BadInputError("this agent is busy with another instruction", where="run")
        try:
            start = self.context.clock()
            entry: Any = None if self.interrupted == text else {**begin(text), "demands": ()}
            while entry is not False:
                yield from self.steps(entry)
                entry = yield from self._decide()
            self.conclude(self.context.clock() - start)
        finally:
            self._running.release()

    def conclude(self, total: float) -> RunResult:
        """Writes the result of the turn that has just ended, and forgets checkpoints that nobody will go back to.

        Args:
            total: wall time of the turn [s].
        """
        self.result = self._result(total)
        if self.thread is not None:
            _saved(prune, self._graph.checkpointer, self.thread)
        return self.result

    def steps(self, entry: Any) -> Iterator[BaseStep]:
        """Runs the graph in a thread of its own until it ends or waits, and yields its steps.

        Args:
            entry: an update of the state to begin with, a `Command` that resumes, or None to go on where it was cut off.
        """
        told: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self.context.emit = told.put
        failures: list[BaseException] = []

        def work() -> None:
            try:
                self._graph.invoke(entry, self._config, context=self.context, durability=self._durability)
            except BaseException as error:
                failures.append(error)
            finally:
                self._rest()
                told.put(None)

        self._at_work = True
        worker = threading.Thread(target=work, name="ragvlm-graph", daemon=True)
        worker.start()
        try:
            while (step := told.get()) is not None:
                yield step
        except BaseException:
            self.stop()
            worker.join()
            raise
        finally:
            self.context.emit = lambda _step: None
        worker.join()
        if failures:
            raise _told(failures[0])
        if self.thread is not None:
            _saved(settle, self._graph.checkpointer)

    def _decide(self) -> Generator[BaseStep, None, Any]:
        """Where the graph waits for a person: asks, and returns the command that goes on; False if it does not wait."""
        from langgraph.types import Command

        from agent.approval import Proposal
        from agent.events import Approval

        proposal = self.waiting
        if proposal is None:
            return False
        asked = Proposal.model_validate(proposal)
        yield Approval(text=asked.question, goal=asked.goal, plan=asked.plan)
        decision = self._approve(proposal) if self._approve is not None else {"verdict": "reject"}
        return Command(resume=decision)

    def _result(self, total: float) -> RunResult:
        from agent.run_result import run_result

        # A run taken up after its last motion has moved nothing, so nothing has brought back the observer's record yet.
        state = self.state
        observer = self.context.world.at(state.world).observer
        return run_result(state, observer, total=total, **self._names)

    # Stopping ----------------------------------------------------------------------------------------------------

    def stop(self) -> None:
        """Stops the robot and latches: nothing moves until `release`. May be called from any thread."""
        with self._latch:
            self._release_after = False
            self.context.world.stop()

    def release(self) -> None:
        """Lets the robot move again, on request: at once, or as soon as the turn that was stopped has ended.

        Within that turn the robot stays still, or the next attempt of what was stopped would begin by itself.
        """
        with self._latch:
            if self._at_work:
                self._release_after = self.opened.stop.pressed
            else:
                self.opened.stop.release()

    def _rest(self) -> None:
        """The turn has ended: a release that came within it counts from now on."""
        with self._latch:
            self._at_work = False
            if self._release_after:
                self._release_after = False
                self.opened.stop.release()


def _saved(write: Callable[..., None], *where: Any) -> None:
    """Writes; a disk that does not take it is told in one line."""
    import sqlite3

    try:
        write(*where)
    except sqlite3.Error as error:
        raise _told(error) from error


def _told(failure: BaseException) -> BaseException:
    """What could not be saved as one line with its mend; anything else as it is."""
    import sqlite3

    if isinstance(failure, sqlite3.Error):
        return EnvironmentFaultError(
            f"cannot save the conversation: {failure}; what was saved before is kept",
            mend="make room on the disk or set RAGVLM_HOME, then open the thread again",
        )
    return failure


def begin(instruction: str) -> dict[str, Any]:
    """The update of the state with which a turn begins."""
    return {"instruction": instruction, "said": "", "call": None, "calls": (), "times": None, "use": None}


def is_blank(text: str) -> bool:
    """Whether nothing can be seen of it: spaces, and characters without width or ink (Unicode Cf, Cc, Z*)."""
    return all(unicodedata.category(char)[0] in "CZ" for char in text)


def checked(instruction: str) -> str:
    """The instruction, if it can be one.

    Raises:
        BadInputError: it is no text, it is empty or says nothing that can be seen, or is longer than `MAX_INSTRUCTION`
            characters.
    """
    if not isinstance(instruction, str):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise BadInputError(f"the instruction is no text but {type(instruction).__name__}", where="instruction")
    text = instruction.strip()
    if is_blank(text):
        raise BadInputError("the instruction is empty", where="instruction")
    if len(instruction) > MAX_INSTRUCTION:
        raise BadInputError(
            f"{len(instruction)} characters are too many, at most {MAX_INSTRUCTION}", where="instruction"
        )
    return text
