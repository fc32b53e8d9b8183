"""Produces docs/measurements.md: every number the documentation claims about one grasp, by one command.

    python -m bench.measure                      # all sections (about twenty minutes on two cores)
    python -m bench.measure --sections loop,gates

Each section is a report that also runs alone; what is written names the commit, the date and the exact command. A
section that is not measured anew keeps its old text.
"""

from __future__ import annotations

import argparse
import datetime
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from kb.errors import BadInputError

ACCEPTANCE = 19000
"""First of the seeds that are looked at once (benchmark protocol, section 2)."""
TITLES = {
    "loop": "The whole loop: say it, and it is grasped",
    "perception": "Perception from two noisy RGB-D pictures",
    "scene_graph": "Scene graph and constraints",
    "diagnosis": "The robot's own diagnosis",
    "gates": "Calibration gates",
}


def command(section: str, folder: Path) -> tuple[list[str], Path]:
    """The command of a section and the markdown file that it writes."""
    text = folder / f"{section}.md"
    last = ACCEPTANCE + 9
    if section == "loop":
        return ["bench.loop_report", "--seeds", f"{ACCEPTANCE}-{last}", "--markdown", str(text)], text
    if section == "diagnosis":
        return ["bench.diagnosis_report", "--markdown", str(text)], text
    if section == "gates":
        return ["bench.gates", "--markdown", str(text)], text
    out = folder / section
    return [f"bench.{section}_report", "--out", str(out)], out / "summary.md"


def measure(section: str, folder: Path) -> str:
    """Runs one report and returns its text with the command that made it.

    Raises:
        BadInputError: the report ended with an error.
    """
    words, text = command(section, folder)
    done = subprocess.run([sys.executable, "-m", *words], check=False)
    if done.returncode != 0 or not text.exists():
        raise BadInputError(f"it ended with exit code {done.returncode}", where=words[0])
    shown = " ".join("DIR" if str(folder) in word else word for word in words)
    body = re.sub(r"^# .*\n+", "", text.read_text().strip())
    body = re.sub(r"^##", "###", body, flags=re.MULTILINE)
    return f"`python -m {shown}`, commit {commit()}, {datetime.date.today().isoformat()}\n\n{body}"


def commit() -> str:
    """Short name of the checked-out commit, or "unknown" outside a checkout."""
    done = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True, check=False)
    return done.stdout.strip() or "unknown"


def sections_of(text: str) -> dict[str, str]:
    """The bodies of the sections that a former run wrote."""
    found: dict[str, str] = {}
    for name, title in TITLES.items():
        match = re.search(
            rf"^## {re.escape(title)}\n(.*?)(?=^## (?:{'|'.join(map(re.escape, TITLES.values()))})\n|\Z)",
            text,
            re.MULTILINE | re.DOTALL,
        )
        if match:
            found[name] = match.group(1).strip()
    return found


def main(arguments: list[str] | None = None) -> int:
    """Entry point of `python -m bench.measure`."""
    parser = argparse.ArgumentParser(prog="python -m bench.measure", description="Writes docs/measurements.md.")
    parser.add_argument("--sections", default=",".join(TITLES), help="comma-separated")
    parser.add_argument("--out", type=Path, default=Path("docs/measurements.md"))
    given = parser.parse_args(arguments)
    wanted = given.sections.split(",")
    for name in wanted:
        if name not in TITLES:
            raise BadInputError(f'there is no section "{name}"', where="--sections", choices=TITLES)
    bodies = sections_of(given.out.read_text()) if given.out.exists() else {}
    head = "# Measurements\n\nWritten by `make measure`. Success is always the observer's word, from the true state.\n"
    with tempfile.TemporaryDirectory() as folder:
        for name in wanted:
            bodies[name] = measure(name, Path(folder))
            parts = [head, *(f"## {TITLES[key]}\n\n{bodies[key]}\n" for key in TITLES if key in bodies)]
            given.out.write_text("\n".join(parts))
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except BadInputError as error:
        sys.exit(f"measure: error: {error}")
