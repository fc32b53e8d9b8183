"""The last lines of a run: what the agent claims, what the observer saw, and how long it took."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console

    from kb.run_result import AttemptRecord, GoalRecord, RunResult


def print_verdict(console: Console, result: RunResult) -> None:
    """Prints claimed and observed per goal, broken or kept constraints, damage and wall times."""
    from rich.text import Text

    console.print(Text("-" * 72, style="dim"))
    for number, goal in enumerate(result.goals):
        if goal.kind in ("look", "answer"):
            continue
        _print_goal(console, number, goal, executed=result.executed)
    # Without a motion nothing was kept or broken.
    required = [item for item in result.constraints if item.required and result.executed]
    for item in required:
        word = "kept" if item.satisfied else "broken" if approached(result) else "not put to the test"
        known = "inferred" if item.inferred else "not inferred"
        console.print(Text(f"constraint {item.kind} ({item.target}): {word}; {known} by the agent"))
    if result.damage_events:
        console.print(Text(f"damage events: {result.damage_events}", style="bold red"))
    label = "analytic evaluator, no physics; " if result.evaluator == "analytic" else ""
    label += "oracle perception; " if result.perception == "oracle" else ""
    moving = any(goal.kind not in ("look", "answer") for goal in result.goals)
    if not result.executed and moving:
        console.print(Text(f"{label}nothing was moved", style="yellow"))
    times = result.timings_s
    console.print(
        Text(
            f"{label}{times.total:.2f} s: perception {times.perception:.2f}, retrieval {times.retrieval:.2f}, "
            f"planning {times.planning:.2f}, execution {times.execution:.2f}, brain {times.brain:.2f}",
            style="dim",
        )
    )


def approached(result: RunResult) -> bool:
    """Whether a hand went towards something: else a required constraint is not satisfied, but nothing broke it."""
    attempts = [attempt for goal in result.goals for attempt in goal.attempts]
    return not attempts or any(attempt.evidence.get("phase") not in ("plan", "transit") for attempt in attempts)


def _stopped(attempt: AttemptRecord) -> bool:
    return attempt.evidence.get("stopped_by") == "stop"


def _print_goal(console: Console, number: int, goal: GoalRecord, *, executed: bool) -> None:
    """One line for the goal, one for each attempt, one for the verdict."""
    from rich.text import Text

    name = f"goal {number} {goal.kind}" + (f" {goal.target}" if goal.target else "")
    if goal.object and goal.object != goal.target:
        name += f" (in truth: {goal.object})"
    line = Text(f"{name}: ", style="bold")
    if not executed:
        line.append("planned" if goal.success else "not done", style="green" if goal.success else "yellow")
    else:
        line.append("claimed " + ("yes" if goal.claimed else "no"))
        line.append(", ")
        seen = "success" if goal.success else "no success"
        line.append(f"observed {seen}", style="bold green" if goal.success else "bold red")
        if goal.claimed != goal.success:
            line.append("  (the agent is wrong)", style="bold yellow")
    console.print(line)
    if goal.note:
        console.print(Text(f"  {goal.note}"))
    for attempt in goal.attempts:
        console.print(Text("  " + attempt_line(attempt)))


def attempt_line(attempt: AttemptRecord) -> str:
    """An attempt's diagnosis beside the observer's label and measurements."""
    if _stopped(attempt) and not attempt.claimed and not attempt.success:
        # The types of failure say what went wrong with a grasp; that a person stopped it is none of them.
        return f"level {attempt.level}: stopped before it was done"
    claimed = "success" if attempt.claimed else attempt.failure or "failure"
    observed = "success" if attempt.success else attempt.observed_failure or "failure"
    text = f"level {attempt.level}: claimed {claimed}, observed {observed}"
    seen = attempt.verdict
    if seen is None:
        return text
    text += (
        f"; lifted {seen.lifted_m * 100:.1f} cm, held {seen.held_s:.1f} s, slip {seen.slip_m * 1000:.1f} mm, "
        f"peak {seen.peak_force_n:.1f} N"
    )
    if seen.disturbed:
        text += f", disturbed {', '.join(seen.disturbed)}"
    if seen.damage:
        text += f", damaged {', '.join(seen.damage)}"
    return text
