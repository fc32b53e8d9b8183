"""Runs one job in this process: one world, opened once, and each of its configurations from the very same state.

A configuration that fails to grasp is a result; one that raises is a harness error, recorded and counted apart.
"""

from __future__ import annotations

import gc
import itertools
import logging
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import lru_cache
from typing import Any

from bench.bare_ratio import MotionMeter
from bench.job import Job
from bench.mishaps import UnluckyRobot, changed_scene
from bench.row import Row, error_row, row_of
from bench.shared_walk import SharedWalk
from bench.shared_world import SharedWorld, SharingPerceiver
from bench.suite import instruction_of
from kb.errors import BadInputError, EnvironmentFaultError
from kb.run_result import RunResult, Timings

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
    shared.world.end()


@contextmanager
def _collected_after(job: Job) -> Iterator[None]:
    """Looks for garbage once at the end instead of every few hundred objects, which took a seventh of an analytic trial.

    Where nobody else looks for it (`tidied_here`), small worlds are cleared away several at a time.
    """
    _keep_what_stays(job.settings.embedder, job.settings.kb_url)
    alone = gc.isenabled()
    try:
        with tidied_here():
            yield
    finally:
        if alone or job.settings.evaluator != "analytic" or next(_finished) % TIDIED_EVERY == 0:
            gc.collect(1)


@contextmanager
def tidied_here() -> Iterator[None]:
    """Leaves looking for garbage to the jobs that are run inside."""
    was = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was:
            gc.enable()


TIDIED_EVERY = 32
"""Analytic jobs after which garbage is looked for: their worlds hold no pictures and take about a megabyte each."""
_finished = itertools.count(1)


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
        scene, mishap = job.task.scene, job.task.mishap
        self.instruction = instruction_of(scene, job.seed)
        change = changed_scene(mishap)
        self.world = SharedWorld.of(
            open_world(scene, job.seed, evaluator=job.settings.evaluator, noise=job.noise, change=change),
            rehearsed=job.settings.brain != "rules",
        )
        self.robot = self.world.actor
        if mishap is not None and change is None:
            self.robot = UnluckyRobot(self.robot, self.world.world, mishap)
        self._perceivers: dict[str, Any] = {}
        self._walk = SharedWalk()
        self._results: list[tuple[Any, RunResult, bool]] = []
        """States at the end of walks, with the result and whether it was a strict success."""

    def run(self, configuration: str, before: float) -> Row:
        """The row of one configuration; `before` is the time already spent on it [s]."""
        from agent import build_agent
        from agent.configuration import configuration as named

        began, settings, world = time.perf_counter(), self.job.settings, self.world
        # Every configuration begins at the same bits, the first one too.
        world.begin()
        looks, motions = world.shared_looks, world.shared_motions
        # A mishap changes the world on its own: the same steps cannot be made bare.
        meter = MotionMeter(self.robot, world.world, self.job.measure and self.job.task.mishap is None)
        world.actor = meter
        chosen = named(configuration)
        perception = chosen.perception or settings.perception
        agent = build_agent(
            scene=self.job.task.scene, seed=self.job.seed, brain=settings.brain, perception=settings.perception,
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
        result, strict = self._judged(state, context, configuration, perception, context.clock() - start)
        return row_of(
            self.job,
            result,
            wall_s=before + time.perf_counter() - began - meter.spent,
            bare_step_ratio=meter.ratio,
            bare_step_wall_ratio=meter.wall_ratio,
            shared_looks=world.shared_looks - looks,
            shared_motions=world.shared_motions - motions,
            shared_steps=self._walk.shared,
            strict=result.success and strict,
            damage_limit_n={
                thing.id: round(thing.damage_force, 3) for thing in world.placed.objects if not thing.fixed
            },
        )

    def _judged(
        self, state: Any, context: Any, configuration: str, perception: str, total: float
    ) -> tuple[RunResult, bool]:
        """The result of a walk that ended in `state`, and whether each successful grasp in it was a strict success.

        The observer's judgement of an end that an earlier configuration came to as well is taken over from there; names
        and times [s] are each one's own.
        """
        from agent.run_result import rounded, run_result, timings

        for end, result, strict in self._results:
            if result.perception == perception and _same_end(end, state):
                times = Timings.model_validate(rounded(timings(state, total).model_dump()))
                return result.model_copy(update={"configuration": configuration, "timings_s": times}), strict
        judge: Any = _NotingJudge(context.world.at(state.world).observer)
        result = run_result(
            state, judge, total=total, configuration=configuration,
            brain=context.brain.name, perception=perception, evaluator=self.job.settings.evaluator,
        )  # fmt: skip
        self._results.append((state, result, judge.strict))
        return result, judge.strict

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


def _same_end(one: Any, two: Any) -> bool:
    """Whether two states of a trial agree in all that a result says, times apart.

    What is large is the same if it is one and the same object, as it is after shared steps; the rest is compared.
    """
    if len(one.attempts) != len(two.attempts) or any(
        a is not b for a, b in zip(one.attempts, two.attempts, strict=True)
    ):
        return False
    if any(getattr(one, name) is not getattr(two, name) for name in ("percept", "graph", "shown")):
        return False
    told = ("turn", "executed", "refused", "answer", "question", "goals", "motions", "displaced", "world", "use")
    return all(getattr(one, name) == getattr(two, name) for name in told)


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
