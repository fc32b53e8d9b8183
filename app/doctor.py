"""Checks of the machine, each with its mend: what `ragvlm doctor` prints."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from app.exit_codes import ACHIEVED, ENVIRONMENT


@dataclass(frozen=True)
class Finding:
    """What one check found."""

    ok: bool
    says: str
    mend: str = ""
    optional: bool = False
    """A failure of this check leaves the default options working."""


@dataclass(frozen=True)
class Check:
    """One check: its name, what to do if it raises, and the check itself."""

    name: str
    mend: str
    run: Callable[[], Finding]
    optional: bool = False


REINSTALL = "reinstall the core packages: pip install --force-reinstall agentic-rag-vlm"


def run_checks(*, json_output: bool) -> int:
    """Runs all checks, prints each as it ends, and returns the exit code: 3 if one that matters failed."""
    from app import doctor_checks as checks
    from app.console import make_console

    listing = (
        Check("python", "use Python 3.11, 3.12 or 3.13", checks.python),
        Check("packages", REINSTALL, checks.packages),
        Check("kinematics", REINSTALL, checks.kinematics),
        Check("reach", REINSTALL, checks.reach),
        Check("cameras", REINSTALL, checks.cameras),
        Check("hold", REINSTALL, checks.hold),
        Check("grip", REINSTALL, checks.grip),
        Check("pictures", "apt install libosmesa6, or libegl1 libegl-mesa0 libgl1-mesa-dri", checks.pictures),
        Check("video", "apt install ffmpeg", checks.video, optional=True),
        Check("knowledge base", "restore kb/data/experiences.jsonl, or ragvlm kb build", checks.knowledge_base),
        Check("state folder", "set RAGVLM_HOME to a folder of yours", checks.state_folder),
        Check("models", "pip install 'agentic-rag-vlm[models]'", checks.models, optional=True),
    )
    console = make_console()
    rows: list[dict[str, Any]] = []
    for check in listing:
        start = time.perf_counter()
        finding = _guarded(check)
        taken = time.perf_counter() - start
        rows.append({"check": check.name, "ok": finding.ok, "says": finding.says, "mend": finding.mend,
                     "optional": check.optional or finding.optional})  # fmt: skip
        if not json_output:
            _print(console, check, finding, taken)
    failed = [row for row in rows if not row["ok"] and not row["optional"]]
    if json_output:
        sys.stdout.write(json.dumps(rows, indent=2) + "\n")
    else:
        console.print(f"{len(failed)} to mend" if failed else "everything that matters works")
    return ENVIRONMENT if failed else ACHIEVED


def _guarded(check: Check) -> Finding:
    """The check's finding; whatever it raises is a finding too."""
    try:
        return check.run()
    except Exception as error:
        return Finding(False, f"{type(error).__name__}: {' '.join(str(error).split())[:200]}", check.mend)


def _print(console: Any, check: Check, finding: Finding, taken: float) -> None:
    from rich.text import Text

    mild = check.optional or finding.optional
    word, style = ("ok", "green") if finding.ok else (("no", "yellow") if mild else ("FAIL", "bold red"))
    line = Text(f"{word:<5}", style=style)
    line.append(f"{check.name:<16}", style="bold")
    line.append(f"{finding.says} ")
    line.append(f"({taken:.1f} s)", style="dim")
    console.print(line)
    if finding.mend:
        console.print(Text(f"     mend: {finding.mend}", style="yellow" if not finding.ok else "dim"))
