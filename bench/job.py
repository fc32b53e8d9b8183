"""What is to be run: a plan for the whole benchmark, and its jobs, each one world with the configurations that see it."""

from __future__ import annotations

from collections.abc import Collection
from itertools import product
from typing import Annotated

from pydantic import Field

from bench.suite import BenchTask, seed_of
from kb.base import Finite, Noun
from kb.vocabulary import EvaluatorName, PerceptionName

RowKey = tuple[str, str, int, int, float]
"""Configuration, task, repetition, trial, noise: what makes a row unique."""


MAX_NOISE = 3.0
"""Largest scale of the uncertainties."""
MAX_TRIALS = 1000
"""Most trials of a repetition: more would meet the seeds of the next one."""


class Settings(Noun):
    """What all rows of one folder have in common: rows that differ in these can't stand in one table."""

    seed: int = Field(default=20_000, ge=0)
    evaluator: EvaluatorName = "mujoco"
    perception: PerceptionName = "rgbd"
    brain: str = "rules"
    base_url: str | None = None
    record_brain: str | None = None
    """File that keeps a language model's replies, so that all configurations see the same ones (ledger G45)."""
    embedder: str = "shape_colour"
    """What looks are compared by (`kb.open_embedder`)."""
    kb_url: str | None = None
    """Chroma server with the knowledge base; None for the shipped one."""


class BenchPlan(Noun):
    """Everything that decides which trials are run."""

    settings: Settings = Field(default_factory=Settings)
    tasks: tuple[BenchTask, ...]
    configurations: tuple[str, ...]
    trials: int = Field(default=30, ge=1, le=MAX_TRIALS)
    """Trials per repetition."""
    repetitions: int = Field(default=1, ge=1)
    noises: tuple[Annotated[Finite, Field(ge=0.0, le=MAX_NOISE)], ...] = (1.0,)
    """Scales of the uncertainties; one world and one row for each."""
    measure_all: bool = False
    """Measure the bare-step ratio in every trial, not only in the first of each task."""

    @property
    def rows(self) -> int:
        """Number of rows that the finished benchmark has."""
        return len(self.tasks) * len(self.configurations) * self.trials * self.repetitions * len(self.noises)


class Job(Noun):
    """One world, and the configurations that still have to be run in it."""

    settings: Settings
    task: BenchTask
    configurations: tuple[str, ...]
    repetition: int
    trial: int
    seed: int
    noise: float
    measure: bool = False
    """Measure the bare-step ratio."""

    def key(self, configuration: str) -> RowKey:
        """Key of one of its rows."""
        return configuration, self.task.name, self.repetition, self.trial, self.noise


def jobs(plan: BenchPlan, done: Collection[RowKey] = ()) -> list[Job]:
    """The jobs of a plan less the rows that are done, repetition by repetition and trial by trial.

    Tasks alternate fastest, so that a run that is stopped early has something of every task.
    """
    found: list[Job] = []
    for repetition, trial, task, noise in product(range(plan.repetitions), range(plan.trials), plan.tasks, plan.noises):
        job = Job(
            settings=plan.settings,
            task=task,
            configurations=plan.configurations,
            repetition=repetition,
            trial=trial,
            seed=seed_of(plan.settings.seed, repetition, trial),
            noise=noise,
            measure=plan.measure_all or (repetition == 0 and trial == 0),
        )
        missing = tuple(name for name in plan.configurations if job.key(name) not in done)
        if missing:
            found.append(job.model_copy(update={"configurations": missing}))
    return found
