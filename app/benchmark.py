"""`ragvlm bench` behind its command line: checks what was asked, shows the progress, writes summary and report."""

from __future__ import annotations

import os
import shlex
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.console import make_console
from app.exit_codes import ACHIEVED, INTERRUPTED, NOT_ACHIEVED
from kb.errors import BadInputError

if TYPE_CHECKING:
    from bench.job import BenchPlan
    from bench.row import RowLine

DEFAULT_SEED = 20_000
"""First seed of the evaluation range (benchmark section 2)."""
MAX_WORKERS = 1024
LINE_EVERY_S = 15.0
"""In a pipe, a line of progress at most this often [s]."""


@dataclass(frozen=True)
class BenchRequest:
    """What was typed, besides the options that all commands share."""

    tasks: str | None
    configurations: str | None
    trials: int
    repetitions: int
    suite: str
    noise: str
    workers: int | None
    dask: str | None
    out: Path
    resume: bool
    profile: bool


def run_bench(request: BenchRequest, shared: Mapping[str, Any], config: Path | None) -> int:
    """Runs the benchmark and returns the exit code: 1 if the harness failed in any trial, 130 if interrupted.

    Args:
        request: The options of `bench`.
        shared: The options that it shares with `run`; None where one was not given.
        config: TOML file, or None.

    Raises:
        BadInputError: an option that cannot be used; nothing has been written then.
        EnvironmentFaultError: the machine or the cluster cannot do it.
    """
    from app.options import known_configurations, resolve_options
    from bench.runner import run_benchmark

    options = resolve_options(shared, config, known_configurations())
    if options.json not in (None, "-"):
        from app.files import refuse_unwritable_file

        refuse_unwritable_file(Path(str(options.json)), where="--json")
    plan, workers = make_plan(request, options), _workers(request.workers)
    if request.out.exists() and not request.out.is_dir():
        raise BadInputError(f"{request.out} is a file, a folder is wanted", where="--out")
    if options.embedder != "shape_colour" or options.kb_url is not None:
        from bench.run_job import opened_store

        opened_store(options.embedder, options.kb_url)  # what is missing is said before anything is written
    progress = Progress(to_stderr=options.json == "-")
    try:
        with progress:
            outcome = run_benchmark(
                plan, request.out, workers=workers, dask=request.dask, resume=request.resume, command=_typed(),
                on_start=progress.start, on_row=progress.step,
            )  # fmt: skip
    except KeyboardInterrupt:
        print(f"ragvlm: interrupted; go on with the same command and --resume ({request.out})", file=sys.stderr)
        return INTERRUPTED
    from bench.report import write_outputs

    progress.console.print(f"ran {outcome.ran} trials; writing the report")
    summary = write_outputs(request.out)
    _say_results(progress.console, request, summary)
    if options.json == "-":
        sys.stdout.write(summary.to_json())
    elif options.json is not None:
        from app.files import write_atomically

        write_atomically(Path(options.json), summary.to_json())
    return NOT_ACHIEVED if any(cell.harness_errors for cell in summary.cells) else ACHIEVED


def make_plan(request: BenchRequest, options: Any) -> BenchPlan:
    """The plan of what was asked.

    Raises:
        BadInputError: unknown names, or numbers out of range.
    """
    from bench.job import MAX_NOISE, MAX_TRIALS, BenchPlan, Settings
    from bench.suite import CLUTTER_SCENES, MISHAP_SUITE, tasks_of

    if options.learn or options.kb:
        what = "the benchmark uses the shipped knowledge base as it is; learning is measured by `python -m bench.learn_study`"
        raise BadInputError(what, where="--config")
    if request.suite == MISHAP_SUITE and options.evaluator == "analytic":
        raise BadInputError("mishaps happen in physics alone", where="--evaluator", choices=("mujoco",))
    most = CLUTTER_SCENES if request.suite == "clutter" else MAX_TRIALS
    trials = min(request.trials, most) if request.suite == "clutter" else request.trials
    _within("--trials", trials, 1, most)
    _within("--repetitions", request.repetitions, 1, 1000)
    noises = tuple(_number(word) for word in _names(request.noise, "--noise"))
    for value in noises:
        _within("--noise", value, 0.0, MAX_NOISE)
    return BenchPlan(
        settings=Settings(
            seed=DEFAULT_SEED if options.seed is None else options.seed, brain=options.brain, base_url=options.base_url,
            perception=options.perception, evaluator=options.evaluator, record_brain=options.record_brain,
            embedder=options.embedder, kb_url=options.kb_url,
        ),
        tasks=tasks_of(request.suite, None if request.tasks is None else _names(request.tasks, "--tasks")),
        configurations=_configurations(request.configurations),
        trials=trials,
        repetitions=request.repetitions,
        noises=tuple(dict.fromkeys(noises)),
        measure_all=request.profile,
    )  # fmt: skip


