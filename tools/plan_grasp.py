"""Plan a grasp: experience says how, geometry says where, constraints say what not, and every number says why.

The experience (or an earlier success of this episode) gives region, type, approach, force and depth; geometry gives the
candidates on the perceived object; constraints and the clearance of the swept hand prune and score them; the arm's reach
decides last. This module knows neither how objects were perceived nor what is true.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
from pydantic import Field, field_validator

from kb.base import Noun
from kb.constraint import Constraints
from kb.errors import BadInputError
from kb.experience import Retrieval
from kb.grasp import MAX_APERTURE
from kb.percept import PerceivedObject, Percept
from kb.sensing import Correction, Plan
from sim.quality import WIDEST_OBJECT
from tools.context import ToolContext
from tools.planning.candidate import Candidate
from tools.planning.constrain_candidates import Constrained, constrain
from tools.planning.demand import Demand, demanded, impose
from tools.planning.force_choice import ForceTerms, force_terms
from tools.planning.generate_candidates import generate_candidates
from tools.planning.grasp_prior import GraspPrior, prior_chain
from tools.planning.literal_plan import literal_candidate
from tools.planning.obstacles import obstacles
from tools.planning.posture import ArmWay, Posture
from tools.planning.rank_candidates import Ranked, estimate, lessons
from tools.planning.remembered import RememberedGrasp
from tools.planning.search import Search
from tools.planning.shape_grasp import explain, shape_grasp
from tools.planning.surroundings import own_points, surroundings

FRESH_DRAW = 0.5
"""Chance of each candidate to be considered in a retry without diagnosis (configuration `blind_retry`)."""
CLEARANCE = 0.006
"""Clearance wanted from everything perceived [m]; scaled by the margins of constraints and corrections."""
LAST_CLEARANCES = (0.003, -0.001)
"""If nothing has that much, any region with this much is taken [m]; the last is contact within perception's error."""


class PlanArgs(Noun):
    """Arguments of `plan_grasp`."""

    percept: Percept
    target: str
    """Perceived id."""
    retrieval: Retrieval | None = None
    constraints: Constraints = Field(default_factory=Constraints)
    memory: RememberedGrasp | None = None
    """An earlier success that fits, as recalled from the episodic memory."""
    correction: Correction | None = None
    """What the reflection changes after a failure."""
    tried: tuple[Plan, ...] = ()
    """Plans of this goal that failed."""
    attempt: int = 0
    demands: tuple[Demand, ...] = ()
    """What the person said about how to do it."""

    @field_validator("memory", mode="before")
    @classmethod
    def _from_memory(cls, value: Any) -> Any:
        return RememberedGrasp.of(value)


class PlanOutcome(Noun):
    """A plan, or why there is none."""

    plan: Plan | None
    reason: str
    """One sentence: why this grasp, or why none."""
    rejected: dict[str, int] = Field(default_factory=dict)
    """Reason -> number of candidates."""


