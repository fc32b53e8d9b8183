"""Tables: drawn with lines on a terminal, tab-separated in a pipe."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console


def print_table(console: Console, header: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Prints rows under a header. In a pipe: one line a row, tabs between, the header first."""
    if not console.is_terminal:
        for row in (header, *rows):
            # Written past rich, which turns tabs into spaces.
            console.file.write("\t".join(row) + "\n")
        return
    from rich import box
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for number, title in enumerate(header):
        table.add_column(title, style="bold" if number == 0 else None, overflow="fold")
    for row in rows:
        table.add_row(*row)
    console.print(table)
