"""Where the time of a trial goes."""

from __future__ import annotations

from statistics import fmean, median

from bench.report.results import Results
from bench.report.table import Table
from bench.report.value import Content, Number
from bench.trial import Trial

PARTS = ("perception", "retrieval", "planning", "execution", "brain")
"""Parts of `timings_s`."""


def simulated(trial: Trial) -> float:
    """Simulated seconds of a trial's attempts: what a real arm would take for them [s]."""
    return sum(attempt.sim_s for goal in trial.subgoals for attempt in goal.attempts)


def tables(results: Results) -> list[Table]:
    """Mean wall times per part, and simulated time."""
    rows: list[tuple[Content, ...]] = []
    for configuration in results.configurations:
        trials = [t for t in results.of(configuration) if t.harness_error is None]
        if not trials:
            continue
        rows.append(
            (
                configuration,
                *(Number(fmean(t.times_s.get(part, 0.0) for t in trials)) for part in PARTS),
                Number(fmean(t.times_s.get("total", 0.0) for t in trials)),
                Number(median(t.wall_s for t in trials)),
                Number(fmean(map(simulated, trials)), 1),
            )
        )
    return [
        Table(
            "times",
            "Seconds per trial",
            ("configuration", *PARTS, "total", "spent, median", "simulated grasping"),
            tuple(rows),
            "Means of wall time, execution being the simulation of the motion: what a trial of the configuration takes "
            "alone. Spent: what it took here, opening the world included; steps that configurations of one world share "
            "are carried out once, for the first of them. Simulated grasping is the time that the attempts themselves "
            "take on the arm, without carrying and placing.",
            frozenset({"full"}),
        )
    ]
