"""`ragvlm chat`: a conversation with the robot in the terminal."""

from __future__ import annotations

import typer

from app import flags


def chat(
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
    config: flags.Config = None,
) -> None:
    """Talk with the robot: it remembers what was said and done. /help lists the commands."""
    from app.chat import chat as converse
    from app.options import known_configurations, resolve_options

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
    }
    raise typer.Exit(converse(resolve_options(given, config, known_configurations())))
