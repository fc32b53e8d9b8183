"""`ragvlm objects`: the catalogue of objects that scene files may use."""

from __future__ import annotations

from typing import Annotated

import typer


def objects(
    json_output: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """List the objects that scene files may use."""
    from app.catalogue_rows import catalogue_rows
    from app.console import make_console
    from app.table import print_table

    rows = catalogue_rows()
    if json_output:
        import json

        typer.echo(json.dumps(rows, indent=2))
        return
    print_table(
        make_console(),
        ("model", "group", "category", "affordance", "material", "fragility", "region", "size mm", "mass g"),
        [
            (
                row["model"],
                row["group"],
                row["category"],
                row["affordance"],
                row["material"],
                f"{row['fragility']:.2f}",
                row["region"],
                " x ".join(f"{side * 1000:.0f}" for side in row["size_m"]),
                f"{row['mass_kg'] * 1000:.0f}",
            )
            for row in rows
        ],
    )