def plan_grasp(args: PlanArgs, context: ToolContext) -> PlanOutcome:
    """Plans one grasp of the target.

    Args:
        args: What was perceived, retrieved, inferred and remembered, and the correction after a failure.
        context: Robot (joint angles now), switches, and random generator (retries without diagnosis).

    Returns:
        The plan with the provenance of each number, or None with the reasons counted.

    Raises:
        BadInputError: if the target is not among the perceived objects.
    """
    subject = _subject(args)
    switches = context.switches
    correction = args.correction
    exclude = correction.exclude if correction else ()
    chain = prior_chain(subject, args.retrieval, args.memory, switches, exclude)
    if correction and ({"type", "approach"} & set(correction.changes) or correction.region):
        chain = tuple(_corrected(prior, correction) for prior in chain)
    if not switches.geometric_candidates:
        literal = _literal(args, subject, chain[0], context)
        return literal.model_copy(update={"plan": impose(literal.plan, args.demands)}) if literal.plan else literal
    rejected: dict[str, int] = {}
    way = arm_way(args.percept, subject.id, context)
    candidates = _usable(generate_candidates(subject), exclude, rejected)
    if args.attempt > 0 and not switches.diagnosis_used:
        # A blind retry: nothing is known of what failed, so a fresh draw decides what is considered at all.
        candidates = [item for item in candidates if context.rng.random() < FRESH_DRAW] or candidates
    pool = demanded(constrain(candidates, subject, args.constraints, rejected), args.demands, rejected)
    search = Search(
        subject=subject,
        constraints=args.constraints,
        correction=correction,
        avoid=lessons(args.retrieval) if switches.prior == "experience" else (),
        neighbours_w=way.points_w,
        own_w=own_points(subject),
        use_clearance=switches.clearance,
        way=way,
        spare=context.alternatives,
        rejected=rejected,
    )
    avoided = correction.avoid_regions if correction else ()
    elsewhere = [item for item in pool if item.candidate.region not in avoided]
    found = _search(search, elsewhere, chain, args) if avoided else None
    if found is None:
        found = _search(search, pool, chain, args)
    if found is None:
        return PlanOutcome(
            plan=None, reason=_why_none(rejected, len(candidates)), rejected=dict(sorted(rejected.items()))
        )
    ranked, posture, prior, force = found
    plan = impose(_plan(search, ranked, posture, prior, force, args), args.demands)
    return PlanOutcome(plan=plan, reason=_why(plan, prior), rejected=plan.rejected)


def arm_way(percept: Percept, target: str, context: ToolContext) -> ArmWay:
    """The arm as it stands, and all that was perceived around the target."""
    start = np.asarray(context.robot.joints, float)
    others = tuple(other for other in percept.objects if other.id != target)
    return ArmWay(start, surroundings(percept, target), obstacles(percept), others, has_arm(context.robot))


def has_arm(robot: Any) -> bool:
    """Whether the robot's links take up room: the analytic evaluator's do not."""
    return bool(getattr(robot, "has_arm", True))


def _subject(args: PlanArgs) -> PerceivedObject:
    try:
        return args.percept.object(args.target)
    except KeyError:
        seen = [item.id for item in args.percept.objects]
        raise BadInputError(f"no object {args.target!r} in this percept", where="target", choices=seen) from None


def _corrected(prior: GraspPrior, correction: Correction) -> GraspPrior:
    """The prior with the type, region or approach that the correction demands."""
    changes = correction.changes
    if "type" in changes:
        type_ = str(changes["type"])
        prior = replace(prior, type=type_, approach=None, tilt=None, depth=None)  # pyright: ignore[reportArgumentType]
    if "approach" in changes:
        prior = replace(prior, approach="top", tilt=0.0, depth=None)
    if correction.region is not None:
        prior = replace(prior, region=correction.region)  # pyright: ignore[reportArgumentType]
    return prior


def _usable(candidates: list[Candidate], exclude: tuple[str, ...], rejected: dict[str, int]) -> list[Candidate]:
    """Candidates that fit into the hand and were not excluded by the reflection."""
    # The lean away from neighbours is drawn anew, so it doesn't count as another place.
    places = {name.split("/lean")[0] for name in exclude}
    kept: list[Candidate] = []
    for candidate in candidates:
        if candidate.width > WIDEST_OBJECT + 0.0035:
            rejected["wider than the hand opens"] = rejected.get("wider than the hand opens", 0) + 1
        elif candidate.name in places:
            rejected["failed before"] = rejected.get("failed before", 0) + 1
        else:
            kept.append(candidate)
    return kept


def _search(
    search: Search, pool: list[Constrained], chain: tuple[GraspPrior, ...], args: PlanArgs
) -> tuple[Ranked, Posture, GraspPrior, ForceTerms] | None:
    """Regions in the order of the priors with full clearance, then any region with less and less of it."""
    margin = args.constraints.adjustment.margin * (args.correction.margin if args.correction else 1.0)
    wanted = args.correction.changes.get("type") if args.correction else None
    stages: list[tuple[list[Constrained], GraspPrior, float]] = []
    search.calm = True
    for type_ in dict.fromkeys((wanted, None)):
        typed = [item for item in pool if type_ is None or item.candidate.type == type_]
        for prior in chain:
            group = [item for item in typed if prior.region is None or item.candidate.region == prior.region]
            stages.append((group, prior, CLEARANCE * margin))
        stages.append((typed, chain[0], CLEARANCE * margin))
    regular = len(stages)
    stages += [(pool, chain[0], required) for required in (CLEARANCE * margin, *LAST_CLEARANCES)]
    for number, (group, prior, required) in enumerate(stages):
        if number == regular:
            search.accept_any_posture()
        force = _force(args, search.subject, prior)
        found = search.best(group, prior, force, required) if group else None
        if found is not None:
            return (*found, prior, force)
    return None


