"""Builds an agent for a scene: the world, the tools, the brain and the task graph around one conversation."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from agent.configuration import configuration as configuration_named
from agent.conversation import Agent, Approve
from kb.errors import BadInputError, EnvironmentFaultError
from kb.vocabulary import EvaluatorName, FailureType, PerceptionName

if TYPE_CHECKING:
    from agent.brain import Brain
    from agent.safety.limits import BrainLimits
    from kb.embedder import Embedder
    from kb.percept import PerceivedObject
    from memory import EpisodicMemory
    from tools.open_world import OpenedWorld

DEFAULT_SCENE = "single_cup"


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
    embedder: str | Embedder = "shape_colour",
    learn: bool = False,
    memory: EpisodicMemory | None = None,
    opened: OpenedWorld | None = None,
    perceiver: Any = None,
    base_url: str | None = None,
    record_brain: str | Path | None = None,
    brain_pictures: bool = True,
    brain_limits: BrainLimits | None = None,
    aloud: bool = False,
    graph: Callable[[Any], Any] | None = None,
) -> Agent:
    """An agent in a scene.

    Args:
        scene: built-in name or path of a scene file (default "single_cup"; of a known thread: its own).
        seed: everything random follows from it (default 0; of a known thread: its own).
        brain: "rules", "openai:MODEL", "hf:FOLDER", "replay:FILE", or a brain object.
        perception: "rgbd" from pixels, "vlm" with names from the brain, or "oracle".
        evaluator: "mujoco" or "analytic".
        configuration: a name from `agent.configuration`.
        thread: name under which the conversation is kept on disk, or None to forget it.
        threads: file that keeps threads (default: in the user's data folder).
        approve: asked before every motion.
        dry_run: understand, look and plan; move nothing.
        noise: scale of the uncertainties of the world.
        store: path of a knowledge base (file, or folder of a learning one), or an opened one (default: the shipped one).
        embedder: "shape_colour", "efficientnet", "clip:TAG" or "clip:FILE", or an opened one.
        learn: score experiences by the posterior of their outcomes; entering outcomes is up to the caller.
        memory: episodic memory from earlier sessions (scope "session").
        opened: a world that is open already, at its start (shared by the configurations of a trial).
        perceiver: replaces the perceiver (shared caches, tests).
        base_url: server of an "openai:" brain.
        record_brain: file that keeps the exchanges with a language model; what stands in it is not asked again.
        brain_pictures: whether a language model is sent pictures.
        brain_limits: calls, tokens and seconds that a language model may take for an instruction.
        aloud: tell what a language model says while it says it, as steps of kind "saying" between the others.
        graph: makes the graph from a checkpointer (default: the task graph alone).

    Raises:
        BadInputError: an unknown name, or a thread of another scene, seed or evaluator.
        EnvironmentFaultError: brain or perception that is not available here, or threads that cannot be kept.
    """
    from agent.checkpoint import default_threads, memory_saver, sqlite_saver
    from agent.context import AgentContext
    from agent.graph import compile_graph
    from agent.safety.limits import BrainLimits
    from agent.world_handle import WatchedRobot, WorldHandle
    from kb.open_embedder import open_embedder
    from tools.context import ToolContext
    from tools.open_world import open_perceiver, open_world

    chosen = configuration_named(configuration)
    seeing = chosen.perception or perception
    saver = memory_saver() if thread is None else sqlite_saver(Path(threads) if threads else default_threads())
    compiled = (graph or compile_graph)(saver)
    kept = _kept(compiled, thread)
    scene, seed = _same_world(kept, scene, seed, thread)
    opened = opened or open_world(scene, seed, evaluator=evaluator, noise=noise)
    stop = opened.stop
    thinker = (
        brain_named(
            brain, base_url, seed=seed, record=record_brain, pictures=brain_pictures, stopped=lambda: stop.pressed
        )
        if isinstance(brain, str)
        else brain
    )
    _refuse_nameless(seeing, thinker)
    seer = open_embedder(embedder) if isinstance(embedder, str) else embedder
    tools = ToolContext(
        robot=WatchedRobot(opened.robot),
        store=_store(store, seer),
        perceiver=perceiver or open_perceiver(seeing, opened, seer),
        embedder=seer,
        switches=chosen.switches.model_copy(update={"learn": True}) if learn else chosen.switches,
        stop=opened.stop,
    )
    context = AgentContext(
        tools=tools, brain=thinker, world=WorldHandle(opened), scene=scene, seed=seed, approve=approve is not None,
        dry_run=dry_run, oracle_failure=_oracle(opened) if chosen.switches.diagnosis == "oracle_phi" else None,
        clock=time.perf_counter, start_memory=memory, names_objects=seeing == "vlm",
        limits=brain_limits or BrainLimits(), aloud=aloud,
    )  # fmt: skip
    names = {"configuration": configuration, "brain": thinker.name, "perception": seeing, "evaluator": evaluator}
    return Agent(context, compiled, names, thread=thread, approve=approve)


def _refuse_nameless(perception: str, brain: Brain) -> None:
    """Names from a picture need a brain that sees.

    Raises:
        EnvironmentFaultError: "vlm" with the rules brain.
    """
    if perception == "vlm" and brain.name == "rules":
        raise EnvironmentFaultError(
            "perception 'vlm' needs a vision-language model",
            mend="add --brain openai:MODEL or --brain hf:FOLDER, or use --perception rgbd",
        )


def _kept(compiled: Any, thread: str | None) -> dict[str, Any]:
    """The state in which the thread was left; empty for a new one.

    Raises:
        EnvironmentFaultError: the file of threads is damaged.
    """
    import sqlite3

    try:
        return compiled.get_state({"configurable": {"thread_id": thread or "here"}}).values
    except sqlite3.Error as error:
        raise EnvironmentFaultError(
            f"cannot read the thread {thread!r}: {error}", mend="take another --thread, or import a copy of the session"
        ) from error


def _same_world(kept: dict[str, Any], scene: str | None, seed: int | None, thread: str | None) -> tuple[str, int]:
    """Scene and seed: as asked, as the thread knows them, or the defaults.

    Raises:
        BadInputError: a negative seed, or the thread belongs to another scene or seed.
    """
    if seed is not None and seed < 0:
        raise BadInputError(f"the seed {seed} is negative", where="seed", choices=("0 and above",))
    if not kept.get("scene"):
        return scene or DEFAULT_SCENE, seed or 0
    known_scene, known_seed = str(kept["scene"]), int(kept["seed"])
    if scene not in (None, known_scene) or seed not in (None, known_seed):
        raise BadInputError(
            f"thread {thread!r} is in scene {known_scene!r} with seed {known_seed}; use another thread for another world",
            where="thread",
        )
    return known_scene, known_seed


def _store(store: Any, embedder: Embedder) -> Any:
    """The opened knowledge base, with the vectors of the session's embedder.

    Raises:
        EnvironmentFaultError: it cannot be read, or was embedded otherwise and has no reference views.
    """
    if store is not None and not isinstance(store, str | Path):
        return store
    from kb.embed_store import embedded_store
    from kb.learned import open_any

    return embedded_store(open_any(None if store is None else Path(store)), embedder)


def _oracle(opened: OpenedWorld) -> Callable[[int, PerceivedObject], FailureType | None]:
    """The evaluator's own label of a motion: only for the configuration that is told why it failed (ledger G41)."""

    def failure(motion: int, target: PerceivedObject) -> FailureType | None:
        meant = opened.observer.meant(target.category, target.position, motion)
        return opened.observer.judge(motion, meant).failure

    return failure


def brain_named(
    name: str,
    base_url: str | None = None,
    *,
    seed: int = 0,
    record: str | Path | None = None,
    pictures: bool = True,
    stopped: Callable[[], bool] = lambda: False,
) -> Brain:
    """The brain of that name.

    Args:
        name: "rules", "openai:MODEL", "hf:FOLDER" or "replay:FILE".
        base_url: server of an "openai:" brain.
        seed: the waits between trials follow from it.
        record: file in which exchanges are kept; what stands in it already is not asked again.
        pictures: whether an "openai:" brain is sent pictures.
        stopped: whether a person wants everything to end.

    Raises:
        BadInputError: unknown name.
        EnvironmentFaultError: a language model that is not available here.
    """
    if name == "rules":
        from agent.brains.rules import RulesBrain

        return RulesBrain()
    from agent.brains.model import ModelBrain
    from agent.brains.named import chat_named

    return ModelBrain(chat_named(name, base_url, seed=seed, record=record, pictures=pictures, stopped=stopped))
