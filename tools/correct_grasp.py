"""Choose the correction of a failed grasp at the level of the attempt being prepared (Sec. IV-B; ledger G18, G19).

Level 1 tunes parameters by the rule of the failure type, bent by what was measured; level 2 rotates the grasp type with
10 % less force; level 3 plans anew from the next unused experience with a perturbed position.
"""

from __future__ import annotations

from typing import Any

from pydantic import Field

from kb.base import Finite, Noun, Vec3
from kb.constraint import Constraints
from kb.corrections import LEVEL2_FORCE_SCALE, LEVEL3_NOISE, TYPE_ROTATION, correction_rule
from kb.experience import Retrieval
from kb.grasp import MAX_APERTURE, MAX_FORCE, MIN_FORCE, GraspField
from kb.sensing import Correction, Evidence, Plan
from kb.vocabulary import AffordanceType, FailureType, GraspType
from sim.quality import THRESHOLDS, TYPE_MATCH, minimum_force
from tools.context import ToolContext

MOVED_PLACES: frozenset[FailureType] = frozenset(
    {"COLLISION", "APPROACH_ANGLE", "ORIENTATION", "UNREACHABLE_POSE", "CONSTRAINT_VIOLATION"}
)
"""Failures that say the place was wrong, so that the same candidate isn't tried again."""
TOO_WEAK: frozenset[FailureType | None] = frozenset({"SLIP", "DROP"})
"""Failures that say that the category did not tell the weight."""
LEARNT_MARGIN = 1.1
"""Distance kept from forces that are known to fail, as a factor."""
SQUEEZED_OUT = 0.6
"""Share of the local width below which the fingers closed on little or nothing after having met the object."""


class CorrectArgs(Noun):
    """Arguments of `correct_grasp`."""

    failure: FailureType
    level: int = Field(ge=1, le=3)
    """Level of the attempt being prepared."""
    plan: Plan
    """The plan that failed."""
    evidence: Evidence
    affordance: AffordanceType | None = None
    """Of the target as perceived: types that don't fit it are skipped."""
    retrieval: Retrieval | None = None
    constraints: Constraints = Field(default_factory=Constraints)
    history: tuple[Any, ...] = ()
    """Earlier failed attempts of the goal: anything with `candidate`, `region`, `grasp` and `experiences`."""


def correct_grasp(args: CorrectArgs, context: ToolContext) -> Correction:
    """The correction for the next attempt.

    Args:
        args: What failed, how, at which level, and what was tried before.
        context: Random generator for level 3's perturbation.

    Returns:
        Changes to be applied by `plan_grasp` on freshly perceived geometry.
    """
    if args.level == 1:
        correction = _tune(args)
    elif args.level == 2:
        correction = _rotate_type(args)
    else:
        correction = _replan(args, context)
    failures = {args.failure, *(getattr(entry, "failure", None) for entry in args.history)}
    return correction.model_copy(update={"weigh": bool(failures & TOO_WEAK)})


def _tune(args: CorrectArgs) -> Correction:
    """Level 1: the rule of the failure type."""
    rule, grasp = correction_rule(args.failure), args.plan.grasp
    changes: dict[GraspField, Finite | str | Vec3] = {}
    for field, factor in rule.scale.items():
        changes[field] = float(getattr(grasp, field)) * factor
    for field, summand in rule.add.items():
        changes[field] = float(getattr(grasp, field)) + summand
    changes.update(rule.set)
    offset: Vec3 = (0.0, 0.0, 0.0)
    name, margin = rule.name, 1.0
    exclude = (args.plan.candidate,) if args.failure in MOVED_PLACES else ()
    for action in rule.actions:
        if action == "lower_if_squeezed_out" and squeezed_out(args):
            # Leaving while closing is no lack of force: more would press it out faster (physics.md).
            changes.pop("force", None)
            offset, name = (0.0, 0.0, -(rule.amount or 0.0)), "squeeze-out: lower, not stronger"
        elif action == "approach_vertical":
            changes["approach"] = (0.0, 0.0, -1.0)
        elif action == "widen_margins":
            margin = rule.amount or 1.0
        elif action == "next_experience":
            exclude = (*exclude, *used_experiences(args.plan))
        elif action == "other_region_if_fully_open" and grasp.aperture >= MAX_APERTURE - 1e-6:
            # Nothing is gained by opening wider than the hand can: another place must do.
            changes.pop("aperture", None)
            exclude = (*exclude, args.plan.candidate)
    if args.failure == "COLLISION":
        margin = 1.5
    return _tidy(args, Correction(
        failure=args.failure, level=1, rule=name, changes=changes, offset=offset, exclude=_all_excluded(args, exclude),
        margin=margin,
    ))  # fmt: skip


def squeezed_out(args: CorrectArgs) -> bool:
    """Whether the object left while the fingers closed, rather than sank while they rose."""
    sensed = args.evidence.sensing
    return sensed.load_lifted < 0.01 and sensed.aperture_closed < SQUEEZED_OUT * args.plan.local_width


