"""`ragvlm tools`: the tools of the agent and the JSON schemas of what goes in and out."""

from __future__ import annotations

import json
from typing import Annotated, Optional

import typer


def tools(
    schema: Annotated[
        Optional[str],  # noqa: UP045
        typer.Option("--schema", metavar="NAME", help="Print one schema: RunResult, or a tool's name."),
    ] = None,
    names: Annotated[bool, typer.Option("--names", help="Print names and purposes instead of schemas.")] = False,
) -> None:
    """Print the JSON schemas of the tools' arguments, or one schema by name."""
    from app.schemas import result_schema, tool_schemas

    if schema is not None:
        typer.echo(json.dumps(result_schema(schema), indent=2))
        return
    found = tool_schemas()
    if names:
        from app.console import make_console
        from app.table import print_table

        print_table(
            make_console(), ("tool", "what it does"), [(name, row["description"]) for name, row in found.items()]
        )
        return
    typer.echo(json.dumps(found, indent=2))
