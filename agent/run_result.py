"""The public result: what the agent did and claimed, merged with what the observer saw, after the graph has ended.

This is the only place where the two meet, and it only reads: nothing here goes back into the state.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Protocol

from agent.agenda import parts_of
from agent.attempt import Attempt
from agent.goal import Goal, Placement
from agent.placing import in_robots_words
from agent.state import State
from kb.base import Vec3
from kb.run_result import (
    AttemptRecord,
    ConstraintRecord,
    EdgeRecord,
    ExperienceRecord,
    GoalRecord,
    GraphRecord,
    GraspRecord,
    RunResult,
    Timings,
)
from kb.verdict import ObservedAttempt, Verdict
from kb.vocabulary import ConstraintKind

DIGITS = 6
"""Decimals of numbers in the result: micrometres, milligrams, micronewtons."""


class Judge(Protocol):
    """The part of the observer that is asked."""

    def judge(
        self, attempt: int, meant: str | None, placement: Any = None, other: str | None = None, *, since: int = 0
    ) -> ObservedAttempt: ...

    def meant(self, category: str | None, position: Vec3, attempt: int | None = None) -> str | None: ...

    def constraints(self, inferred: Iterable[tuple[ConstraintKind, str]] = ()) -> tuple[ConstraintRecord, ...]: ...

    def damaged(self, since: int = 0) -> tuple[str, ...]: ...


def run_result(
    state: State,
    observer: Judge | None,
    *,
    configuration: str,
    brain: str,
    perception: str,
    evaluator: str,
    total: float,
) -> RunResult:
    """The result of the turn that `state` is at the end of.

    Args:
        state: the final state of the graph.
        observer: judges each motion; None on hardware without one, where the agent's own word stands.
        configuration: name of the configuration.
        brain: name of the brain.
        perception: name of the perception.
        evaluator: name of the evaluator.
        total: wall time of the run [s].
    """
    goals = tuple(_goal(state, index, observer) for index in range(len(state.goals)))
    damaged = {name for goal in goals for name in _damage(goal)} | _damaged_between(state, observer)
    asked = [goal for goal in goals if goal.parent is None]
    attempts = [a for a in state.attempts if a.turn == state.turn]
    result = RunResult(
        instruction=state.instruction,
        scene=state.scene,
        seed=state.seed,
        configuration=configuration,
        brain=brain,
        perception=perception,
        evaluator=evaluator,
        executed=state.executed,
        # Also what came to harm on the way home or while it was held out: a grasp is judged before that.
        success=bool(asked) and not state.refused and not damaged and all(goal.success for goal in asked),
        answer=state.answer,
        question=state.question,
        goals=goals,
        constraints=_constraints(state, attempts, observer),
        experiences=_experiences(state),
        scene_graph=_graph(state),
        damage_events=len(damaged),
        timings_s=timings(state, total),
        funnel=state.shown.funnel.model_dump() if state.shown else {},
        model_use=state.use,
    )
    return RunResult.model_validate(rounded(result.model_dump()))


def rounded(value: Any) -> Any:
    """The value with every float rounded to `DIGITS` decimals."""
    if type(value) in SAID_AS_IT_IS:
        return value
    if isinstance(value, float):
        return round(value, DIGITS) + 0.0
    if isinstance(value, dict):
        return {key: item if type(item) in SAID_AS_IT_IS else rounded(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return type(value)([item if type(item) in SAID_AS_IT_IS else rounded(item) for item in value])
    return value


SAID_AS_IT_IS = frozenset({str, bool, int, type(None)})
"""Types of values that hold nothing to be rounded."""


def _goal(state: State, index: int, observer: Judge | None) -> GoalRecord:
    goal = state.goals[index]
    tries = tuple(a for a in state.attempts if a.turn == state.turn and a.goal == index)
    motions = [a.motion for a in tries] + ([state.motions[index]] if index in state.motions else [])
    meant = _meant(goal, observer, motions[0] if motions else None)
    seen = [_observed(a, meant, observer, _first_motion(state)) for a in tries]
    records = tuple(_attempt(a, o) for a, o in zip(tries, seen, strict=True))
    verdict = seen[-1].verdict if seen else None
    success = goal.claimed
    if observer is not None and goal.moves:
        success, verdict = _judged(state, index, observer, meant, seen, verdict)
    return GoalRecord(
        kind=goal.kind, target=goal.target, object=meant, success=success, claimed=goal.claimed, parent=goal.parent,
        verdict=verdict, attempts=records, note=goal.note,
    )  # fmt: skip


def _judged(
    state: State, index: int, observer: Judge, meant: str | None, seen: list[ObservedAttempt], verdict: Verdict | None
) -> tuple[bool, Verdict | None]:
    """The observer's word on a goal that moves."""
    goal = state.goals[index]
    if goal.kind in ("clear", "sort"):
        parts = parts_of(state.goals, index)
        children = [i for i, g in enumerate(state.goals) if g in parts and g.parent == index]
        done = [_goal(state, i, observer).success for i in children]
        return bool(done) and all(done) and goal.claimed, None
    if goal.note == "planned, not executed":
        return goal.claimed, None
    if goal.placement is None or goal.placement.kind == "hand_over":
        return bool(seen) and seen[-1].success, verdict
    if index not in state.motions:
        return False, verdict
    other = _other(state, goal, observer, state.motions[index])
    placed = observer.judge(
        state.motions[index], meant, _told(state, goal, goal.placement), other, since=_first_motion(state)
    )
    if verdict is None:
        return placed.success, placed.verdict
    damage = tuple(dict.fromkeys((*verdict.damage, *placed.verdict.damage)))
    disturbed = tuple(dict.fromkeys((*verdict.disturbed, *placed.verdict.disturbed)))
    merged = verdict.model_copy(update={"placed": placed.verdict.placed, "damage": damage, "disturbed": disturbed})
    return placed.success and not damage, merged


