"""How many promotions are wrong when the robot lies: every executed strategy is learnt by the real rules, claims falsified.

    python -m bench.false_claims                    # 20 % of failed lifts and of failed confirmations claimed
    python -m bench.false_claims --share 0.4 --rounds 20

The strategies are the pairs of object and strategy that `ragvlm kb eval` has executed ten times in physics; most of them do
not work at all, as when somebody tries what comes to mind. Each is tried in up to 40 poses; its measured share of successes
is the chance of every lift. Quarantine, promotion and what later outcomes do to an entry are the learner's own code; the
regression suite, which could only refuse more, is left out. A promotion is wrong if under half of the executions succeeded.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from bench.kb_eval.relevance import TRIALS
from bench.kb_eval.study import executed_path
from bench.statistics import wilson
from kb.errors import BadInputError
from kb.experience import Strategy
from kb.journal import Change
from kb.learned import State, after
from kb.lesson import Lesson
from kb.priors import prior
from kb.store import ExperienceStore
from kb.store_file import StoreHeader
from tools.learn_experience import LearnRules, Suite, decide

LESSONS = 40
"""Lifts of a strategy."""
WORKS = 0.5
"""Share of executions from which a strategy works."""


@dataclass(frozen=True)
class Fate:
    """What became of one strategy."""

    rate: float
    """Share of executions that succeeded."""
    promoted: bool
    """It became an entry that counts as a success."""
    avoided: bool
    """It became an entry to be avoided."""
    trusted: bool
    """At the end it is an entry that counts as a success."""


@dataclass
class Tally:
    """Counts over many strategies."""

    fates: list[Fate] = field(default_factory=list[Fate])

    def count(self, works: bool, what: str) -> tuple[int, int]:
        """Of the strategies that work (or don't): how many met that fate, and how many there are."""
        mine = [fate for fate in self.fates if (fate.rate >= WORKS) == works]
        return sum(bool(getattr(fate, what)) for fate in mine), len(mine)

    def wrong(self, what: str) -> tuple[int, int]:
        """Strategies that don't work among those that met that fate."""
        bad, good = self.count(False, what)[0], self.count(True, what)[0]
        return bad, bad + good


def lesson(header: StoreHeader, place: tuple[float, float], yaw: float, *, claimed: bool, confirmed: bool) -> Lesson:
    """A lesson of one strategy; what it is about makes no difference here."""
    affordance = prior("cup").affordance
    strategy = Strategy(
        region=affordance.region, type="pinch", approach="top", tilt=0.0, force=12.0, force_band=(12.0, 12.0),
        aperture=0.06, depth=0.5,
    )  # fmt: skip
    vector = tuple(float(number == 0) for number in range(header.dim))
    return Lesson(
        category="cup", affordance=affordance, size=(0.08, 0.08, 0.09), mass=0.2, strategy=strategy, place=place, yaw=yaw,
        claimed=claimed, confirmed=confirmed, failure=None if claimed else "SLIP", embedding=vector,
        embedder=header.embedder,
    )  # fmt: skip


def learnt(rate: float, share: float, header: StoreHeader, rng: np.random.Generator, rules: LearnRules) -> Fate:
    """One strategy tried `LESSONS` times in drawn poses.

    Args:
        rate: Chance that a lift truly succeeds.
        share: Chance that a failed lift, and a failed confirmation, is claimed.
        header: Of the knowledge base.
        rng: Source of poses, lifts and lies.
        rules: What a promotion asks for.
    """
    state, promoted, avoided = State({}), False, False
    for _ in range(LESSONS):
        lift, again, first_lie, second_lie = rng.random(4) < (rate, rate, share, share)
        claimed = bool(lift or first_lie)
        place = (float(rng.uniform(0.35, 0.65)), float(rng.uniform(-0.25, 0.25)))
        one = lesson(
            header, place, float(rng.uniform(0.0, np.pi)), claimed=claimed, confirmed=claimed and bool(again or second_lie)
        )  # fmt: skip
        state = after(state, Change(version=0, kind="lesson", says="", lesson=one))
        decided = decide(state, header, one, Suite(queries=()), rules)
        if decided is not None:
            state = after(state, decided)
            if decided.entry is not None:
                promoted, avoided = promoted or decided.entry.success, avoided or not decided.entry.success
    return Fate(rate, promoted, avoided, any(entry.success for entry in state.entries.values()))


def tally(rates: Sequence[float], share: float, rounds: int, rules: LearnRules | None = None) -> Tally:
    """All strategies, `rounds` times, with seed 0."""
    header, rng, found = ExperienceStore.open().header, np.random.default_rng(0), Tally()
    for _ in range(rounds):
        found.fates += [learnt(rate, share, header, rng, rules or LearnRules()) for rate in rates]
    return found


def executed_rates(path: Path) -> list[float]:
    """Measured shares of success of all executed pairs of object and strategy.

    Raises:
        BadInputError: no such file, or none of `ragvlm kb eval`.
    """
    try:
        kept = json.loads(path.read_text(encoding="utf-8"))["successes"]
        return [int(value) / TRIALS for _, value in sorted(kept.items())]
    except (OSError, ValueError, KeyError, AttributeError) as error:
        raise BadInputError(f"no outcomes of `ragvlm kb eval`: {error}", where=str(path)) from error


def report(found: Tally, share: float) -> str:
    """The counts in Markdown."""
    lines = [
        f"{100 * share:g} % of failed lifts and of failed confirmations claimed; {LESSONS} lifts of each strategy.",
        "",
        "| strategies | lives | promoted | trusted at the end | to be avoided |",
        "|---|---:|---:|---:|---:|",
    ]
    for works, words in ((True, "work (at least half of ten executions)"), (False, "do not work")):
        cells = [found.count(works, what) for what in ("promoted", "trusted", "avoided")]
        lines.append(f"| {words} | {cells[0][1]} | {' | '.join(str(k) for k, _ in cells)} |")
    for what, words in (("promoted", "Wrong promotions"), ("trusted", "Wrong among those trusted at the end")):
        k, n = found.wrong(what)
        band = wilson(k, n)
        part = 100 * k / n if n else 0.0
        lines += ["", f"{words}: {k} of {n} = {part:.2f} % [{100 * band.low:.2f}, {100 * band.high:.2f}]."]
    return "\n".join(lines) + "\n"


def main(arguments: Sequence[str] | None = None) -> int:
    """Entry point of `python -m bench.false_claims`."""
    parser = argparse.ArgumentParser(prog="python -m bench.false_claims", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--share", type=float, default=0.2, help="failed lifts and confirmations that are claimed")
    parser.add_argument("--rounds", type=int, default=1, help="how often each strategy is learnt from nothing")
    parser.add_argument("--needed", type=int, default=3, help="independent successes for a promotion")
    parser.add_argument("--executed", type=Path, help="file of executed outcomes (default: beside the knowledge base)")
    given = parser.parse_args(arguments)
    if not 0.0 <= given.share <= 1.0 or given.rounds < 1 or not 1 <= given.needed <= LESSONS:
        parser.error(f"--share is 0 to 1, --rounds at least 1, --needed 1 to {LESSONS}")
    try:
        rates = executed_rates(given.executed or executed_path(ExperienceStore.open()))
    except BadInputError as error:
        parser.error(str(error))
    found = tally(rates, given.share, given.rounds, LearnRules(needed=given.needed))
    sys.stdout.write(report(found, given.share))
    return 0


if __name__ == "__main__":
    sys.exit(main())
