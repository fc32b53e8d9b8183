"""`ragvlm doctor`: checks the machine and says the mend for each failure."""

from __future__ import annotations

from typing import Annotated

import typer


def doctor(
    json_output: Annotated[bool, typer.Option("--json", help="Print the checks as JSON.")] = False,
) -> None:
    """Check cameras, pictures, physics, knowledge base and models; say the mend for each failure."""
    from app.doctor import run_checks

    raise typer.Exit(run_checks(json_output=json_output))
