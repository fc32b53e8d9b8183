"""`ragvlm run`: runs the task graph once and prints Thought, Action and Observation as they happen."""

from __future__ import annotations

from typing import Annotated

import typer

from app import flags


def run(
    instruction: Annotated[str, typer.Argument(metavar="INSTRUCTION", help="What the robot is to do, in your words.")],
    scene: flags.Scene = None,
    seed: flags.Seed = None,
    brain: flags.Brain = None,
    base_url: flags.BaseUrl = None,
    brain_pictures: flags.BrainPictures = None,
    record_brain: flags.RecordBrain = None,
    perception: flags.Perception = None,
    evaluator: flags.Evaluator = None,
    configuration: flags.Configuration = None,
    embedder: flags.Embedder = None,
    kb: flags.Kb = None,
    kb_url: flags.KbUrl = None,
    learn: flags.Learn = None,
    approve: flags.Approve = None,
    dry_run: flags.DryRun = None,
    thread: flags.Thread = None,
    json_file: flags.Json = None,
    record: flags.Record = None,
    config: flags.Config = None,
) -> None:
    """Tell the robot one thing; it looks, reasons, grasps, and says how it went."""
    from app.options import known_configurations, resolve_options
    from app.running import run_once

    given = {
        "scene": scene,
        "seed": seed,
        "brain": brain,
        "base_url": base_url,
        "brain_pictures": brain_pictures,
        "record_brain": record_brain,
        "perception": perception,
        "evaluator": evaluator,
        "configuration": configuration,
        "embedder": embedder,
        "kb": kb,
        "kb_url": kb_url,
        "learn": learn,
        "approve": approve,
        "dry_run": dry_run,
        "thread": thread,
        "json": json_file,
        "record": record,
    }
    raise typer.Exit(run_once(instruction, resolve_options(given, config, known_configurations())))