def _configurations(text: str | None) -> tuple[str, ...]:
    """The configurations that were asked for; the words for several are choices, too."""
    from agent.configuration import CONFIGURATIONS, names_of

    words = _names(text or "full", "--configs")
    for word in words:
        if word not in (*CONFIGURATIONS, "paper", "all"):
            choices = (*CONFIGURATIONS, "paper", "all")
            raise BadInputError(f'unknown configuration "{word}"', where="--configs", choices=choices)
    return names_of(words)


def _names(text: str, where: str) -> list[str]:
    """The parts of a comma-separated list."""
    names = [name.strip() for name in text.split(",") if name.strip()]
    if not names:
        raise BadInputError("it is empty", where=where)
    return names


def _number(word: str) -> float:
    try:
        return float(word)
    except ValueError:
        raise BadInputError(f'"{word}" is no number', where="--noise", choices=("0 to 3",)) from None


def _within(where: str, value: float, low: float, high: float) -> None:
    if not low <= value <= high:
        raise BadInputError(f"{value:g} is out of range", where=where, choices=(f"{low:g} to {high:g}",))


def _workers(asked: int | None) -> int:
    if asked is None:
        return max(1, len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1)
    _within("--workers", asked, 1, MAX_WORKERS)
    return asked


def _typed() -> str:
    """The command line as it was typed."""
    return "ragvlm " + shlex.join(sys.argv[1:])


def _say_results(console: Any, request: BenchRequest, summary: Any) -> None:
    """Counts by configuration, and where the files are."""
    for name in dict.fromkeys(cell.configuration for cell in summary.cells):
        own = [cell for cell in summary.cells if cell.configuration == name]
        good, count = sum(cell.successes for cell in own), sum(cell.n for cell in own)
        errors = sum(cell.harness_errors for cell in own)
        broken = f", {errors} harness errors" if errors else ""
        console.print(f"{name}: {good} of {count} ({100 * good / count:.1f} %){broken}")
    if request.profile:
        from bench.profile import profile_text

        console.print(profile_text(request.out))
    files = sorted(path.name for path in request.out.iterdir() if not path.name.startswith("."))
    console.print(f"{request.out}: {', '.join(files)}")


class Progress:
    """A bar with the time left on a terminal, plain lines in a pipe."""

    def __init__(self, *, to_stderr: bool) -> None:
        self.console = make_console(stderr=to_stderr)
        self._bar: Any = None
        self._line: Any = None
        self._began = time.monotonic()
        self._first = 0
        self._told = -LINE_EVERY_S

    def __enter__(self) -> Progress:
        return self

    def start(self, done: int, rows: int, repaired: Sequence[str]) -> None:
        """Says what is there already, and begins."""
        for sentence in repaired:
            print(f"ragvlm: warning: {sentence}", file=sys.stderr)
        if done:
            self.console.print(f"{done} of {rows} trials are there")
        self._began, self._first = time.monotonic(), done
        if self.console.is_terminal:
            from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
            from rich.progress import Progress as Bar

            columns = (
                BarColumn(),
                MofNCompleteColumn(),
                TimeElapsedColumn(),
                TextColumn("left"),
                TimeRemainingColumn(),
            )
            self._bar = Bar(*columns, TextColumn("{task.description}"), console=self.console)
            self._line = self._bar.add_task("", total=rows, completed=done)
            self._bar.start()

    def step(self, done: int, rows: int, row: RowLine) -> None:
        """One more row."""
        word = "harness error" if row.harness_error else "success" if row.success else "failure"
        if row.harness_error:
            print(f"ragvlm: warning: {row.key}: {row.harness_error}", file=sys.stderr)
        last = f"{row.configuration} {row.task} {row.seed}: {word}"
        if self._bar is not None:
            self._bar.update(self._line, completed=done, description=last)
            return
        now = time.monotonic()
        if now - self._told < LINE_EVERY_S and done < rows:
            return
        self._told = now
        left = (now - self._began) / max(1, done - self._first) * (rows - done)
        self.console.print(f"{done}/{rows} {last}, {left:.0f} s left")

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.stop()
