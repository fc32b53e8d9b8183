"""`ragvlm bench`: runs the benchmark, resumes it, and writes its report."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Optional

import typer

from app import flags

PLAN = "What is run"

Text = Optional[str]  # noqa: UP045
Whole = Optional[int]  # noqa: UP045


def bench(
    tasks: Annotated[
        Text,
        typer.Option(
            "--tasks", metavar="NAMES", help="Tasks or groups of them (default: the twelve).", rich_help_panel=PLAN
        ),
    ] = None,
    configs: Annotated[
        Text,
        typer.Option(
            "--configs", metavar="NAMES", help="Configurations, or paper or all (default: full).", rich_help_panel=PLAN
        ),
    ] = None,
    trials: Annotated[int, typer.Option("--trials", metavar="N", help="Trials a cell.", rich_help_panel=PLAN)] = 30,
    repetitions: Annotated[
        int, typer.Option("--repetitions", metavar="N", help="Repetitions with other seeds.", rich_help_panel=PLAN)
    ] = 1,
    suite: Annotated[
        str, typer.Option("--suite", metavar="NAME", help="tasks, clutter, ood or mishaps.", rich_help_panel=PLAN)
    ] = "tasks",
    noise: Annotated[
        str,
        typer.Option(
            "--noise",
            metavar="X",
            help="Scale of the uncertainties, 0 to 3; several for a curve.",
            rich_help_panel=PLAN,
        ),
    ] = "1",
    seed: Annotated[
        Whole,
        typer.Option(
            "--seed",
            metavar="N",
            help="First seed; everything random follows from it (default: 20000, the evaluation's).",
            rich_help_panel=flags.WORLD,
        ),
    ] = None,
    brain: flags.Brain = None,
    base_url: flags.BaseUrl = None,
    record_brain: flags.RecordBrain = None,
    perception: flags.Perception = None,
    evaluator: flags.Evaluator = None,
    embedder: flags.Embedder = None,
    kb_url: flags.KbUrl = None,
    workers: Annotated[Whole, typer.Option("--workers", metavar="N", help="Processes (default: one a core).")] = None,
    dask: Annotated[
        Text, typer.Option("--dask", metavar="ADDRESS", help="Scheduler of a cluster that runs the trials.")
    ] = None,
    out: Annotated[
        Path, typer.Option("--out", metavar="DIR", help="Output folder.", rich_help_panel=flags.OUTPUT)
    ] = Path("runs/bench"),
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with the trials in the folder.", rich_help_panel=flags.OUTPUT)
    ] = False,
    profile: Annotated[
        bool, typer.Option("--profile", help="Print where the time went.", rich_help_panel=flags.OUTPUT)
    ] = False,
    json_file: flags.Json = None,
    config: flags.Config = None,
) -> None:
    """Run every task in every configuration with the same worlds, and write the tables."""
    from app.benchmark import BenchRequest, run_bench

    shared = {
        "seed": seed,
        "brain": brain,
        "base_url": base_url,
        "record_brain": record_brain,
        "perception": perception,
        "evaluator": evaluator,
        "embedder": embedder,
        "kb_url": kb_url,
        "json": json_file,
    }
    request = BenchRequest(
        tasks=tasks,
        configurations=configs,
        trials=trials,
        repetitions=repetitions,
        suite=suite,
        noise=noise,
        workers=workers,
        dask=dask,
        out=out,
        resume=resume,
        profile=profile,
    )
    raise typer.Exit(run_bench(request, shared, config))
