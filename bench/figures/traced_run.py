"""A real run kept for drawing: its result, its steps, what the cameras showed, and the motion."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from kb.errors import EnvironmentFaultError
from kb.percept import Percept
from kb.rgbd import RgbdView
from kb.run_result import RunResult
from kb.sensing import Phase
from sim.picture import FINE, PictureMaker
from sim.placed import PlacedScene
from sim.video import Moment, MotionSampler
from sim.viewpoint import Viewpoint

Picture = NDArray[np.uint8]
T = TypeVar("T")

CLOSE_UP = Viewpoint(eye=(1.30, -0.78, 0.58), target=(0.46, 0.02, 0.17), fovy=33.0)
"""The table and the hand, for frames."""


def known(value: T | None) -> T:
    """A value that the run must have left.

    Raises:
        ValueError: it left none.
    """
    if value is None:
        raise ValueError("the run lacks what the figure shows")
    return value


@dataclass(frozen=True)
class TracedRun:
    """One run of the agent, with all that a figure needs of it."""

    result: RunResult
    steps: Sequence[Any]
    """Steps of the agent in order (`agent.events`)."""
    looks: Sequence[tuple[RgbdView, Percept]]
    """Front camera and percept of each look."""
    moments: Sequence[Moment]
    placed: PlacedScene

    def of_kind(self, kind: str) -> list[Any]:
        """Steps of one kind, in order."""
        return [step for step in self.steps if step.kind == kind]

    def moment(self, motion: int, phase: Phase, share: float = 1.0) -> Moment:
        """A moment of a phase of a motion; `share` 0 is its beginning, 1 its end.

        Raises:
            ValueError: the motion has no such phase.
        """
        own = [moment for moment in self.moments if moment.motion == motion and moment.phase == phase]
        if not own:
            known = sorted({(m.motion, m.phase) for m in self.moments})
            raise ValueError(f"motion {motion} has no phase {phase}: {known}")
        return own[round(share * (len(own) - 1))]

    def grasps(self) -> list[int]:
        """Numbers of the motions in which the hand went to grasp, in order."""
        return list(dict.fromkeys(moment.motion for moment in self.moments if moment.phase == "approach"))

    def has(self, motion: int, phase: Phase) -> bool:
        """Whether the motion came to that phase."""
        return any(moment.motion == motion and moment.phase == phase for moment in self.moments)

    def last_of(self, motion: int, *phases: Phase, share: float = 1.0) -> Moment:
        """A moment of the first of these phases that the motion came to.

        Raises:
            ValueError: it came to none of them.
        """
        reached: list[Phase] = [phase for phase in phases if self.has(motion, phase)]
        return self.moment(motion, reached[0] if reached else phases[-1], share)

    def frames(
        self, moments: Sequence[Moment], viewpoint: Viewpoint = CLOSE_UP, size: tuple[int, int] = (560, 420)
    ) -> list[Picture]:
        """Pictures of moments, by the project's ray-cast painter."""
        with PictureMaker(self.placed, "raycast") as maker:
            return [maker.picture(moment.qpos, viewpoint, *size, FINE) for moment in moments]


def trace(scene: str, seed: int, instruction: str) -> TracedRun:
    """Runs the agent as `ragvlm run` does, and keeps what happens."""
    from agent import build_agent
    from agent.events import Look

    agent = build_agent(scene=scene, seed=seed)
    sampler = MotionSampler()
    agent.opened.world.recorders.append(sampler)
    steps: list[Any] = []
    looks: list[tuple[RgbdView, Percept]] = []
    for step in agent.stream(instruction):
        steps.append(step)
        if isinstance(step, Look):
            front = next(view for view in agent.views if view.name == "front")
            looks.append((front, step.percept))
    if agent.result is None:
        raise RuntimeError(f"the run in {scene} ended without a result")
    return TracedRun(agent.result, steps, looks, sampler.moments, agent.opened.placed)


def first_run(
    scene: str, instruction: str, wanted: Callable[[RunResult], bool], *, seed: int = 10_000, most: int = 40
) -> TracedRun:
    """The first run from a seed on that shows what a figure is about.

    Args:
        scene: Name or file of the scene.
        instruction: What the agent is asked.
        wanted: Whether a result shows it.
        seed: First seed; those from 10000 on are for tuning and showing, never for the benchmark.
        most: Seeds after which the search ends.

    Raises:
        EnvironmentFaultError: no run shows it.
    """
    for number in range(seed, seed + most):
        run = trace(scene, number, instruction)
        if wanted(run.result):
            return run
    raise EnvironmentFaultError(
        f"none of the seeds {seed} to {seed + most - 1} of {scene} shows what the figure is about",
        mend="choose another scene for the figure",
    )


def levels_tried(result: RunResult) -> list[list[bool]]:
    """For each goal that was attempted: the observer's word on its attempts."""
    return [[attempt.success for attempt in goal.attempts] for goal in result.goals if goal.attempts]


def understood(result: RunResult) -> bool:
    """The robot judged and diagnosed each of its attempts as the observer did."""
    return all(
        attempt.claimed == attempt.success and attempt.failure == attempt.observed_failure
        for goal in result.goals
        for attempt in goal.attempts
    )
