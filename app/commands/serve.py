"""`ragvlm serve`: the conversation on a web page with the live 3D robot."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from app import flags
from app.with_options import with_options

if TYPE_CHECKING:
    from app.options import RunOptions


@with_options(flags.CONVERSATION)
def serve(
    options: RunOptions,
    port: Annotated[int, typer.Option("--port", min=0, max=65535, metavar="N", help="Port; 0 takes any.")] = 8080,
    host: Annotated[str, typer.Option("--host", metavar="ADDRESS", help="Address to listen on.")] = "127.0.0.1",
    allow_remote: Annotated[
        bool, typer.Option("--allow-remote", help="Allow a --host that other machines can reach.")
    ] = False,
) -> None:
    """Talk with the robot on a web page: live 3D view, approval, forces, memory, and a stop that latches."""
    from app.web.serve import serve as serve_page

    raise typer.Exit(serve_page(options, host=host, port=port, allow_remote=allow_remote))
