"""An agent as the faces use it: built from options, streamed from, stopped, asked for what it remembers."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from app import approve as approval

if TYPE_CHECKING:
    from agent.build_agent import Agent
    from agent.events import BaseStep
    from app.options import RunOptions
    from kb.rgbd import RgbdView
    from kb.run_result import RunResult
    from sim.world import World


class Session:
    """One agent in one world. Close it, or use it in a `with` statement."""

    def __init__(self, options: RunOptions, *, may_ask: bool = False) -> None:
        """Opens the world and builds the agent; nothing moves yet.

        Args:
            options: What to build.
            may_ask: Approval can be switched on later (a conversation); a single run asks only if its options say so.

        Raises:
            BadInputError: the scene or another choice cannot be used.
            EnvironmentFaultError: the machine cannot do it.
        """
        from agent import build_agent
        from app.learning import Learner, store_of

        self._learner = Learner(options) if options.learn else None
        self.asks = options.approve
        """Whether the person is asked before every motion."""
        if options.approve:
            approval.refuse_without_person()
        self._agent: Agent = build_agent(
            scene=options.scene,
            seed=options.seed,
            brain=options.brain,
            perception=options.perception,  # pyright: ignore[reportArgumentType]
            evaluator=options.evaluator,  # pyright: ignore[reportArgumentType]
            configuration=options.configuration,
            thread=options.thread,
            approve=self._decide if options.approve or may_ask else None,
            dry_run=options.dry_run,
            base_url=options.base_url,
            store=store_of(options) if self._learner is None else self._learner.store,
            embedder=options.embedder,
            learn=options.learn,
            record_brain=options.record_brain,
            brain_pictures=options.brain_pictures,
            aloud=True,
        )

    def __enter__(self) -> Session:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Stops the robot; nothing else is held."""
        self._agent.stop()

    @property
    def world(self) -> World:
        """The physical world, for pictures and videos only."""
        return self._agent.opened.world

    @property
    def place(self) -> str:
        """Scene and seed, in words."""
        return f"scene {self._agent.opened.scene}, seed {self._agent.opened.seed}"

    @property
    def unfinished(self) -> str | None:
        """The instruction that a killed process left unfinished in this thread."""
        return self._agent.interrupted

    @property
    def result(self) -> RunResult:
        """Result of the last run."""
        assert self._agent.result is not None
        return self._agent.result

    def views(self) -> tuple[RgbdView, ...]:
        """Pictures of the last look."""
        return self._agent.views

    def stream(self, words: str) -> Iterator[BaseStep]:
        """Carries out one instruction, yielding the steps as they happen."""
        for step in self._agent.stream(words):
            # A conversation is always able to ask; while approval is off, the question is not shown.
            if getattr(step, "kind", "") != "approval" or self.asks:
                yield step
        if self._learner is not None:
            yield from self._learner.after(self._agent)

    def stop(self) -> None:
        """Stops the robot, until `release`."""
        self._agent.stop()

    def release(self) -> None:
        """Lets the robot move again."""
        self._agent.release()

    def memory(self) -> tuple[Any, ...]:
        """What the episodic memory holds."""
        return tuple(getattr(self._agent.state.memory, "items", ()))

    def _decide(self, proposal: dict[str, Any]) -> dict[str, Any]:
        """The person's word, or consent while approval is off."""
        return approval.ask(proposal) if self.asks else {"verdict": "approve"}
