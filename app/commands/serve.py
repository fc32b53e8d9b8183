"""`ragvlm serve`: the conversation on a web page with the live 3D robot."""

from __future__ import annotations

from typing import Annotated

import typer

from app import flags


def serve(
    port: Annotated[int, typer.Option("--port", min=0, max=65535, metavar="N", help="Port; 0 takes any.")] = 8080,
    host: Annotated[str, typer.Option("--host", metavar="ADDRESS", help="Address to listen on.")] = "127.0.0.1",
    allow_remote: Annotated[
        bool, typer.Option("--allow-remote", help="Allow a --host that other machines can reach.")
    ] = False,
    scene: flags.Scene = None,
    seed: flags.Seed = None,
    brain: flags.Brain = None,
    base_url: flags.BaseUrl = None,
    perception: flags.Perception = None,
    evaluator: flags.Evaluator = None,
    configuration: flags.Configuration = None,
    approve: flags.Approve = None,
    dry_run: flags.DryRun = None,
    thread: flags.Thread = None,
    config: flags.Config = None,
) -> None:
    """Talk with the robot on a web page: live 3D view, approval, forces, memory, and a stop that latches."""
    from app.options import known_configurations, resolve_options
    from app.web.serve import serve as serve_page

    given = {
        "scene": scene,
        "seed": seed,
        "brain": brain,
        "base_url": base_url,
        "perception": perception,
        "evaluator": evaluator,
        "configuration": configuration,
        "approve": approve,
        "dry_run": dry_run,
        "thread": thread,
    }
    options = resolve_options(given, config, known_configurations())
    raise typer.Exit(serve_page(options, host=host, port=port, allow_remote=allow_remote))
