"""Lines of trials.jsonl made by hand, for the tests of statistics and report; no world is simulated for them."""

from __future__ import annotations

from typing import Any

import numpy as np

from bench.suite import GROUPS, TWELVE

KINDS = ("SLIP", "WIDTH_MISMATCH", "COLLISION", "POSITION_ERROR", "DROP", "FORCE_DAMAGE", "UNKNOWN", "TIMEOUT")
"""Failure types that drawn attempts fail with."""


def attempt_row(level: int, success: bool, **more: Any) -> dict[str, Any]:
    """One attempt; `more` replaces what it says otherwise."""
    failure = None if success else more.pop("kind", "SLIP")
    corrected = {"failure": more.pop("after", "SLIP"), "level": level} if level else None
    return {
        "level": level,
        "success": success,
        "claimed": success,
        "failure": failure,
        "observed_failure": failure,
        "correction": corrected,
        "quality": {"q": 0.9 if success else 0.7, "phi": [1.0] * 7},
        "evidence": {"sim_time": 9.0},
        "verdict": {"damage": [], "disturbed": [], "peak_force_n": 20.0},
    } | more


def goal_row(
    attempts: list[dict[str, Any]], *, parent: int | None = None, success: bool | None = None
) -> dict[str, Any]:
    """A goal that ends as its last attempt ended."""
    good = bool(attempts) and attempts[-1]["success"] if success is None else success
    return {
        "kind": "pick" if parent is None else "place",
        "target": "obj_0",
        "object": "cup",
        "success": good,
        "claimed": bool(attempts) and attempts[-1]["claimed"],
        "parent": parent,
        "verdict": attempts[-1]["verdict"] if attempts else None,
        "attempts": attempts,
    }


def trial_row(
    configuration: str = "full",
    task: str = "single_cup",
    *,
    repetition: int = 0,
    trial: int = 0,
    goals: list[dict[str, Any]] | None = None,
    **more: Any,
) -> dict[str, Any]:
    """One line; it succeeds if its goals do."""
    own = [goal_row([attempt_row(0, True)])] if goals is None else goals
    asked = [goal for goal in own if goal["parent"] is None]
    return {
        "schema_version": 1,
        "instruction": "pick up the cup",
        "scene": task,
        "seed": 20_000 + 1000 * repetition + trial,
        "configuration": configuration,
        "brain": "rules",
        "perception": "rgbd",
        "evaluator": "mujoco",
        "executed": True,
        "success": bool(asked) and all(goal["success"] for goal in asked),
        "answer": "",
        "goals": own,
        "constraints": [],
        "damage_events": 0,
        "timings_s": {
            "perception": 0.5,
            "retrieval": 0.1,
            "planning": 0.3,
            "execution": 0.9,
            "brain": 0.01,
            "total": 1.9,
        },
        "task": task,
        "repetition": repetition,
        "trial": trial,
        "suite": "tasks",
        "noise": 1.0,
        "wall_s": 2.5,
        "harness_error": None,
        "bare_step_ratio": None,
    } | more


def error_row(configuration: str, task: str, *, repetition: int = 0, trial: int = 0) -> dict[str, Any]:
    """A trial that the harness spoilt."""
    return trial_row(
        configuration, task, repetition=repetition, trial=trial, goals=[], harness_error="RuntimeError: worker died"
    ) | {"success": False, "executed": False}


def required_row(kind: str = "collision", *, satisfied: bool = True, inferred: bool = True, moved: float = 0.4) -> Any:
    """A constraint that the task requires."""
    return {
        "kind": kind,
        "target": "vase",
        "required": True,
        "inferred": inferred,
        "satisfied": satisfied,
        "measured": {"displacement_mm": moved},
    }


def drawn_rows(
    skills: dict[str, float],
    *,
    tasks: tuple[str, ...] = TWELVE,
    trials: int = 30,
    repetitions: dict[str, int] | None = None,
    noise: float = 1.0,
    seed: int = 1,
) -> list[dict[str, Any]]:
    """A whole run in which each configuration succeeds in an attempt with its own chance, the world being shared.

    Args:
        skills: Configuration -> chance of an attempt.
        tasks: Tasks of the run.
        trials: Trials per task and repetition.
        repetitions: Repetitions of a configuration, 1 where not given.
        noise: Noise level.
        seed: Seed of the draws.
    """
    rows: list[dict[str, Any]] = []
    for configuration, skill in skills.items():
        for repetition in range((repetitions or {}).get(configuration, 1)):
            for number, task in enumerate(tasks):
                for trial in range(trials):
                    rng = np.random.default_rng((seed, repetition, number, trial))
                    rows.append(_drawn(configuration, skill, task, repetition, trial, noise, rng))
    return rows


def _drawn(
    configuration: str, skill: float, task: str, repetition: int, trial: int, noise: float, rng: np.random.Generator
) -> dict[str, Any]:
    long = task in GROUPS["long_horizon"]
    goals = [_drawn_goal(configuration, skill, 0 if long else None, rng) for _ in range(3 if long else 1)]
    if long:
        done = all(goal["success"] for goal in goals)
        top = goal_row([], success=done) | {"kind": "clear", "claimed": done, "target": None, "object": None}
        goals = [top, *goals]
    damage = int(rng.random() < 0.02)
    bound = task in GROUPS["interaction"]
    kept = bool(rng.random() < 0.5 + skill / 2)
    return trial_row(
        configuration,
        task,
        repetition=repetition,
        trial=trial,
        goals=goals,
        noise=noise,
        damage_events=damage,
        constraints=[required_row(satisfied=kept, moved=float(rng.exponential(1.0)))] if bound else [],
    )


def _drawn_goal(configuration: str, skill: float, parent: int | None, rng: np.random.Generator) -> dict[str, Any]:
    attempts: list[dict[str, Any]] = []
    last = "SLIP"
    for level in range(1 if configuration in ("no_recovery", "vlm_only") else 4):
        luck, kind = rng.random(2)
        name = KINDS[int(kind**2 * len(KINDS))]
        attempts.append(attempt_row(level, bool(luck < skill), kind=name, after=last))
        last = name
        if attempts[-1]["success"]:
            break
    return goal_row(attempts, parent=parent)
