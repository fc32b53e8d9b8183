"""One trial of the benchmark, digested from its line in trials.jsonl: what the report counts, and nothing else.

A line is a RunResult with `task`, `configuration`, `repetition`, `trial`, `suite`, `noise`, `wall_s`, `harness_error` and
`bare_step_ratio`. A line of a harness error may lack the RunResult; the trial still counts, as a failure.
"""

from __future__ import annotations

import json
import logging
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from kb.errors import BadInputError

log = logging.getLogger(__name__)

CORE_SUITE = "tasks"
"""Suite of the twelve tasks, assumed where a line names none."""

Key = tuple[str, str, int, int, float]
"""Configuration, task, repetition, trial, noise: what makes a trial unique."""


@dataclass(frozen=True)
class Attempt:
    """One attempt: the robot's word beside the observer's."""

    level: int
    success: bool
    claimed: bool
    failure: str | None
    """The robot's diagnosis; None where it claimed success."""
    observed: str | None
    """The observer's label; None where it saw success."""
    corrected: tuple[str, int] | None
    """Failure type and level of the correction that led to this attempt."""
    q: float | None
    """Predicted quality Q of Eq. (2)."""
    sim_s: float
    """Simulated duration [s]."""
    peak_n: float | None
    """Peak contact force on the object [N], by the observer."""
    remembered: bool = False
    """A number of the grasp came from the episodic memory."""


@dataclass(frozen=True)
class SubGoal:
    """One thing to grasp (and perhaps to put somewhere)."""

    kind: str
    object: str | None
    success: bool
    claimed: bool
    attempts: tuple[Attempt, ...]
    damaged: frozenset[str]
    disturbed: frozenset[str]

    @property
    def recovered(self) -> bool:
        """It succeeded after its first attempt had failed."""
        return self.success and len(self.attempts) > 1 and not self.attempts[0].success

    @property
    def first_failed(self) -> bool:
        """Its first attempt was carried out and failed."""
        return bool(self.attempts) and not self.attempts[0].success


@dataclass(frozen=True)
class Constraint:
    """One constraint, required by the task or inferred by the agent."""

    kind: str
    target: str
    required: bool
    inferred: bool
    satisfied: bool
    displacement_mm: float | None
    """How far the protected thing was moved [mm], where that was measured."""


@dataclass(frozen=True)
class Trial:
    """One line of trials.jsonl."""

    configuration: str
    task: str
    repetition: int
    trial: int
    noise: float
    suite: str
    seed: int | None
    evaluator: str
    perception: str
    brain: str
    success: bool
    claimed: bool
    harness_error: str | None
    damage_events: int
    subgoals: tuple[SubGoal, ...]
    constraints: tuple[Constraint, ...]
    times_s: Mapping[str, float]
    """Wall times of the run's parts [s]."""
    wall_s: float
    bare_step_ratio: float | None
    strict: bool | None = None
    """Success with every grasp on the annotated region and no required constraint violated; None: not recorded."""
    bare_step_wall_ratio: float | None = None
    """`bare_step_ratio` of wall times."""
    executed: bool = True
    """The robot moved at all."""
    damage_limit_n: Mapping[str, float] = field(default_factory=dict)
    """Force from which each object counts as damaged [N]."""
    fallback: bool | None = None
    """Too few experiences fitted by category, so that all were admitted (ledger G14b); None: nothing was retrieved."""
    s_aff: float | None = None
    """Affordance score of the best retrieved success; None where there was none."""

    @property
    def key(self) -> Key:
        """What makes this trial unique."""
        return self.configuration, self.task, self.repetition, self.trial, self.noise

    @property
    def pair(self) -> tuple[str, int, int, float]:
        """The same for every configuration that saw the same world."""
        return self.task, self.repetition, self.trial, self.noise

    @property
    def attempts(self) -> int:
        """Attempts over all sub-goals."""
        return sum(len(goal.attempts) for goal in self.subgoals)

    @property
    def first_failed(self) -> bool:
        """The first attempt of some sub-goal failed."""
        return any(goal.first_failed for goal in self.subgoals)


