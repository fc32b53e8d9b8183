"""What the attempts of a turn teach: each as a lesson, and whether the last one is confirmed by lifting again."""

from __future__ import annotations

from collections.abc import Sequence

from agent.attempt import Attempt
from kb.lesson import Lesson
from tools.confirm_grasp import ConfirmArgs, Confirmation, confirm_grasp, strategy_of
from tools.context import ToolContext


def lessons_of(attempts: Sequence[Attempt], confirmed: bool | None, embedder: str, seed: int) -> list[Lesson]:
    """One lesson per attempt; only the last one can have been confirmed.

    None says that it was claimed but could not be tried again (no free path, not seen): that teaches nothing.
    """
    kept = attempts[:-1] if confirmed is None else attempts
    return [
        _lesson(attempt, bool(confirmed) and attempt is attempts[-1], embedder, seed)
        for attempt in kept
        if attempt.sensing.stopped_by not in ("stop", "unreachable", "path")
    ]


def confirm(attempt: Attempt, tools: ToolContext) -> Confirmation:
    """Sets down what the attempt holds and lifts it again."""
    if attempt.percept is None:
        return Confirmation(confirmed=False, says="the look it was planned on is no longer there")
    args = ConfirmArgs(
        plan=attempt.plan, object=attempt.target, percept=attempt.percept, constraints=attempt.constraints
    )
    return confirm_grasp(args, tools)


def _lesson(attempt: Attempt, confirmed: bool, embedder: str, seed: int) -> Lesson:
    target, plan = attempt.target, attempt.plan
    sources = [item for items in plan.provenance.values() for item in items if item.source == "experience"]
    return Lesson(
        category=target.category,
        affordance=target.affordance,
        size=target.size,
        mass=max(0.0, attempt.sensing.load_end),
        strategy=strategy_of(plan, target),
        place=(target.position[0], target.position[1]),
        yaw=target.yaw,
        claimed=attempt.claimed,
        confirmed=attempt.claimed and confirmed,
        failure=None if attempt.claimed else attempt.failure or "UNKNOWN",
        used=sources[0].id if sources else None,
        embedding=tuple(round(value, 6) for value in target.embedding),
        embedder=embedder,
        seed=seed,
    )
