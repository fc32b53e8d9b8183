"""`python -m bench.report DIR`: writes the report of a run again, or of several runs together."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from bench.report.write_report import Extras, read_retrieval, write_report
from bench.trial import read_trials
from kb.errors import BadInputError


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line of the report."""
    parser = argparse.ArgumentParser(prog="python -m bench.report", description="Writes the report of a run.")
    parser.add_argument("folder", type=Path, nargs="+", help="folder with trials.jsonl; several are put together")
    parser.add_argument("--analytic", type=Path, help="folder of the same trials with --evaluator analytic")
    parser.add_argument("--retrieval", type=Path, help="file of `ragvlm kb eval --json`")
    parser.add_argument("--out", type=Path, help="where to write (default: the first folder)")
    given = parser.parse_args(arguments)
    try:
        trials = [trial for folder in given.folder for trial in read_trials(folder / "trials.jsonl")]
        if len({trial.evaluator for trial in trials}) > 1:
            raise BadInputError("trials of different evaluators cannot stand in one table; use --analytic")
        analytic = read_trials(given.analytic / "trials.jsonl") if given.analytic else ()
        retrieval = read_retrieval(given.retrieval) if given.retrieval else None
        files = write_report(trials, given.out or given.folder[0], Extras(analytic=analytic, retrieval=retrieval))
    except (BadInputError, OSError, ValueError) as error:
        parser.error(str(error))
    sys.stdout.write(f"{files[0]}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
