"""What failed, what the robot said about it, and how honest its claims are."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from bench.report.results import Results, Sample
from bench.report.table import Table
from bench.report.value import Content, Count
from bench.trial import Attempt, Trial
from kb.vocabulary import FAILURE_TYPES

CLAIMED = "(success)"
"""The robot said that it had succeeded."""


def failed_attempts(trials: Sequence[Trial]) -> list[Attempt]:
    """Attempts that the observer saw fail."""
    return [attempt for t in trials for goal in t.subgoals for attempt in goal.attempts if not attempt.success]


def failures(trials: Sequence[Trial]) -> Counter[str]:
    """The observer's labels of all failed attempts."""
    return Counter(attempt.observed or "UNKNOWN" for attempt in failed_attempts(trials))


def tables(results: Results) -> list[Table]:
    """Failure types, confusion, honesty, harness errors."""
    found = [breakdown(results), honesty(results)]
    found += [confusion(sample) for sample in results.telling(lambda trials: bool(failed_attempts(trials)))]
    return found + harness_errors(results)


def breakdown(results: Results) -> Table:
    """Failed attempts by the observer's type."""
    counts = {name: failures(results.of(name)) for name in results.configurations}
    kinds = [kind for kind in FAILURE_TYPES if any(found[kind] for found in counts.values())]
    rows = [(name, *(found[kind] or None for kind in kinds), sum(found.values())) for name, found in counts.items()]
    return Table(
        "failures",
        "Failed attempts by type, as the observer saw them",
        ("configuration", *kinds, "all"),
        tuple(rows),
        "The label of the first anomalous event of each failed attempt.",
    )


def confusion(sample: Sample) -> Table:
    """The observer's label against the robot's diagnosis."""
    failed = failed_attempts(sample.trials)
    pairs = Counter((a.observed or "UNKNOWN", CLAIMED if a.claimed else a.failure or "UNKNOWN") for a in failed)
    said = [kind for kind in (*FAILURE_TYPES, CLAIMED) if any(kind == word for _, word in pairs)]
    rows: list[tuple[Content, ...]] = []
    for kind in FAILURE_TYPES:
        total = sum(n for (truth, _), n in pairs.items() if truth == kind)
        if total:
            rows.append((kind, *(pairs[kind, word] or None for word in said), Count(pairs[kind, kind], total)))
    right = sum(n for (truth, word), n in pairs.items() if truth == word)
    rows.append(
        ("all", *(sum(n for (_, own), n in pairs.items() if own == word) for word in said), Count(right, len(failed)))
    )
    return Table(
        f"confusion{sample.suffix}",
        f"Diagnosis against truth ({sample.words})",
        ("observed", *said, "right"),
        tuple(rows),
        "Rows: what the observer saw. Columns: what the robot concluded from its own sensing; (success): it did not "
        "notice the failure.",
    )


def honesty(results: Results) -> Table:
    """The robot's claims against the observer's word."""
    rows: list[tuple[Content, ...]] = []
    for configuration in results.configurations:
        trials = results.of(configuration)
        if not trials:
            continue
        claimed = [t for t in trials if t.claimed]
        good = [t for t in trials if t.success]
        rows.append(
            (
                configuration,
                Count(sum(not t.success for t in claimed), len(claimed)),
                Count(sum(not t.claimed for t in good), len(good)),
            )
        )
    return Table(
        "honesty",
        "Claims",
        ("configuration", "false claims of success", "successes not claimed"),
        tuple(rows),
        "The robot judges itself by its own sensing; the observer reads contacts and poses.",
        frozenset({"full"}),
    )


def harness_errors(results: Results) -> list[Table]:
    """Trials that the harness, not the grasp, spoilt; none is hidden."""
    errors = Counter((t.configuration, t.task, _first_line(t.harness_error)) for t in results.all if t.harness_error)
    if not errors:
        return []
    rows = tuple((name, task, what, n) for (name, task, what), n in sorted(errors.items()))
    return [
        Table(
            "harness_errors",
            "Harness errors",
            ("configuration", "task", "error", "trials"),
            rows,
            "Counted as failures above.",
        )
    ]


def _first_line(words: str | None) -> str:
    return (words or "").strip().splitlines()[0][:160] if (words or "").strip() else "unknown"
