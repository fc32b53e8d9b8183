"""`python -m bench.report DIR`: writes the report of a run again, or of several runs together."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from bench.report.learning import read_learning
from bench.report.results import Results
from bench.report.results_page import results_page
from bench.report.write_report import Extras, read_retrieval, write_report
from bench.trial import Key, Trial, read_trials
from kb.errors import BadInputError


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line of the report."""
    parser = argparse.ArgumentParser(prog="python -m bench.report", description="Writes the report of a run.")
    parser.add_argument("folder", type=Path, nargs="+", help="folder with trials.jsonl; several are put together")
    parser.add_argument("--analytic", type=Path, help="folder of the same trials with --evaluator analytic")
    parser.add_argument("--retrieval", type=Path, help="file of `ragvlm kb eval --json`")
    parser.add_argument("--learning", type=Path, help="folder of `python -m bench.learn_study`")
    parser.add_argument("--out", type=Path, help="where to write (default: the first folder)")
    parser.add_argument(
        "--results", type=Path, help="also write this page (docs/results.md) with its figures beside it"
    )
    given = parser.parse_args(arguments)
    try:
        trials = together(given.folder)
        if len({trial.evaluator for trial in trials}) > 1:
            raise BadInputError("trials of different evaluators cannot stand in one table; use --analytic")
        analytic = read_trials(given.analytic / "trials.jsonl") if given.analytic else ()
        retrieval = read_retrieval(given.retrieval) if given.retrieval else None
        sources = (*given.folder, *((given.analytic,) if given.analytic else ()))
        study = read_learning(given.learning) if given.learning else None
        extras = Extras(analytic=analytic, retrieval=retrieval, learning=study, folders=sources)
        files = write_report(trials, given.out or given.folder[0], extras)
        if given.results:
            files = results_page(
                Results(trials), given.folder, given.results, analytic=analytic, analytic_folder=given.analytic,
                retrieval=retrieval, learning=study,
            )  # fmt: skip
    except (BadInputError, OSError, ValueError) as error:
        parser.error(str(error))
    sys.stdout.write(f"{files[0]}\n")
    return 0


def together(folders: Sequence[Path]) -> list[Trial]:
    """The trials of several folders, each trial once.

    Raises:
        BadInputError: a folder without trials, or one and the same trial with different outcomes.
    """
    found: dict[Key, Trial] = {}
    for folder in folders:
        for trial in read_trials(folder / "trials.jsonl"):
            if trial.key in found and found[trial.key].success != trial.success:
                raise BadInputError(
                    f"trial {trial.key} stands in two folders with different outcomes", where=str(folder)
                )
            found.setdefault(trial.key, trial)
    return list(found.values())


if __name__ == "__main__":
    sys.exit(main())
