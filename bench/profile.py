"""Where the time of a benchmark went, from its rows: the stages of a trial, what sharing saved, and the harness."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from statistics import median

from bench.runner import trials_file
from bench.trial import Trial, read_trials

STAGES = ("perception", "retrieval", "planning", "execution", "brain")
"""Stages of a run (product.md, `timings_s`)."""


def profile_text(folder: Path) -> str:
    """The profile of the trials in a folder, as lines."""
    return "\n".join(profile_lines(read_trials(trials_file(folder))))


def profile_lines(trials: Sequence[Trial]) -> list[str]:
    """One line a stage: seconds in all, per trial, and share; then the trials' wall time and the bare-step ratio.

    Stage times are what each configuration would have taken alone; the wall time is what it took with shared looks and motions.
    """
    ran = [trial for trial in trials if trial.harness_error is None]
    if not ran:
        return ["no trial ran, so there is no profile"]
    total = sum(trial.times_s.get("total", 0.0) for trial in ran)
    rows = [(stage, sum(trial.times_s.get(stage, 0.0) for trial in ran)) for stage in STAGES]
    rows.append(("graph and checkpoints", total - sum(seconds for _, seconds in rows)))
    lines = [f"{'stage':24}{'s in all':>10}{'s a trial':>11}{'share':>8}"]
    lines += [_line(name, seconds, len(ran), total) for name, seconds in rows]
    lines.append(_line("agent alone", total, len(ran), total))
    wall = sum(trial.wall_s for trial in ran)
    lines.append(_line("trial in its worker", wall, len(ran), total))
    lines.append(
        f"sharing looks and motions saved {max(0.0, total - wall):.1f} s net of opening worlds, building agents and judging"
    )
    ratios = [trial.bare_step_ratio for trial in ran if trial.bare_step_ratio is not None]
    if ratios:
        lines.append(
            f"bare_step_ratio {median(ratios):.3f} (median of {len(ratios)} trials): processor time of execute_grasp over bare "
            "mj_step of the same steps"
        )
    walls = [trial.bare_step_wall_ratio for trial in ran if trial.bare_step_wall_ratio is not None]
    if walls:
        lines.append(f"of wall times {median(walls):.3f}: other work on the machine takes part in it")
    return lines


def _line(name: str, seconds: float, count: int, total: float) -> str:
    share = 100.0 * seconds / total if total > 0.0 else 0.0
    return f"{name:24}{seconds:>10.2f}{seconds / count:>11.3f}{share:>7.1f}%"