def digest(row: Mapping[str, Any]) -> Trial:
    """The trial of a line.

    Raises:
        BadInputError: the line lacks what identifies a trial.
    """
    missing = [name for name in ("configuration", "task", "repetition", "trial") if name not in row]
    if missing:
        raise BadInputError(f"a trial lacks {', '.join(missing)}", where="trials.jsonl")
    error = row.get("harness_error")
    goals: list[dict[str, Any]] = list(row.get("goals") or ())
    asked = [goal for goal in goals if goal.get("parent") is None]
    times = row.get("timings_s") or {}
    return Trial(
        configuration=str(row["configuration"]),
        task=str(row["task"]),
        repetition=int(row["repetition"]),
        trial=int(row["trial"]),
        noise=float(1.0 if row.get("noise") is None else row["noise"]),
        suite=str(row.get("suite") or CORE_SUITE),
        seed=row.get("seed"),
        evaluator=str(row.get("evaluator") or "mujoco"),
        perception=str(row.get("perception") or "rgbd"),
        brain=str(row.get("brain") or "rules"),
        success=bool(row.get("success")) and not error,
        claimed=bool(asked) and all(bool(goal.get("claimed")) for goal in asked) and not error,
        harness_error=str(error) if error else None,
        damage_events=int(row.get("damage_events") or 0),
        subgoals=tuple(_subgoal(goal) for goal in _leaves(goals)),
        constraints=tuple(_constraint(item) for item in row.get("constraints") or ()),
        times_s={name: float(value) for name, value in times.items()},
        wall_s=float(row.get("wall_s") or times.get("total") or 0.0),
        bare_step_ratio=row.get("bare_step_ratio"),
        bare_step_wall_ratio=row.get("bare_step_wall_ratio"),
        strict=None if row.get("strict") is None else bool(row["strict"]) and not error,
        executed=bool(row.get("executed", True)),
        damage_limit_n=dict(row.get("damage_limit_n") or {}),
        fallback=(row.get("funnel") or {}).get("fallback"),
        s_aff=next((float(item["s_aff"]) for item in row.get("experiences") or () if item.get("success")), None),
    )


def _leaves(goals: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The goals that move something themselves: picks and places that are nobody's parent, or that were attempted."""
    parents = {goal.get("parent") for goal in goals}
    return [
        goal
        for number, goal in enumerate(goals)
        if goal.get("kind") in ("pick", "place") and (number not in parents or goal.get("attempts"))
    ]


def _subgoal(goal: Mapping[str, Any]) -> SubGoal:
    verdicts = [goal.get("verdict"), *(attempt.get("verdict") for attempt in goal.get("attempts") or ())]
    seen = [verdict for verdict in verdicts if verdict]
    return SubGoal(
        kind=goal["kind"],
        object=goal.get("object"),
        success=bool(goal.get("success")),
        claimed=bool(goal.get("claimed")),
        attempts=tuple(_attempt(attempt) for attempt in goal.get("attempts") or ()),
        damaged=frozenset(name for verdict in seen for name in verdict.get("damage") or ()),
        disturbed=frozenset(name for verdict in seen for name in verdict.get("disturbed") or ()),
    )


def _attempt(attempt: Mapping[str, Any]) -> Attempt:
    correction, verdict = attempt.get("correction"), attempt.get("verdict") or {}
    quality = attempt.get("quality") or {}
    return Attempt(
        level=int(attempt["level"]),
        success=bool(attempt["success"]),
        claimed=bool(attempt["claimed"]),
        failure=attempt.get("failure"),
        observed=attempt.get("observed_failure"),
        corrected=(correction["failure"], int(correction["level"])) if correction else None,
        q=quality.get("q"),
        sim_s=float((attempt.get("evidence") or {}).get("sim_time") or 0.0),
        peak_n=verdict.get("peak_force_n"),
        remembered=any(
            step.get("source") == "memory" for steps in (attempt.get("provenance") or {}).values() for step in steps
        ),
    )


def _constraint(item: Mapping[str, Any]) -> Constraint:
    return Constraint(
        kind=item["kind"],
        target=item["target"],
        required=bool(item["required"]),
        inferred=bool(item["inferred"]),
        satisfied=bool(item["satisfied"]),
        displacement_mm=(item.get("measured") or {}).get("displacement_mm"),
    )


def read_trials(path: Path) -> tuple[Trial, ...]:
    """All trials of a trials.jsonl, each key once, in a fixed order.

    A last line that was cut off by a kill is left out with a warning; the runner repeats that trial.

    Raises:
        BadInputError: no such file, a broken line before the last, or no trial at all.
    """
    if not path.is_file():
        raise BadInputError("there is no such file", where=str(path))
    found: dict[Key, Trial] = {}
    for trial in _parsed(path):
        if trial.key in found:
            log.warning("%s holds %s more than once; the first one counts", path, trial.key)
        found.setdefault(trial.key, trial)
    if not found:
        raise BadInputError("it holds no trial", where=str(path))
    return in_order(found.values())


def _parsed(path: Path) -> Iterator[Trial]:
    with path.open(encoding="utf-8") as lines:
        broken: tuple[int, str] | None = None
        for number, line in enumerate(lines, 1):
            if not line.strip():
                continue
            if broken is not None:
                raise BadInputError(f"line {broken[0]} is not JSON: {broken[1]}", where=str(path))
            try:
                row = json.loads(line)
            except ValueError as error:
                broken = (number, str(error))
                continue
            yield digest(row)
    if broken is not None:
        log.warning("%s: the last line (%d) is cut off and left out", path, broken[0])


def in_order(trials: Iterable[Trial]) -> tuple[Trial, ...]:
    """The trials in an order that does not depend on which worker finished first."""
    return tuple(sorted(trials, key=lambda trial: trial.key))
