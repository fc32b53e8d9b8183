"""Builds an agent for a scene: the world, the tools, the brain and the task graph around one conversation."""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from agent.configuration import configuration as configuration_named
from kb.errors import BadInputError, EnvironmentFaultError
from kb.vocabulary import EvaluatorName, PerceptionName

if TYPE_CHECKING:
    from agent.brain import Brain
    from agent.events import BaseStep
    from agent.state import State
    from kb.run_result import RunResult
    from memory import EpisodicMemory
    from tools.open_world import OpenedWorld

MAX_INSTRUCTION = 10_000
"""Longest instruction [characters]."""
STEP_LIMIT = 4_000
"""Graph steps per instruction: far above what twelve objects with four attempts each need (about 600)."""
DEFAULT_SCENE = "single_cup"

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
    def interrupted(self) -> str | None:
        """The instruction that a killed process left unfinished in this thread, or None."""
        snapshot = self._graph.get_state(self._config)
        return snapshot.values.get("instruction") if snapshot.next else None

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
            entry: Any = None if self.interrupted == text else {"instruction": text, "times": {}}
            while entry is not False:
                yield from self._steps(entry)
                entry = yield from self._decide()
            self.result = self._result(self.context.clock() - start)
        finally:
            self.context.emit = lambda _step: None
            self._running.release()

    def _steps(self, entry: Any) -> Iterator[BaseStep]:
        """Runs the graph in a thread of its own until it ends or waits, and yields its steps."""
        told: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self.context.emit = told.put
        failures: list[BaseException] = []

        def work() -> None:
            try:
                self._graph.invoke(entry, self._config, context=self.context, durability=self._durability)
            except BaseException as error:
                failures.append(error)
            finally:
                told.put(None)

        worker = threading.Thread(target=work, name="ragvlm-graph", daemon=True)
        worker.start()
        try:
            while (step := told.get()) is not None:
                yield step
        except BaseException:
            self.stop()
            worker.join()
            raise
        worker.join()
        if failures:
            raise failures[0]

    def _decide(self) -> Iterator[BaseStep]:
        """Where the graph waits for a person: asks, and returns the command that goes on; False if it does not wait."""
        from langgraph.types import Command

        from agent.events import Approval
        from kb.sensing import Plan

        waiting = [item for task in self._graph.get_state(self._config).tasks for item in task.interrupts]
        if not waiting:
            return False  # pyright: ignore[reportReturnType]
        proposal = waiting[0].value
        plan = Plan.model_validate(proposal["plan"])
        yield Approval(text="May I do this?", goal=proposal["goal"], plan=plan)
        decision = self._approve(proposal) if self._approve is not None else {"verdict": "reject"}
        return Command(resume=decision)  # pyright: ignore[reportReturnType]

    def _result(self, total: float) -> RunResult:
        from agent.run_result import run_result

        return run_result(self.state, self.opened.observer, total=total, **self._names)

    # Stopping ----------------------------------------------------------------------------------------------------

    def stop(self) -> None:
        """Stops the robot and latches: nothing moves until `release`. May be called from any thread."""
        self.opened.stop.press()

    def release(self) -> None:
        """Lets the robot move again, on request."""
        self.opened.stop.release()


def checked(instruction: str) -> str:
    """The instruction, if it can be one.

    Raises:
        BadInputError: it is empty, or longer than `MAX_INSTRUCTION` characters.
    """
    text = instruction.strip()
    if not text:
        raise BadInputError("the instruction is empty", where="instruction")
    if len(instruction) > MAX_INSTRUCTION:
        raise BadInputError(
            f"{len(instruction)} characters are too many, at most {MAX_INSTRUCTION}", where="instruction"
        )
    return text


