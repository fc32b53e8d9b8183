"""Execute a planned grasp: the robot moves, closes, lifts, holds and shakes, and reports what it sensed."""

from __future__ import annotations

from kb.base import Noun
from kb.errors import BadInputError
from kb.grasp import MIN_FORCE
from kb.percept import PerceivedObject, Percept
from kb.sensing import Plan, Sensing
from kb.vocabulary import UNKNOWN_CATEGORY
from sim.grasp_motion import CREEPING
from sim.hand import TIP_BEYOND_TCP
from sim.quality import maximum_force
from tools.context import ToolContext
from tools.planning.force_choice import DAMAGE_SPREAD, force_cap
from tools.planning.lift_height import lift_height
from tools.planning.obstacles import obstacles

ABORT_FORCE = 30.0
"""Wrist force at which the reflex stops the hand [N] (benchmark.md section 3)."""
CAUTIOUS_FORCE = 5.0
"""The same where pictures are noisy [N]."""
GUARDED = 0.04
"""Speed [m/s] with which the hand goes where it may land on something sturdy: a fingertip that meets a cube presses
with 32 to 38 N then, with 182 to 191 at full speed; a banana 32 to 34 and 77 to 87, a screwdriver 43 to 45 and 174 to 221."""
LANDING = 50.0
"""Force that a thing must bear, by its fragility, for the hand to land on it at that speed [N]."""
STEEP = 0.7
"""Cosine to straight down up to which an approach comes from above."""
LEAST_CREEP, MOST_CREEP, SEEN_EARLY = 0.015, 0.040, 0.008
"""Shortest slow stretch, the longest per unit of noise, and how much earlier than the perceived near side it begins [m]."""
MOST_OF_STANDOFF = 0.75
"""Share of the stand-off that is gone slowly at most."""
LIFT_PEAK = 0.87
"""Share of the damage force that a grip raised during the test lift may take: lifting and shaking press a seventh more."""


class ExecuteArgs(Noun):
    """Arguments of `execute_grasp`."""

    plan: Plan
    percept: Percept
    """The look that the plan was made on: everything else on the table is kept clear of."""
    target: str
    """Perceived id."""
    weigh: bool = False
    """It slipped or was dropped before, so its category does not tell its weight: the test lift finds the force."""


def execute_grasp(args: ExecuteArgs, context: ToolContext) -> Sensing:
    """Carries out the grasp of a plan.

    Args:
        args: The plan, and what is around it.
        context: The robot.

    Returns:
        What joint encoders, motors, wrist and fingers sensed. A failed grasp is a value.

    Raises:
        BadInputError: if the target is not among the perceived objects.
    """
    try:
        target = args.percept.object(args.target)
    except KeyError:
        seen = [item.id for item in args.percept.objects]
        raise BadInputError(f"no object {args.target!r} in this percept", where="target", choices=seen) from None
    others = [other for other in args.percept.objects if other.id != args.target]
    # A force that a person named is kept: no test lift raises it.
    return context.robot.grasp(
        args.plan.grasp,
        joints=args.plan.joints or None,
        obstacles=obstacles(args.percept),
        force_limit=abort_force(target, args.percept.noise),
        lift=lift_height(args.plan.grasp.position, others),
        most_force=None
        if args.plan.own_force is not None
        else trial_lift_cap(target, args.plan.region, weigh=args.weigh),
        creep=creep(args.plan, target, args.percept.noise),
        creep_speed=creep_speed(target, args.percept.noise),
    )


def creep(plan: Plan, target: PerceivedObject, noise: float = 1.0) -> float:
    """Last stretch of the approach [m] that is gone slowly, because the hand may land on what is not where it was seen.

    It begins before the tips reach the near side of the thing. In pictures with more than ordinary noise (`Percept.noise`)
    anything may be met before it is seen: the noisier, the earlier.
    """
    grasp = plan.grasp
    longest = MOST_OF_STANDOFF * grasp.standoff
    if noise > 1.0:
        return min(longest, MOST_CREEP * noise)
    if grasp.approach[2] <= -STEEP:
        deep = (target.top_z - grasp.position[2] + TIP_BEYOND_TCP) / -grasp.approach[2]
    else:
        deep = max(target.size[:2]) / 2 + TIP_BEYOND_TCP
    return min(longest, max(LEAST_CREEP, deep + SEEN_EARLY))


def creep_speed(target: PerceivedObject, noise: float = 1.0) -> float:
    """Speed of that stretch [m/s]: slower for what does not bear a fingertip that lands at `GUARDED`."""
    most = max(target.affordance.fragility, *(target.fragility_range or (0.0,)))
    return (GUARDED if noise <= 1.0 and maximum_force(most) >= LANDING else CREEPING) / noise


def trial_lift_cap(target: PerceivedObject, region: str = "body", *, weigh: bool = False) -> float | None:
    """Force up to which a test lift may raise the grip [N]; None where nothing is to be learnt from it.

    The category of a known thing tells weight and friction, unless it has slipped (`weigh`). What hangs by a loop may turn until its weight is below the
    hand; pressing harder against that would only break the loop.
    """
    if target.category != UNKNOWN_CATEGORY:
        return force_cap(target.affordance.fragility) if weigh else None
    part = target.part("handle") if region == "handle" else None
    if part is not None and part.outward is not None:
        return None
    middle = target.affordance.fragility if target.fragility_range is None else sum(target.fragility_range) / 2
    if region == "stem" and target.fragility_range is not None:
        # Whatever has a stem is thin glass: what the weakest one bears is the limit.
        return max(MIN_FORCE, LIFT_PEAK * DAMAGE_SPREAD * maximum_force(target.fragility_range[1]))
    return force_cap(max(target.affordance.fragility, middle))


def abort_force(target: PerceivedObject, noise: float = 1.0) -> float:
    """Force on the hand before closing that stops it [N]: the lower of 30 N and half of what the target bears.

    In pictures with more than ordinary noise nobody knows what is met: what a creeping hand can tell from its own weight.
    """
    return min(ABORT_FORCE if noise <= 1.0 else CAUTIOUS_FORCE, 0.5 * maximum_force(target.affordance.fragility))
