"""Draws the five figures of the documentation from real runs.

python -m bench.figures [--out docs/images] [NAME ...]
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from bench.figures import (
    graph_to_constraints,
    loop_with_escalation,
    qualitative_traces,
    retrieval_funnel,
    system_overview,
)
from kb.errors import EnvironmentFaultError

FIGURES: dict[str, Callable[[Path], Path]] = {
    "system_overview": system_overview.draw,
    "retrieval_funnel": retrieval_funnel.draw,
    "graph_to_constraints": graph_to_constraints.draw,
    "loop_with_escalation": loop_with_escalation.draw,
    "qualitative_traces": qualitative_traces.draw,
}
"""Name of the file -> what draws it."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line: draws all figures, or those named."""
    parser = argparse.ArgumentParser(prog="python -m bench.figures", description="Draws the figures from real runs.")
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(FIGURES)} (default: all)")
    parser.add_argument("--out", type=Path, default=Path("docs/images"))
    given = parser.parse_args(arguments)
    unknown = [name for name in given.names if name not in FIGURES]
    if unknown:
        parser.error(f'unknown figure "{unknown[0]}" (valid: {", ".join(FIGURES)})')
    for name in given.names or FIGURES:
        start = time.perf_counter()
        try:
            path = FIGURES[name](given.out / f"{name}.png")
        except EnvironmentFaultError as error:
            sys.stderr.write(f"{name}: {error}\n")
            return error.exit_code
        sys.stdout.write(f"{path}  {path.stat().st_size // 1000} kB, {time.perf_counter() - start:.0f} s\n")
        sys.stdout.flush()
    return 0


if __name__ == "__main__":
    sys.exit(main())