def _first_motion(state: State) -> int:
    """Number of the first motion of this turn: what an earlier turn broke does not make this one fail."""
    return min([*(a.motion for a in state.attempts if a.turn == state.turn), *state.motions.values()], default=0)


def _told(state: State, goal: Goal, placement: Placement) -> Placement:
    """The placement as the observer checks it: in the robot's words.

    "Back" is where the trial began; of a thing that had been put elsewhere in between, only that it stands free.
    """
    if placement.kind == "back" and state.displaced.count(goal.target or "") > 1:
        return Placement(kind="aside")
    return in_robots_words(placement)


def _meant(goal: Goal, observer: Judge | None, motion: int | None) -> str | None:
    """Scene id of the thing meant, matched by the observer after the fact."""
    if observer is None or goal.target_position is None:
        return None
    return observer.meant(
        goal.target_category, goal.target_position, motion if goal.taken_in is None else goal.taken_in
    )


def _other(state: State, goal: Goal, observer: Judge, motion: int) -> str | None:
    """Scene id of the thing beside or on which something was to be placed."""
    target = goal.placement.target if goal.placement else None
    if target is None or state.percept is None:
        return None
    found = [obj for obj in state.percept.objects if obj.id == target]
    return observer.meant(found[0].category, found[0].position, motion) if found else None


def _observed(attempt: Attempt, meant: str | None, observer: Judge | None, since: int) -> ObservedAttempt:
    if observer is not None:
        return observer.judge(attempt.motion, meant, since=since)
    sensed = attempt.sensing
    own = Verdict(
        lifted_m=sensed.lift_height, held_s=sensed.held_s, slip_m=0.0, contact=attempt.claimed,
        aperture_m=sensed.aperture_end, peak_force_n=sensed.closing_force_peak, correct_object=attempt.claimed,
    )  # fmt: skip
    return ObservedAttempt(verdict=own, success=attempt.claimed, failure=attempt.failure)


def _attempt(attempt: Attempt, observed: ObservedAttempt) -> AttemptRecord:
    evidence: dict[str, Any] = attempt.sensing.model_dump()
    if attempt.camera is not None:
        evidence["camera"] = attempt.camera.model_dump()
    evidence["reasons"] = attempt.reasons
    evidence["confidence"] = attempt.confidence
    # That a person stopped it is an outcome, and none of the types of failure.
    stopped = attempt.stopped
    return AttemptRecord(
        level=attempt.level,
        grasp=GraspRecord(**attempt.plan.grasp.model_dump()),
        provenance=attempt.plan.provenance,
        quality=attempt.plan.quality,
        success=observed.success,
        claimed=attempt.claimed,
        failure=None if attempt.claimed or stopped else attempt.failure,
        evidence=evidence,
        correction=attempt.correction.model_dump() if attempt.correction else None,
        observed_failure=None if observed.success or stopped else observed.failure,
        verdict=observed.verdict,
        region=attempt.plan.region,
    )


def _damage(goal: GoalRecord) -> set[str]:
    verdicts = [a.verdict for a in goal.attempts] + [goal.verdict]
    return {name for verdict in verdicts if verdict is not None for name in verdict.damage}


def _damaged_between(state: State, observer: Judge | None) -> set[str]:
    """What came to harm in any motion of this turn: also while something was put back or the arm went home."""
    first = _first_motion(state)
    return set() if observer is None or first == 0 else set(observer.damaged(first))


def _constraints(state: State, attempts: list[Attempt], observer: Judge | None) -> tuple[ConstraintRecord, ...]:
    """Required (observer) and inferred (agent) constraints, matched by scene id and measured over the whole trial."""
    inferred: list[tuple[ConstraintKind, str]] = []
    for attempt in attempts:
        for item in attempt.constraints.active:
            name = _scene_id(attempt, item.target, observer)
            if name is not None and (item.kind, name) not in inferred:
                inferred.append((item.kind, name))
    for goal in state.goals:
        if goal.placement is not None and goal.placement.kind == "aside" and goal.parent is not None:
            name = _meant(goal, observer, None)
            if name is not None and ("support", name) not in inferred:
                inferred.append(("support", name))
    if observer is None:
        return tuple(
            ConstraintRecord(kind=kind, target=name, required=False, inferred=True, satisfied=False)
            for kind, name in inferred
        )
    return observer.constraints(inferred)


def _scene_id(attempt: Attempt, target: str, observer: Judge | None) -> str | None:
    if attempt.percept is None:
        return None
    found = [obj for obj in attempt.percept.objects if obj.id == target]
    if not found:
        return None
    return observer.meant(found[0].category, found[0].position, attempt.motion) if observer else target


def _experiences(state: State) -> tuple[ExperienceRecord, ...]:
    if state.shown is None:
        return ()
    return tuple(
        ExperienceRecord(
            id=item.experience.id, category=item.experience.category, s_cat=item.s_cat, s_aff=item.s_aff, s_vis=item.s_vis,
            score=item.score, success=item.experience.success,
        )
        for item in state.shown.top
    )  # fmt: skip


def _graph(state: State) -> GraphRecord:
    if state.graph is None:
        return GraphRecord()
    edges = tuple(EdgeRecord(source=e.source, relation=e.relation, target=e.target) for e in state.graph.edges)
    return GraphRecord(nodes=tuple(node.model_dump() for node in state.graph.nodes), edges=edges)


def timings(state: State, total: float) -> Timings:
    """Wall time of each stage of the turn, and of all of it, `total` [s]."""
    known = {key: state.times.get(key, 0.0) for key in ("perception", "retrieval", "planning", "execution", "brain")}
    return Timings(**known, total=total)
