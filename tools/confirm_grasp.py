"""Confirm a grasp by doing it again: set the object down where it stood, look, and lift it by the same strategy.

A claim of success may be wrong; that two independent lifts are both wrongly claimed is much rarer. What is learnt counts
only what was confirmed.
"""

from __future__ import annotations

import math
from typing import cast

from kb.base import Noun
from kb.constraint import Constraints
from kb.experience import Experience, Funnel, Retrieval, RetrievedExperience, Strategy
from kb.percept import PerceivedObject, Percept
from kb.sensing import Evidence, Plan, Sensing
from kb.vocabulary import Region
from tools.classify_failure import ClassifyArgs, Diagnosis, classify_failure
from tools.context import ToolContext
from tools.diagnosis.held_look import look_at_places, worth_a_look
from tools.execute_grasp import ExecuteArgs, execute_grasp
from tools.perceive import PerceiveArgs, perceive
from tools.place_object import PlaceArgs, place_object
from tools.plan_grasp import PlanArgs, plan_grasp
from tools.planning.candidate import approach_class, depth_of

SAME_PLACE = 0.10
"""After the set-down the object is looked for within this distance of where it was put [m]."""


class ConfirmArgs(Noun):
    """Arguments of `confirm_grasp`."""

    plan: Plan
    """The grasp that was claimed to have succeeded; the object is in the hand."""
    object: PerceivedObject
    """The object as it stood before."""
    percept: Percept
    """The look that the grasp was planned on."""
    constraints: Constraints


class Confirmation(Noun):
    """What came of it."""

    confirmed: bool
    says: str
    set_down: Sensing | None = None
    lift: Sensing | None = None


def confirm_grasp(args: ConfirmArgs, context: ToolContext) -> Confirmation:
    """Sets the held object down and lifts it again by the same strategy.

    Args:
        args: What is held, how, and what stood around.
        context: Robot and perceiver.

    Returns:
        Whether the second lift was claimed, too, and what was sensed.
    """
    spot = (args.object.position[0], args.object.position[1])
    down = place_object(
        PlaceArgs(percept=args.percept, held=args.plan, object=args.object, kind="point", point=spot), context
    )
    if down.stopped_by is not None:
        return Confirmation(confirmed=False, says=f"it could not be set down ({down.stopped_by})", set_down=down)
    look = args.percept.look + 1
    percept = perceive(PerceiveArgs(look=look, previous=args.percept), context)
    target = _found(percept, args.object)
    if target is None:
        return Confirmation(confirmed=False, says="it was not seen where it was set down", set_down=down)
    again = plan_grasp(
        PlanArgs(percept=percept, target=target.id, retrieval=_as_retrieval(args), constraints=args.constraints),
        context,
    )
    if again.plan is None:
        return Confirmation(confirmed=False, says=f"no second plan: {again.reason}", set_down=down)
    lift = execute_grasp(ExecuteArgs(plan=again.plan, percept=percept, target=target.id), context)
    word = _diagnosed(args, again.plan, lift, percept, target, context)
    says = "lifted again" if word.claimed else f"the second lift failed: {word.failure}"
    return Confirmation(confirmed=word.claimed, says=says, set_down=down, lift=lift)


def _diagnosed(
    args: ConfirmArgs, plan: Plan, lift: Sensing, percept: Percept, target: PerceivedObject, context: ToolContext
) -> Diagnosis:
    """The robot's word on the second lift, after a look at what left its place where that is in doubt."""
    asked = ClassifyArgs(
        plan=plan, evidence=Evidence(sensing=lift), constraints=args.constraints, target=target, percept=percept
    )
    word = classify_failure(asked, context)
    if not worth_a_look(lift, percept, target, sure=word.claimed):
        return word
    places = look_at_places(lift, percept, target, context)
    return classify_failure(asked.model_copy(update={"evidence": Evidence(sensing=lift, places=places)}), context)


def strategy_of(plan: Plan, subject: PerceivedObject) -> Strategy:
    """The transferable part of a plan."""
    grasp = plan.grasp
    tilt = math.acos(max(-1.0, min(1.0, -grasp.approach[2])))
    return Strategy(
        region=cast(Region, plan.region),
        type=grasp.type,
        approach=approach_class(tilt),
        tilt=tilt,
        force=grasp.force,
        force_band=(grasp.force, grasp.force),
        aperture=grasp.aperture,
        depth=depth_of(subject, grasp.position[2]),
        standoff=grasp.standoff,
        speed=grasp.speed,
    )


def _found(percept: Percept, before: PerceivedObject) -> PerceivedObject | None:
    """The object nearest to where it was put, if near enough."""

    def distance(item: PerceivedObject) -> float:
        dx, dy = item.position[0] - before.position[0], item.position[1] - before.position[1]
        return (dx * dx + dy * dy) ** 0.5

    near = [item for item in percept.objects if distance(item) <= SAME_PLACE]
    return min(near, key=distance, default=None)


def _as_retrieval(args: ConfirmArgs) -> Retrieval:
    """The strategy that is to be repeated, as if it had been retrieved."""
    seen = args.object
    entry = Experience(
        id="repeated", category=seen.category, affordance=seen.affordance, size=seen.size, mass=seen.mass[1],
        strategy=strategy_of(args.plan, seen), success=True, n_trials=1, n_success=1, embedding=(), embedder="",
        seeds=(0, 0),
    )  # fmt: skip
    item = RetrievedExperience(experience=entry, s_cat=0.0, s_aff=1.0, s_vis=0.0, score=1.0)
    return Retrieval(top=(item,), funnel=Funnel(total=1, level1=1, level2=1, level3=1, fallback=False))
