"""One line of trials.jsonl as it is written: a RunResult, and where in the benchmark it stands."""

from __future__ import annotations

from typing import NamedTuple

from pydantic import Field

from bench.job import Job, RowKey
from kb.run_result import RunResult


class RowLine(NamedTuple):
    """A finished row as it stands in the file, with what the runner asks of it.

    Text is what goes between processes: to take a row apart and put it together again there takes longer than to write it.
    """

    key: RowKey
    seed: int | None
    success: bool
    harness_error: str | None
    text: bytes
    """The row as JSON, without the end of the line."""

    @property
    def configuration(self) -> str:
        """Configuration that was run."""
        return self.key[0]

    @property
    def task(self) -> str:
        """Task that it was run on."""
        return self.key[1]

    @property
    def row(self) -> Row:
        """The row itself, read from the text."""
        return Row.model_validate_json(self.text)


class Row(RunResult):
    """The public result of a trial with its place in the benchmark (product.md, "Benchmark output")."""

    task: str
    repetition: int
    trial: int
    suite: str
    noise: float
    wall_s: float
    """Wall time of this trial in its worker [s]; what the trial shared with others counts for the first of them."""
    harness_error: str | None = None
    """What went wrong in the harness; such a trial is a failure, and counted apart from failed grasps."""
    bare_step_ratio: float | None = None
    """Processor time of the grasps over that of bare physics steps of the same number, where it was measured."""
    bare_step_wall_ratio: float | None = None
    """The same of wall times."""
    strict: bool | None = None
    """Success, and every grasp of it on the annotated region without violating a required constraint; None: not judged."""
    damage_limit_n: dict[str, float] = Field(default_factory=dict[str, float])
    """Force from which each object counts as damaged in this world [N]; the agent is not told."""
    shared_looks: int = 0
    """Looks whose percept an earlier configuration of the same trial had already computed."""
    shared_motions: int = 0
    """Motions that an earlier configuration of the same trial had already made from the very same state."""

    shared_steps: int = 0
    """Steps of the task graph that an earlier configuration, alike in all switches read so far, had already taken."""

    @property
    def key(self) -> RowKey:
        """What makes it unique."""
        return self.configuration, self.task, self.repetition, self.trial, self.noise

    @property
    def line(self) -> RowLine:
        """The row as it is written."""
        return RowLine(self.key, self.seed, self.success, self.harness_error, self.model_dump_json().encode())


def row_of(
    job: Job,
    result: RunResult,
    *,
    wall_s: float,
    bare_step_ratio: float | None = None,
    bare_step_wall_ratio: float | None = None,
    shared_looks: int = 0,
    shared_motions: int = 0,
    shared_steps: int = 0,
    strict: bool | None = None,
    damage_limit_n: dict[str, float] | None = None,
) -> Row:
    """The row of a trial that ran."""
    return Row(
        **dict(result),
        task=job.task.name,
        repetition=job.repetition,
        trial=job.trial,
        suite=job.task.suite,
        noise=job.noise,
        wall_s=round(wall_s, 6),
        bare_step_ratio=None if bare_step_ratio is None else round(bare_step_ratio, 4),
        bare_step_wall_ratio=None if bare_step_wall_ratio is None else round(bare_step_wall_ratio, 4),
        shared_looks=shared_looks,
        shared_motions=shared_motions,
        shared_steps=shared_steps,
        strict=strict,
        damage_limit_n=damage_limit_n or {},
    )


def error_row(job: Job, configuration: str, error: str, *, wall_s: float = 0.0) -> Row:
    """The row of a trial that the harness could not carry out."""
    return Row(
        instruction="",
        scene=job.task.scene,
        seed=job.seed,
        configuration=configuration,
        brain=job.settings.brain,
        perception=job.settings.perception,
        evaluator=job.settings.evaluator,
        executed=False,
        success=False,
        answer="",
        task=job.task.name,
        repetition=job.repetition,
        trial=job.trial,
        suite=job.task.suite,
        noise=job.noise,
        wall_s=round(wall_s, 6),
        harness_error=" ".join(error.split())[:500],
    )