def _rotate_type(args: CorrectArgs) -> Correction:
    """Level 2: power -> pinch -> side -> power, skipping types unfit for the affordance, force x 0.9 (G19b)."""
    current = args.plan.grasp.type
    order: tuple[GraspType, ...] = (
        TYPE_ROTATION[TYPE_ROTATION.index(current) + 1 :] + TYPE_ROTATION[: TYPE_ROTATION.index(current)]
    )
    fits: list[GraspType] = [type_ for type_ in order if _fits(type_, args)]
    chosen: GraspType = fits[0] if fits else order[0]
    force = max(MIN_FORCE, args.plan.grasp.force * LEVEL2_FORCE_SCALE)
    return _tidy(args, Correction(
        failure=args.failure, level=2, rule=f"type {current} -> {chosen}, force x {LEVEL2_FORCE_SCALE:g}",
        changes={"type": chosen, "force": force}, exclude=_all_excluded(args, (args.plan.candidate,)),
        avoid_regions=missed_regions(args),
    ))  # fmt: skip


def _fits(type_: GraspType, args: CorrectArgs) -> bool:
    kind = args.affordance
    if kind is None and args.retrieval is not None and args.retrieval.top:
        kind = args.retrieval.top[0].experience.affordance.type
    return kind is None or TYPE_MATCH[kind][type_] >= THRESHOLDS[3]


def _replan(args: CorrectArgs, context: ToolContext) -> Correction:
    """Level 3: next unused experience, constraints anew, epsilon ~ U(-0.01, 0.01)^3 on the position only (G19c)."""
    noise = context.rng.uniform(-LEVEL3_NOISE, LEVEL3_NOISE, 3)
    offset: Vec3 = (float(noise[0]), float(noise[1]), float(noise[2]))
    exclude = _all_excluded(args, (args.plan.candidate, *used_experiences(args.plan)))
    return Correction(
        failure=args.failure, level=3, rule="plan anew from the next experience, position +- 1 cm", offset=offset,
        exclude=exclude, avoid_regions=missed_regions(args),
    )  # fmt: skip


def missed_regions(args: CorrectArgs) -> tuple[str, ...]:
    """Regions that were met elsewhere than seen twice, the second time after a new look: they are not what they seem."""
    missed = [entry.region for entry in args.history if getattr(entry, "failure", None) == "POSITION_ERROR"]
    return tuple(dict.fromkeys(region for region in missed if missed.count(region) > 1))


def used_experiences(plan: Plan) -> tuple[str, ...]:
    """Ids of the experiences and memories that a plan's numbers come from."""
    ids = {step.id for steps in plan.provenance.values() for step in steps if step.source in ("experience", "memory")}
    return tuple(sorted(ids))


def _all_excluded(args: CorrectArgs, more: tuple[str, ...]) -> tuple[str, ...]:
    """What this correction excludes, with the candidates that failed for their place before."""
    earlier = [
        entry.candidate
        for entry in args.history
        if getattr(entry, "candidate", "") and getattr(entry, "failure", None) in MOVED_PLACES
    ]
    return tuple(dict.fromkeys((*more, *earlier)))


def known_bounds(args: CorrectArgs) -> tuple[float, float]:
    """Forces between which the retrieved experiences leave room [N]: above what slipped, below what broke.

    Only failures of the same region count; they are the contrast for which failed entries are kept (ledger A1.8).
    """
    low, high = 0.0, MAX_FORCE
    if args.retrieval is None:
        return low, high
    for item in {entry.experience.id: entry for entry in (*args.retrieval.avoid, *args.retrieval.top)}.values():
        entry = item.experience
        if entry.success or item.s_cat < 1.0 or entry.strategy.region != args.plan.region or not entry.failures:
            continue
        main = max(entry.failures, key=lambda kind: entry.failures[kind])
        if main in ("SLIP", "DROP"):
            low = max(low, entry.strategy.force)
        elif main in ("FORCE_DAMAGE", "DEFORMATION"):
            high = min(high, entry.strategy.force)
    return (low, high) if low < high else (0.0, MAX_FORCE)


def _tidy(args: CorrectArgs, correction: Correction) -> Correction:
    """Keeps the changed numbers within the hand's limits and within what was weighed and what is known to fail."""
    changes = dict(correction.changes)
    if "force" in changes:
        force = float(str(changes["force"]))
        low, high = known_bounds(args)
        force = min(max(force, LEARNT_MARGIN * low), high / LEARNT_MARGIN)
        load = max(args.evidence.sensing.load_lifted, args.evidence.sensing.load_end)
        if load > 0.01 and correction.failure in ("SLIP", "DROP"):
            # The wrist has weighed it: friction assumed low, the force must hold that mass.
            force = max(force, minimum_force(load, 0.4))
        changes["force"] = min(MAX_FORCE, max(MIN_FORCE, force))
    if "aperture" in changes:
        changes["aperture"] = min(MAX_APERTURE, float(str(changes["aperture"])))
    if "standoff" in changes:
        changes["standoff"] = min(0.20, float(str(changes["standoff"])))
    if "speed" in changes:
        changes["speed"] = min(1.0, max(0.1, float(str(changes["speed"]))))
    return correction.model_copy(update={"changes": changes})
