"""How well the rules brain understands commands that its parser was not made for.

    python -m bench.language_report

`tests/agent/corpus/reported.txt` was written before the parser was run on it. The SHA-256 of a command decides its half: even
first byte, its failures may be looked at and mended (tuning); odd, only the count is reported. `references.txt` holds tables
with things on them, and references that mean one of them, several (which is asked back), or none.
"""

from __future__ import annotations

import argparse
import hashlib
import re
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from agent.brain import Situation
from agent.brains.rules import RulesBrain
from agent.language.notation import noted
from agent.language.resolve import Scope, resolve
from kb.base import Noun
from kb.percept import PerceivedObject, Percept
from kb.priors import prior

CORPUS = Path(__file__).parent.parent / "tests" / "agent" / "corpus" / "reported.txt"
GENERIC = re.compile(r"\b(?:object|item|one|something|anything|everything|stuff)\b")
"""Nouns that say nothing about the thing: one word in the comparison."""
INTO_THE_BIN = re.compile(r"^place (\S+\*.* >bin)$")
"""Putting several things into the bin is clearing them."""
COLOURS = {
    "red": (0.85, 0.1, 0.1), "blue": (0.1, 0.2, 0.85), "green": (0.2, 0.7, 0.2), "yellow": (0.95, 0.85, 0.1),
    "white": (0.95, 0.95, 0.95), "black": (0.05, 0.05, 0.05), "brown": (0.5, 0.32, 0.18),
}  # fmt: skip
SIZES: dict[str, tuple[float, float, float]] = {
    "small": (0.05, 0.05, 0.06), "medium": (0.07, 0.07, 0.09), "big": (0.10, 0.10, 0.14),
}  # fmt: skip


class Count(Noun):
    """How many of how many."""

    right: int = 0
    total: int = 0
    missed: tuple[str, ...] = ()

    def plus(self, ok: bool, line: str) -> Count:
        """The count after one more case."""
        return Count(right=self.right + ok, total=self.total + 1, missed=self.missed if ok else (*self.missed, line))


def measure_commands(corpus: Path) -> tuple[Count, Count]:
    """Commands understood exactly: (tuning half, reported half)."""
    halves = [Count(), Count()]
    brain = RulesBrain()
    for said, expected in rows(corpus):
        got = normal(noted(brain.understand(Situation(instruction=said))))
        half = hashlib.sha256(said.encode()).digest()[0] % 2
        halves[half] = halves[half].plus(got == normal(expected), f"{said!r}: {expected!r}, got {got!r}")
    return halves[0], halves[1]


def measure_references(corpus: Path) -> tuple[Count, Count, Count]:
    """References on given tables: (ambiguous ones asked back, single ones found, absent ones said)."""
    counts = [Count(), Count(), Count()]
    brain = RulesBrain()
    for left, expected in rows(corpus):
        table, said = (part.strip() for part in left.split("|"))
        objects = tuple(_thing(i, text.split()) for i, text in enumerate(table.split(";")))
        scope = Scope(percept=Percept(look=0, perception="rgbd", objects=objects))
        goals = brain.understand(Situation(instruction=said)).goals
        ids = resolve(goals[0].reference, scope).ids if goals and goals[0].reference is not None else ("?",)
        got = "ask" if len(ids) > 1 else "absent" if not ids else ids[0].removeprefix("obj_")
        kind = {"ask": 0, "absent": 2}.get(expected, 1)
        counts[kind] = counts[kind].plus(got == expected, f"{left}: {expected}, got {got}")
    return counts[0], counts[1], counts[2]


def rows(corpus: Path) -> Iterator[tuple[str, str]]:
    """The commands of a corpus with what each means."""
    for line in corpus.read_text(encoding="utf-8").splitlines():
        if line and line[0] != "#":
            said, expected = line.rsplit(" => ", 1)
            yield said, expected


def normal(text: str) -> str:
    """A meaning without the differences that are none."""
    return INTO_THE_BIN.sub(r"clear \1", GENERIC.sub("thing", text))


def _thing(number: int, words: Sequence[str]) -> PerceivedObject:
    """An object from "category colour size x y" [m]."""
    category, colour, size, x, y = words
    known, extent = prior(category), SIZES[size]
    return PerceivedObject(
        id=f"obj_{number}", category=category, confidence=1.0, position=(float(x), float(y), extent[2] / 2), yaw=0.0,
        size=extent, shape="cylinder", affordance=known.affordance, mass=known.mass, friction=known.friction,
        colour_name=colour, colour=COLOURS[colour],
    )  # fmt: skip


def main(arguments: Sequence[str] | None = None) -> int:
    """Prints the counts; with --missed the failures of the tuning half too."""
    parser = argparse.ArgumentParser(prog="python -m bench.language_report", description=__doc__)
    parser.add_argument("--missed", action="store_true", help="also list what the tuning half misses")
    options = parser.parse_args(arguments)
    tuning, reported = measure_commands(CORPUS)
    names = ("tuning half", "reported half", "ambiguous", "single", "absent")
    for name, count in zip(
        names, (tuning, reported, *measure_references(CORPUS.with_name("references.txt"))), strict=True
    ):
        sys.stdout.write(f"{name:14} {count.right} of {count.total} ({count.right / count.total:.1%})\n")
        if options.missed and name != "reported half":
            sys.stdout.write("".join(f"    {line}\n" for line in count.missed))
    return 0


if __name__ == "__main__":
    sys.exit(main())
