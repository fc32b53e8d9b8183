"""`ragvlm run`: runs the task graph once and prints Thought, Action and Observation as they happen."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from app import flags
from app.with_options import with_options

if TYPE_CHECKING:
    from app.options import RunOptions


@with_options(flags.SINGLE_RUN)
def run(
    instruction: Annotated[str, typer.Argument(metavar="INSTRUCTION", help="What the robot is to do, in your words.")],
    options: RunOptions,
) -> None:
    """Tell the robot one thing; it looks, reasons, grasps, and says how it went."""
    from app.running import run_once

    raise typer.Exit(run_once(instruction, options))
