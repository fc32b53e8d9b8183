"""What `ragvlm kb eval` does: measures retrieval and writes what was found."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, get_args

from kb.errors import BadInputError

if TYPE_CHECKING:
    from bench.kb_eval.study import Study

QUICK_RESAMPLES = 200


def evaluate_retrieval(
    store: Path | None, *, embedders: str, splits: str, quick: bool, json_file: str | None, out: Path | None,
    executed: Path | None, workers: int, again: bool,
) -> None:  # fmt: skip
    """Runs the evaluation with progress on standard error and prints its main table.

    Raises:
        BadInputError: an unknown split or embedder, or files that cannot be written.
    """
    from app.console import make_console
    from app.files import refuse_unwritable_file
    from bench.kb_eval.query import VIEWS, Split
    from bench.kb_eval.report import as_json
    from bench.kb_eval.study import Wanted, study

    wanted = tuple(word.strip() for word in splits.split(",") if word.strip())
    for word in wanted or (splits,):
        if word not in get_args(Split):
            raise BadInputError(f'"{word}" is not a choice', where="--splits", choices=get_args(Split))
    if json_file not in (None, "-"):
        refuse_unwritable_file(Path(json_file or ""), where="--json")
    if out is not None:
        _make_folder(out)
    console = make_console(stderr=True)

    def told(done: int, total: int, what: str) -> None:
        if done % 20 == 0 or done == total:
            console.print(f"{done}/{total} {what}", markup=False)

    found = study(
        Wanted(
            store=store, embedders=tuple(word.strip() for word in embedders.split(",") if word.strip()),
            splits=tuple(split for split in get_args(Split) if split in wanted), views=1 if quick else VIEWS,
            execute=not quick, executed=executed, workers=workers,
            again=again, resamples=QUICK_RESAMPLES if quick else 2000,
        ),
        told,
    )  # fmt: skip
    text = json.dumps(as_json(found), indent=2)
    if out is not None:
        _write_report(found, text, out)
        console.print(f"report in {out / 'report.html'}", markup=False)
    if json_file == "-":
        print(text)
        return
    if json_file is not None:
        Path(json_file).write_text(text + "\n", encoding="utf-8")
    _print_table(found)


def _make_folder(out: Path) -> None:
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise BadInputError(f"cannot make the folder {out}: {error.strerror}", where="--out") from error


def _write_report(found: Study, text: str, out: Path) -> None:
    from bench.kb_eval.report import html, markdown

    (out / "summary.json").write_text(text + "\n", encoding="utf-8")
    (out / "tables.md").write_text(markdown(found) + "\n", encoding="utf-8")
    (out / "report.html").write_text(html(found), encoding="utf-8")


def _print_table(found: Study) -> None:
    from app.console import make_console
    from app.table import print_table
    from bench.kb_eval.report import COLUMNS, findings, table_of

    console = make_console()
    for part in found.parts:
        table = table_of(part, found)
        console.print(table.title, markup=False)
        rows = [tuple(str(cell) for cell in row) for row in table.rows]
        print_table(console, ("system", *(word for _, word in COLUMNS)), rows)
    for finding in findings(found):
        console.print(f"{finding.mark}: {finding.words}", markup=False)
