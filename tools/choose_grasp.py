"""Choose a grasp: take one of the planned candidates and change its numbers within limits, or say why that must not be.

This is the physical half of the gate that every language model's choice passes: limits of the hand and the object first
(`tools.planning.grasp_limits`), then the swept hand's clearance, then the arm's own reach and joint limits.
"""

from __future__ import annotations

from typing import Any, get_args

from pydantic import Field

from kb.base import Finite, Noun
from kb.constraint import Constraints
from kb.errors import BadInputError
from kb.grasp import Grasp, GraspField, Provenance
from kb.percept import PerceivedObject, Percept
from kb.sensing import Plan
from sim.swept_hand import swept_clearance
from tools.context import ToolContext
from tools.plan_grasp import CLEARANCE, arm_way
from tools.planning.candidate import Candidate
from tools.planning.constrain_candidates import constrain
from tools.planning.generate_candidates import generate_candidates
from tools.planning.grasp_limits import refuse_grasp
from tools.planning.rank_candidates import estimate
from tools.planning.search import FREE

GRASP_FIELDS: tuple[GraspField, ...] = get_args(GraspField)
CHANGEABLE: tuple[GraspField, ...] = ("force", "aperture", "standoff", "speed")
"""Numbers that may be changed; place, direction and type come with the candidate."""


class ChooseArgs(Noun):
    """Arguments of `choose_grasp`."""

    plan: Plan
    percept: Percept
    constraints: Constraints = Field(default_factory=Constraints)
    candidate: str | None = None
    """Name of one of the plan's alternatives; None is the plan itself."""
    changes: dict[GraspField, Finite] = Field(default_factory=dict[GraspField, Finite])
    """New values of force [N], aperture [m], stand-off [m] or speed."""
    by: str = "brain"
    """Who chooses, for the provenance."""


class Choice(Noun):
    """The plan to execute, or why the choice is refused."""

    plan: Plan | None
    refused: str | None = None


def choose_grasp(args: ChooseArgs, context: ToolContext) -> Choice:
    """The plan with another candidate or other numbers, checked against hand, object, neighbours and arm.

    Args:
        args: The plan, what was perceived, and the choice.
        context: Robot (joint angles now).

    Returns:
        The plan with the chooser in the provenance of what changed, or None with the reason of the refusal.

    Raises:
        BadInputError: the plan's target is not among the perceived objects.
    """
    try:
        target = args.percept.object(args.plan.target)
    except KeyError:
        seen = [item.id for item in args.percept.objects]
        raise BadInputError(f"no object {args.plan.target!r} in this percept", where="plan", choices=seen) from None
    if args.candidate in (None, args.plan.candidate) and not args.changes:
        return Choice(plan=args.plan)
    base = _base(args, target)
    if base is None:
        known = ", ".join((args.plan.candidate, *(name for _, _, name in args.plan.alternatives)))
        return Choice(plan=None, refused=f"there is no candidate {args.candidate!r} (valid: {known})")
    foreign = sorted(set(args.changes) - set(CHANGEABLE))
    if foreign:
        return Choice(plan=None, refused=f"{', '.join(foreign)} cannot be changed (valid: {', '.join(CHANGEABLE)})")
    try:
        grasp = Grasp.model_validate(base.grasp.model_dump() | dict(args.changes))
    except ValueError as error:
        return Choice(plan=None, refused=f"not a grasp that the hand can do: {_first(error)}")
    reason = refuse_grasp(grasp, base.grasp, target, base.local_width)
    if reason is not None:
        return Choice(plan=None, refused=reason)
    return _checked(args, base, grasp, target, context)


def _first(error: Any) -> str:
    """The first complaint of a validation, in one line."""
    complaint = error.errors()[0]
    return f"{'.'.join(str(part) for part in complaint['loc'])}: {complaint['msg']}"


def _base(args: ChooseArgs, target: PerceivedObject) -> Plan | None:
    """The plan for the chosen candidate before its numbers are changed; None if there is no such candidate."""
    if args.candidate in (None, args.plan.candidate):
        return args.plan
    found = [grasp for grasp, _, name in args.plan.alternatives if name == args.candidate]
    place = place_named(args.candidate or "", target, args.constraints)
    if not found or place is None:
        return None
    provenance = dict(args.plan.provenance)
    for field in GRASP_FIELDS:
        value = getattr(found[0], field)
        if value != getattr(args.plan.grasp, field):
            provenance[field] = (Provenance(source="geometry", id=f"candidate {args.candidate}", value=value),)
    return args.plan.model_copy(
        update={
            "grasp": found[0], "region": place.region, "candidate": args.candidate, "local_width": place.width,
            "joints": (), "provenance": provenance,
        }
    )  # fmt: skip


def place_named(name: str, target: PerceivedObject, constraints: Constraints) -> Candidate | None:
    """The candidate of that name, found anew by the same geometry."""
    pool = constrain(generate_candidates(target), target, constraints, {})
    return next((item.candidate for item in pool if item.candidate.name == name), None)


def _checked(args: ChooseArgs, base: Plan, grasp: Grasp, target: PerceivedObject, context: ToolContext) -> Choice:
    """The plan with the chosen grasp, if neighbours and arm allow it."""
    way = arm_way(args.percept, target.id, context)
    clearance = min(FREE, swept_clearance(grasp, way.points_w)) if len(way.points_w) else FREE
    # As close as the plan itself comes is allowed: in a narrow place it has been found to be the best there is.
    if clearance < min(CLEARANCE, args.plan.clearance) - 1e-6:
        return Choice(
            plan=None, refused=f"the hand would come within {max(0.0, clearance) * 1000:.0f} mm of a neighbour"
        )
    joints = base.joints
    if not joints or {"standoff"} & set(args.changes):
        found = way.posture(grasp, whole=True, calm=False)
        if found is None:
            return Choice(plan=None, refused="the arm cannot reach that within its joint limits and keep clear")
        joints = found
    provenance = dict(base.provenance)
    for field, value in args.changes.items():
        said = Provenance(source="correction", id=args.by, value=value)
        provenance[field] = (*provenance.get(field, ()), said)
    place = place_named(base.candidate, target, args.constraints)
    mass, friction = sum(target.mass) / 2, sum(target.friction) / 2
    quality = base.quality if place is None else estimate(target, place, grasp, clearance, mass, friction)
    plan = base.model_copy(
        update={
            "grasp": grasp, "joints": joints, "clearance": clearance, "provenance": provenance, "quality": quality,
        }
    )  # fmt: skip
    return Choice(plan=plan)
