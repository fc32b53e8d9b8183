"""Runs one job in this process: one world, opened once, and each of its configurations from the very same state.

A configuration that fails to grasp is a result; one that raises is a harness error, recorded and counted apart.
"""

from __future__ import annotations

import gc
import logging
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import lru_cache
from typing import Any

from bench.bare_ratio import MotionMeter
from bench.job import Job
from bench.row import Row, error_row, row_of
from bench.shared_walk import SharedWalk
from bench.shared_world import SharedWorld, SharingPerceiver
from bench.suite import instruction_of
from kb.errors import BadInputError, EnvironmentFaultError

log = logging.getLogger(__name__)


def run_job(job: Job) -> Iterator[Row]:
    """One row per configuration, each as soon as it is finished. Raises nothing but what stops the process."""
    with _collected_after(job):
        yield from _rows(job)


def _rows(job: Job) -> Iterator[Row]:
    start = time.perf_counter()
    try:
        shared = _Shared(job)
    except Exception as error:
        log.debug("the world of %s seed %d cannot be opened", job.task.name, job.seed, exc_info=True)
        for configuration in job.configurations:
            yield error_row(job, configuration, _said(error), wall_s=time.perf_counter() - start)
        return
    for configuration in job.configurations:
        try:
            row = shared.run(configuration, time.perf_counter() - start)
        except Exception as error:
            log.debug("%s failed", job.key(configuration), exc_info=True)
            row = error_row(job, configuration, _said(error), wall_s=time.perf_counter() - start)
        yield row
        start = time.perf_counter()


@contextmanager
def _collected_after(job: Job) -> Iterator[None]:
    """Looks for garbage once at the end instead of every few hundred objects, which took a seventh of an analytic trial."""
    _keep_what_stays(job.settings.embedder, job.settings.kb_url)
    was = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was:
            gc.enable()
        gc.collect(1)


@lru_cache(maxsize=1)
def _keep_what_stays(embedder: str, kb_url: str | None) -> None:
    """Takes modules and the knowledge base, which stay until the process ends, out of all searches for garbage.

    What cannot be opened is said by the job that needs it.
    """
    with suppress(BadInputError, EnvironmentFaultError):
        opened_store(embedder, kb_url)
    gc.collect()
    gc.freeze()


def _said(error: Exception) -> str:
    return f"{type(error).__name__}: {error}"


@lru_cache(maxsize=1)
def _embedder(name: str) -> Any:
    """The embedder of that name, opened once a process."""
    from kb.open_embedder import open_embedder

    return open_embedder(name)


@lru_cache(maxsize=1)
def opened_store(embedder: str, kb_url: str | None) -> Any:
    """The shipped knowledge base or a server's, read once a process with the embedder's vectors; nothing writes to it.

    Raises:
        BadInputError: there is no such embedder, or the address is none.
        EnvironmentFaultError: the embedder's packages or weights are missing, or the server cannot be reached.
    """
    from kb.chroma_server import read_server
    from kb.embed_store import embedded_store
    from kb.store import ExperienceStore

    return embedded_store(ExperienceStore.open(None) if kb_url is None else read_server(kb_url), _embedder(embedder))


class _Shared:
    """The world of a job, and what its configurations have in common."""

    def __init__(self, job: Job) -> None:
        from tools.open_world import open_world

        self.job = job
        self.instruction = instruction_of(job.task.name, job.seed)
        self.world = SharedWorld.of(
            open_world(job.task.name, job.seed, evaluator=job.settings.evaluator, noise=job.noise)
        )
        self.robot = self.world.actor
        self._perceivers: dict[str, Any] = {}
        self._walk = SharedWalk()

    def run(self, configuration: str, before: float) -> Row:
        """The row of one configuration; `before` is the time already spent on it [s]."""
        from agent import build_agent
        from agent.configuration import configuration as named
        from agent.run_result import run_result

        began, settings, world = time.perf_counter(), self.job.settings, self.world
        # Every configuration begins at the same bits, the first one too.
        world.begin()
        looks, motions = world.shared_looks, world.shared_motions
        meter = MotionMeter(self.robot, world.world, self.job.measure)
        world.actor = meter
        chosen = named(configuration)
        perception = chosen.perception or settings.perception
        agent = build_agent(
            scene=self.job.task.name, seed=self.job.seed, brain=settings.brain, perception=settings.perception,
            evaluator=settings.evaluator, configuration=configuration, noise=self.job.noise, base_url=settings.base_url,
            record_brain=settings.record_brain,
            opened=world, perceiver=self._perceiver(perception),
            store=opened_store(settings.embedder, settings.kb_url), embedder=_embedder(settings.embedder),
        )  # fmt: skip
        context = agent.context
        context.clock = world.clock
        if not context.guarded:
            # Rules execute the plan itself: nobody would look at the others.
            context.tools.alternatives = 0
        start = context.clock()
        kind = (perception, chosen.switches.diagnosis)
        state = self._walk.run(context, self.instruction, kind, world.credit)
        judge: Any = _NotingJudge(context.world.at(state.world).observer)
        result = run_result(
            state, judge, total=context.clock() - start, configuration=configuration,
            brain=context.brain.name, perception=perception, evaluator=settings.evaluator,
        )  # fmt: skip
        return row_of(
            self.job,
            result,
            wall_s=before + time.perf_counter() - began - meter.spent,
            bare_step_ratio=meter.ratio,
            bare_step_wall_ratio=meter.wall_ratio,
            shared_looks=world.shared_looks - looks,
            shared_motions=world.shared_motions - motions,
            shared_steps=self._walk.shared,
            strict=result.success and judge.strict,
            damage_limit_n={
                thing.id: round(thing.damage_force, 3) for thing in world.placed.objects if not thing.fixed
            },
        )

    def _perceiver(self, name: Any) -> SharingPerceiver:
        """The perceiver of that name, made once."""
        from tools.open_world import open_perceiver

        settings = self.job.settings
        self.world.blind = name == "oracle" and settings.evaluator == "analytic"
        if name not in self._perceivers:
            if self.world.blind:
                from bench.blind_look import BlindOracle

                oracle = open_perceiver(name, self.world, None)
                perceiver: Any = BlindOracle(
                    oracle, self.world.placed, opened_store(settings.embedder, settings.kb_url), self.job.seed
                )
            else:
                perceiver = open_perceiver(name, self.world, _embedder(settings.embedder))
            self._perceivers[name] = SharingPerceiver(perceiver, name, self.world)
        return self._perceivers[name]


class _NotingJudge:
    """The observer, with a note of whether every successful grasp that it judged was a strict success."""

    def __init__(self, observer: Any) -> None:
        self._observer = observer
        self.strict = True

    def judge(self, *args: Any, **kwargs: Any) -> Any:
        """As `sim.observer.Observer.judge`."""
        seen = self._observer.judge(*args, **kwargs)
        if seen.success and seen.verdict.placed is None:
            self.strict = self.strict and bool(seen.strict)
        return seen

    def __getattr__(self, name: str) -> Any:
        return getattr(self._observer, name)