def build_agent(
    scene: str | None = None,
    seed: int | None = None,
    *,
    brain: str | Brain = "rules",
    perception: PerceptionName = "rgbd",
    evaluator: EvaluatorName = "mujoco",
    configuration: str = "full",
    thread: str | None = None,
    threads: str | Path | None = None,
    approve: Approve | None = None,
    dry_run: bool = False,
    noise: float = 1.0,
    store: Any = None,
    memory: EpisodicMemory | None = None,
    opened: OpenedWorld | None = None,
    perceiver: Any = None,
    base_url: str | None = None,
) -> Agent:
    """An agent in a scene.

    Args:
        scene: built-in name or path of a scene file (default "single_cup"; of a known thread: its own).
        seed: everything random follows from it (default 0; of a known thread: its own).
        brain: "rules", or a brain object.
        perception: "rgbd" from pixels, or "oracle".
        evaluator: "mujoco" or "analytic".
        configuration: a name from `agent.configuration`.
        thread: name under which the conversation is kept on disk, or None to forget it.
        threads: file that keeps threads (default: in the user's data folder).
        approve: asked before every motion.
        dry_run: understand, look and plan; move nothing.
        noise: scale of the uncertainties of the world.
        store: path of a knowledge base, or an opened one (default: the shipped one).
        memory: episodic memory from earlier sessions (scope "session").
        opened: a world that is open already, at its start (shared by the configurations of a trial).
        perceiver: replaces the perceiver (shared caches, tests).
        base_url: server of an "openai:" brain.

    Raises:
        BadInputError: an unknown name, or a thread of another scene, seed or evaluator.
        EnvironmentFaultError: brain or perception that is not available here, or threads that cannot be kept.
    """
    from agent.checkpoint import default_threads, memory_saver, sqlite_saver
    from agent.context import AgentContext
    from agent.graph import compile_graph
    from agent.world_handle import WatchedRobot, WorldHandle
    from kb.shape_colour import ShapeColourEmbedder
    from tools.context import ToolContext
    from tools.open_world import open_perceiver, open_world

    chosen = configuration_named(configuration)
    thinker = brain_named(brain, base_url) if isinstance(brain, str) else brain
    seeing = chosen.perception or perception
    saver = memory_saver() if thread is None else sqlite_saver(Path(threads) if threads else default_threads())
    graph = compile_graph(saver)
    kept = graph.get_state({"configurable": {"thread_id": thread or "here"}}).values
    scene, seed = _same_world(kept, scene, seed, thread)
    opened = opened or open_world(scene, seed, evaluator=evaluator, noise=noise)
    embedder = ShapeColourEmbedder()
    tools = ToolContext(
        robot=WatchedRobot(opened.robot),
        store=_store(store),
        perceiver=perceiver or open_perceiver(seeing, opened, embedder),
        embedder=embedder,
        switches=chosen.switches,
        stop=opened.stop,
    )
    context = AgentContext(
        tools=tools, brain=thinker, world=WorldHandle(opened), scene=scene, seed=seed, approve=approve is not None,
        dry_run=dry_run, oracle_failure=_oracle(opened) if chosen.switches.diagnosis == "oracle_phi" else None,
        clock=time.perf_counter, start_memory=memory,
    )  # fmt: skip
    names = {"configuration": configuration, "brain": thinker.name, "perception": seeing, "evaluator": evaluator}
    return Agent(context, graph, names, thread=thread, approve=approve)


def _same_world(kept: dict[str, Any], scene: str | None, seed: int | None, thread: str | None) -> tuple[str, int]:
    """Scene and seed: as asked, as the thread knows them, or the defaults.

    Raises:
        BadInputError: the thread belongs to another scene or seed.
    """
    if not kept.get("scene"):
        return scene or DEFAULT_SCENE, seed or 0
    known_scene, known_seed = str(kept["scene"]), int(kept["seed"])
    if scene not in (None, known_scene) or seed not in (None, known_seed):
        raise BadInputError(
            f"thread {thread!r} is in scene {known_scene!r} with seed {known_seed}; use another thread for another world",
            where="thread",
        )
    return known_scene, known_seed


def _store(store: Any) -> Any:
    if store is None or isinstance(store, str | Path):
        from kb.store import ExperienceStore

        return ExperienceStore.open(store)
    return store


def _oracle(opened: OpenedWorld) -> Callable[[int], Any]:
    """The evaluator's own label of a motion: only for the configuration that is told why it failed (ledger G41)."""
    return lambda motion: opened.observer.judge(motion, None).failure


def brain_named(name: str, base_url: str | None = None) -> Brain:
    """The brain of that name.

    Raises:
        BadInputError: unknown name.
        EnvironmentFaultError: a language model that is not available here.
    """
    del base_url
    if name == "rules":
        from agent.brains.rules import RulesBrain

        return RulesBrain()
    if name.startswith(("openai:", "hf:")):
        raise EnvironmentFaultError(f"brain {name!r} is not available in this version", mend="use --brain rules")
    raise BadInputError(f"unknown brain {name!r}", choices=("rules", "openai:MODEL", "hf:MODEL_OR_FOLDER"))
