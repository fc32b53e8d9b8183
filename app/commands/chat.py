"""`ragvlm chat`: a conversation with the robot in the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

import typer

from app import flags
from app.with_options import with_options

if TYPE_CHECKING:
    from app.options import RunOptions


@with_options(flags.CONVERSATION)
def chat(options: RunOptions) -> None:
    """Talk with the robot: it remembers what was said and done. /help lists the commands."""
    from app.chat import chat as converse

    raise typer.Exit(converse(options))
