"""What a model is shown, as plain data: objects, relations, constraints, experiences, attempts, candidates, corrections."""

from __future__ import annotations

import math
from typing import Any

from agent import phrases
from agent.brain import Situation
from kb.experience import RetrievedExperience
from kb.grasp import Grasp
from kb.percept import PerceivedObject
from kb.sensing import Correction, Plan
from tools.planning.grasp_limits import force_bounds

MAX_SHOWN = 12
"""Objects, relations or attempts shown at most."""


def mark(object_id: str) -> str:
    """Number of the mark that stands for an object in a picture."""
    return object_id.rsplit("_", 1)[-1]


def objects(situation: Situation) -> list[dict[str, Any]]:
    """What is seen, with measures in centimetres."""
    if situation.percept is None:
        return []
    return [_object(obj) for obj in situation.percept.objects[:MAX_SHOWN]]


def _object(obj: PerceivedObject) -> dict[str, Any]:
    return {
        "mark": mark(obj.id),
        "category": obj.category,
        "confidence": round(obj.confidence, 2),
        "colour": obj.colour_name,
        "material": obj.affordance.material,
        "fragility": round(obj.affordance.fragility, 1),
        "state": obj.state,
        "size_cm": [round(100 * side, 1) for side in obj.size],
        "position_cm": [round(100 * side, 1) for side in obj.position],
    }


def goal(situation: Situation) -> dict[str, Any]:
    """The goal in work."""
    if situation.goal is None:
        return {}
    target = situation.goal.target
    return {"task": phrases.goal_words(situation.goal), "target_mark": mark(target) if target else None}


def relations(situation: Situation) -> list[str]:
    """The target's relations, by marks."""
    target = situation.goal.target if situation.goal else None
    if situation.graph is None or target is None:
        return []
    edges = [edge for edge in situation.graph.edges if edge.source == target]
    lines = []
    for edge in edges[:MAX_SHOWN]:
        gap = f" ({edge.gap * 100:.0f} cm)" if edge.gap is not None else ""
        lines.append(f"{mark(edge.source)} {edge.relation} {mark(edge.target)}{gap}")
    return lines


def constraints(situation: Situation) -> list[dict[str, Any]]:
    """The active constraints with their reasons."""
    return [{"kind": item.kind, "reason": item.reason} for item in situation.constraints.active[:MAX_SHOWN]]


def experiences(situation: Situation) -> list[dict[str, Any]]:
    """Few-shot examples: the retrieved successes, and what failed as well, each with what came of it."""
    if situation.retrieval is None:
        return []
    chosen = {item.experience.id: item for item in (*situation.retrieval.top, *situation.retrieval.avoid)}
    return [_experience(item) for item in list(chosen.values())[:6]]


def _experience(item: RetrievedExperience) -> dict[str, Any]:
    entry, way = item.experience, item.experience.strategy
    row: dict[str, Any] = {
        "object": f"{entry.category}, {entry.affordance.material}",
        "did": f"{way.type} grasp of the {way.region}, approach {way.approach}, {way.force:.1f} N",
        "worked": entry.success,
        "trials": f"{entry.n_success} of {entry.n_trials}",
    }
    if entry.failures:
        row["failed_by"] = max(entry.failures, key=lambda kind: entry.failures[kind])
    return row


def attempts(situation: Situation) -> list[dict[str, Any]]:
    """The failed attempts for this goal."""
    return [
        {
            "did": _grasp(attempt.plan.grasp, attempt.plan.region),
            "failed_by": attempt.failure,
            "confidence": round(attempt.confidence, 2),
            "readings": list(attempt.reasons),
        }
        for attempt in situation.tries[-4:]
    ]


def sensed(situation: Situation) -> dict[str, Any]:
    """Readings of the last attempt that tell failures apart."""
    if not situation.tries:
        return {}
    last = situation.tries[-1]
    felt = last.sensing
    return {
        "stopped_by": felt.stopped_by,
        "phase": felt.phase,
        "fingers_mm": [
            round(1000 * value, 1) for value in (felt.aperture_start, felt.aperture_closed, felt.aperture_end)
        ],
        "expected_width_mm": round(1000 * last.plan.local_width, 1),
        "load_g": round(1000 * felt.load_end),
        "approach_force_n": round(felt.approach_force, 1),
    }


def candidates(situation: Situation) -> list[dict[str, Any]]:
    """The planned grasp as number 0 with its limits, then its alternatives."""
    plan = situation.plan
    if plan is None or situation.percept is None:
        return []
    target = situation.percept.object(plan.target)
    low, high = force_bounds(plan.grasp.force, target)
    least = math.ceil(1000 * min(0.080, plan.local_width + 0.002))
    first: dict[str, Any] = {
        "number": 0,
        **_grasp(plan.grasp, plan.region),
        "quality": round(plan.quality.q, 2),
        "limits": {
            "force_n": [math.ceil(low), math.floor(high)],
            "opening_mm": [least, 80],
            "speed_percent": [10, round(100 * plan.grasp.speed)],
        },
    }
    others = [
        {"number": number, **_grasp(grasp, name.split("/")[0]), "score": round(score, 2)}
        for number, (grasp, score, name) in enumerate(plan.alternatives, start=1)
    ]
    return [first, *others]


def names(plan: Plan) -> tuple[str, ...]:
    """Names of the candidates, by the numbers under which they are shown."""
    return (plan.candidate, *(name for _, _, name in plan.alternatives))


def _grasp(grasp: Grasp, region: str) -> dict[str, Any]:
    tilt = math.degrees(math.acos(max(-1.0, min(1.0, -grasp.approach[2]))))
    return {
        "region": region,
        "type": grasp.type,
        "tilt_degrees": round(tilt),
        "force_n": round(grasp.force, 1),
        "opening_mm": round(1000 * grasp.aperture),
        "speed_percent": round(100 * grasp.speed),
    }


def corrections(allowed: tuple[Correction, ...]) -> list[dict[str, Any]]:
    """The corrections to choose from, by number."""
    return [
        {
            "number": number,
            "level": item.level,
            "rule": item.rule,
            "changes": {key: value for key, value in item.changes.items()},
        }
        for number, item in enumerate(allowed)
    ]
