"""What was harmed or disturbed, and whether the constraints were kept, by physical measurement."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bench.cells import cells
from bench.report.results import Results
from bench.report.table import Table
from bench.report.value import Content, Count, Number
from bench.trial import Trial


def tables(results: Results) -> list[Table]:
    """Damage and disturbance; constraints; constraints by kind."""
    return [damage(results), constraints(results), by_kind(results)]


def damage(results: Results) -> Table:
    """Damage per 100 trials, and how far protected neighbours were moved."""
    rows: list[tuple[Content, ...]] = []
    for configuration in results.configurations:
        trials = results.of(configuration)
        if not trials:
            continue
        events = sum(t.damage_events for t in trials)
        neighbours = sum(len(_neighbours_damaged(t)) for t in trials)
        moved = displacements(trials)
        rows.append(
            (
                configuration,
                events,
                events - neighbours,
                neighbours,
                Number(100 * events / len(trials)),
                Count(sum(_disturbed(t) for t in trials), len(trials)),
                Number(float(np.median(moved)), 1) if moved else None,
                Number(float(np.quantile(moved, 0.95)), 1) if moved else None,
                len(moved),
            )
        )
    return Table(
        "damage",
        "Damage and disturbance",
        ("configuration", "damage events", "to the target", "to others", "per 100 trials", "trials that moved a neighbour",
         "displacement median [mm]", "95th percentile [mm]", "measured"),
        tuple(rows),
        "Damage events: objects hurt in any motion of the trial, also while something was put back or the arm went home (those "
        "count with the target). Moved a neighbour: anything that was not to be touched was moved by 5 mm or 5° in an attempt, in any task. "
        "Displacement: of the neighbours and occluders that a task protects; measured: how many these are.",
        frozenset({"full"}),
    )  # fmt: skip


def _neighbours_damaged(trial: Trial) -> set[str]:
    meant = {goal.object for goal in trial.subgoals}
    return {name for goal in trial.subgoals for name in goal.damaged} - {name for name in meant if name}


def _disturbed(trial: Trial) -> bool:
    return any(goal.disturbed for goal in trial.subgoals)


def displacements(trials: Sequence[Trial]) -> list[float]:
    """Measured displacements of protected things [mm]."""
    return [
        item.displacement_mm
        for trial in trials
        for item in trial.constraints
        if item.required and item.displacement_mm is not None
    ]


def satisfaction(trials: Sequence[Trial]) -> Count:
    """Satisfied of required constraints, over all trials; those of trials without an attempt are not satisfied."""
    own = cells(trials)
    return Count(sum(c.constraints_satisfied for c in own), sum(c.constraints_required for c in own))


def constraints(results: Results) -> Table:
    """Satisfaction, joint success, and how well the agent knew what was required."""
    rows: list[tuple[Content, ...]] = []
    for configuration in results.configurations:
        trials = results.of(configuration)
        bound = [t for t in trials if any(item.required for item in t.constraints)]
        if not bound:
            continue
        items = [item for t in trials for item in t.constraints]
        hits = sum(item.required and item.inferred for item in items)
        joint = sum(t.success and all(i.satisfied for i in t.constraints if i.required) for t in bound)
        rows.append(
            (
                configuration,
                satisfaction(trials),
                Count(sum(t.success for t in bound), len(bound)),
                Count(joint, len(bound)),
                Count(hits, sum(item.inferred for item in items)),
                Count(hits, sum(item.required for item in items)),
            )
        )
    return Table(
        "constraints",
        "Constraints: kept, and known",
        ("configuration", "satisfied", "success", "success ∧ satisfied", "inference precision", "inference recall"),
        tuple(rows),
        "Measured by force, displacement, tilt and spill over the whole trial, in every configuration, whether or not it "
        "has an analyzer. Success is that of the trials with a required constraint. Inference: the agent's constraints "
        "against the required ones.",
        frozenset({"full"}),
    )


def by_kind(results: Results) -> Table:
    """Satisfaction by kind of constraint."""
    kinds = sorted({i.kind for t in results.at_noise for i in t.constraints if i.required})
    rows: list[tuple[Content, ...]] = []
    for configuration in results.configurations:
        own = [i for t in results.at_noise if t.configuration == configuration for i in t.constraints if i.required]
        counts = [Count(sum(i.satisfied for i in own if i.kind == k), sum(i.kind == k for i in own)) for k in kinds]
        if own:
            rows.append((configuration, *counts))
    return Table(
        "constraint_kinds",
        "Constraints satisfied, by kind",
        ("configuration", *kinds),
        tuple(rows),
        "Over all tasks of the run, the supplementary ones too.",
        shaded=True,
    )