def _force(args: PlanArgs, subject: PerceivedObject, prior: GraspPrior) -> ForceTerms:
    correction = args.correction
    corrected = correction.changes.get("force") if correction else None
    kinds = [f"{item.kind}:{item.target}" for item in args.constraints.active if item.kind == "collision"]
    return force_terms(
        subject,
        prior,
        scale=args.constraints.adjustment.force_scale,
        scale_reason=",".join(kinds) or "constraints",
        corrected=float(str(corrected)) if corrected is not None else None,
        rule=correction.rule if correction else "",
        filled=any(item.kind == "content" for item in args.constraints.active),
    )


def _plan(
    search: Search, ranked: Ranked, posture: Posture, prior: GraspPrior, force: ForceTerms, args: PlanArgs
) -> Plan:
    candidate = ranked.item.candidate
    ledger = explain(ranked.item, ranked.grasp, prior, force, args.constraints, args.correction, ranked.clearance)
    others = sorted(search.alternatives, key=lambda pair: -pair[0].score)
    return Plan(
        grasp=ranked.grasp,
        provenance=ledger.done(),
        quality=ranked.quality,
        region=candidate.region,
        target=args.target,
        candidate=candidate.name,
        joints=posture,
        clearance=ranked.clearance,
        local_width=candidate.width,
        rejected=dict(sorted(search.rejected.items())),
        alternatives=tuple((other.grasp, round(other.score, 4), other.item.candidate.name) for other, _ in others),
        score=round(ranked.score, 4),
    )


def _literal(args: PlanArgs, subject: PerceivedObject, prior: GraspPrior, context: ToolContext) -> PlanOutcome:
    """The stored parameters as they are, adjusted by the constraints only."""
    adjustment = args.constraints.adjustment
    candidate = literal_candidate(subject, prior, adjustment)
    item = Constrained(candidate, 0.0)
    force = replace(_force(args, subject, prior), literal=True)
    opening = prior.aperture if prior.aperture is not None else MAX_APERTURE
    if args.correction and "aperture" in args.correction.changes:
        opening = min(MAX_APERTURE, float(str(args.correction.changes["aperture"])))
    grasp = shape_grasp(item, subject, prior, force, args.constraints, args.correction, opening=opening)
    quality = estimate(subject, candidate, grasp, 0.02, force.mass, force.friction)
    posture = arm_way(args.percept, subject.id, context).posture(grasp, whole=False, calm=False)
    ledger = explain(item, grasp, prior, force, args.constraints, args.correction, math.inf)
    plan = Plan(
        grasp=grasp,
        provenance=ledger.done(),
        quality=quality,
        region=candidate.region,
        target=args.target,
        candidate=candidate.name,
        joints=posture or (),
        local_width=candidate.width,
    )
    return PlanOutcome(plan=plan, reason=_why(plan, prior))


def _why(plan: Plan, prior: GraspPrior) -> str:
    said = f"{prior.source} {prior.id}" if plan.region == prior.region else "geometry"
    return (
        f"{plan.grasp.type} grasp of the {plan.region} ({said}), {1000 * plan.local_width:.0f} mm wide, "
        f"{plan.grasp.force:.1f} N, quality {plan.quality.q:.2f}"
    )


def _why_none(rejected: dict[str, int], considered: int) -> str:
    if not rejected:
        return "the object offers no place that this hand can hold"
    worst = ", ".join(f"{count} {reason}" for reason, count in sorted(rejected.items(), key=lambda kv: -kv[1]))
    return f"none of {considered} candidates can be executed: {worst}"
