"""Looks at a recorded run again."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.force_trace import force_lines
from app.record import FORCES, RESULT, TRACE
from app.steps import LABELS, WIDTH
from app.verdict_block import print_verdict
from kb.errors import BadInputError

if TYPE_CHECKING:
    from rich.console import Console


def show_record(console: Console, folder: Path, *, forces: bool = True) -> None:
    """Prints the steps, the verdict, the forces and the files of a record.

    Raises:
        BadInputError: not a record, or a damaged one.
    """
    from pydantic import ValidationError
    from rich.text import Text

    from kb.run_result import RunResult

    if not folder.is_dir():
        raise BadInputError("there is no such folder", where=str(folder))
    if not (folder / RESULT).is_file() and not (folder / TRACE).is_file():
        raise BadInputError(f"it holds no record (no {RESULT}, no {TRACE}); --record makes one", where=str(folder))
    for row in _rows(folder / TRACE):
        label, style = LABELS.get(row.get("kind", ""), ("Step", "bold"))
        line = Text(f"{label:<{WIDTH}}", style=style)
        line.append(str(row.get("text", "")), style="default")
        console.print(line)
    if (folder / RESULT).is_file():
        try:
            result = RunResult.model_validate_json((folder / RESULT).read_text(encoding="utf-8"))
        except (ValidationError, ValueError) as error:
            raise BadInputError("it is not a result of this version", where=str(folder / RESULT)) from error
        console.print(Text(f'"{result.instruction}" in {result.scene}, seed {result.seed}', style="dim"))
        print_verdict(console, result)
    else:
        console.print("the run did not end: there is no result")
    if forces and (folder / FORCES).is_file():
        width = console.width if console.is_terminal else 100
        for line in force_lines(_json(folder / FORCES), width):
            console.print(Text(line))
    console.print(Text("files", style="bold"))
    for path in sorted(path for path in folder.rglob("*") if path.is_file()):
        console.print(Text(f"  {path}  {_size(path.stat().st_size)}"))


def _rows(path: Path) -> list[dict[str, Any]]:
    """The steps of the trace; a last line that was cut off (a killed run) is left out."""
    rows: list[dict[str, Any]] = []
    if not path.is_file():
        return rows
    lines = path.read_text(encoding="utf-8").splitlines()
    for number, line in enumerate(lines, start=1):
        try:
            rows.append(json.loads(line))
        except json.JSONDecodeError as error:
            if number == len(lines):
                break
            raise BadInputError("it is not JSON", where=f"{path}, line {number}") from error
    return rows


def _json(path: Path) -> Any:
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except json.JSONDecodeError as error:
        raise BadInputError(f"it is not JSON (line {error.lineno})", where=str(path)) from error


def _size(count: int) -> str:
    return f"{count / 1e6:.1f} MB" if count >= 1e6 else f"{count / 1e3:.1f} kB" if count >= 1e3 else f"{count} bytes"
