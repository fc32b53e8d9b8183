"""`ragvlm show DIR`: looks at a recorded run again."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def show(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="A folder written by --record.")],
    forces: Annotated[bool, typer.Option("--forces/--no-forces", help="Show how the forces went.")] = True,
) -> None:
    """Look at a recorded run again: steps, verdict, forces, files."""
    from app.console import make_console
    from app.show import show_record

    show_record(make_console(), folder, forces=forces)
