"""What a person demands of a grasp: hard limits on the candidates, and numbers that replace those of the plan.

A demand is a constraint with a provenance of its own: its id is the person's words.
"""

from __future__ import annotations

import math
from typing import Annotated, Any

from pydantic import Field

from kb.base import Finite, Noun
from kb.experience import ApproachClass
from kb.grasp import MAX_APERTURE, MAX_FORCE, MIN_FORCE, Grasp, GraspField, Provenance
from kb.sensing import Plan
from kb.vocabulary import GraspType, Region
from tools.planning.candidate import approach_class
from tools.planning.constrain_candidates import Constrained

SLOWEST, FASTEST = 0.1, 1.0
"""Limits of the velocity scale (kb.grasp)."""


class Demand(Noun):
    """One wish of the person. What is None is left to the planner."""

    words: str
    """As the person said it."""
    region: Region | None = None
    not_region: Region | None = None
    type: GraspType | None = None
    approach: ApproachClass | None = None
    candidate: str | None = None
    """Name of the one candidate to take."""
    yaw: Finite | None = None
    """[rad]"""
    force: Annotated[float, Field(ge=MIN_FORCE, le=MAX_FORCE)] | None = None
    """[N]"""
    force_scale: Annotated[float, Field(gt=0.0, le=4.0)] = 1.0
    aperture: Annotated[float, Field(ge=0.0, le=MAX_APERTURE)] | None = None
    """[m]"""
    speed: Annotated[float, Field(ge=SLOWEST, le=FASTEST)] | None = None
    speed_scale: Annotated[float, Field(gt=0.0, le=4.0)] = 1.0

    @property
    def id(self) -> str:
        """As in provenance."""
        return f'person: "{self.words}"'

    @property
    def where(self) -> bool:
        """Whether it limits where or how the hand closes, not only numbers."""
        limits = (self.region, self.not_region, self.type, self.approach, self.candidate)
        return any(limit is not None for limit in limits)


def demanded(candidates: list[Constrained], demands: tuple[Demand, ...], rejected: dict[str, int]) -> list[Constrained]:
    """The candidates that do what the person demands; the others are counted under the person's words."""
    for demand in demands:
        kept = [item for item in candidates if _does(item, demand)]
        if len(kept) < len(candidates):
            reason = f'not as you said ("{demand.words}")'
            rejected[reason] = rejected.get(reason, 0) + len(candidates) - len(kept)
        candidates = kept
    return candidates


def _does(item: Constrained, demand: Demand) -> bool:
    candidate = item.candidate
    return (
        demand.region in (None, candidate.region)
        and demand.not_region != candidate.region
        and demand.type in (None, candidate.type)
        and demand.approach in (None, candidate.approach_class)
        and (demand.candidate is None or candidate.name.split("/lean")[0] == demand.candidate.split("/lean")[0])
    )


def impose(plan: Plan, demands: tuple[Demand, ...]) -> Plan:
    """The plan with the demanded numbers, within the hand's limits, and the person among the sources."""
    for demand in demands:
        changes = _numbers(plan.grasp, demand)
        provenance = dict(plan.provenance)
        said = _places(plan.grasp, demand) | changes
        for field, value in said.items():
            provenance[field] = (
                *provenance.get(field, ()),
                Provenance(source="constraint", id=demand.id, value=value),
            )
        grasp = plan.grasp.model_copy(update={str(field): value for field, value in changes.items()})
        joints = () if "yaw" in changes else plan.joints
        own = plan.own_force if demand.force is None or plan.own_force is not None else plan.grasp.force
        changed = {"grasp": grasp, "provenance": provenance, "joints": joints, "own_force": own}
        plan = plan.model_copy(update=changed)
    return plan


def said_by_person(plan: Plan, field: GraspField) -> bool:
    """Whether a person had a word in a number of the plan."""
    return any(step.id.startswith("person") for step in plan.provenance.get(field, ()))


def _numbers(grasp: Grasp, demand: Demand) -> dict[GraspField, Any]:
    """New values per field."""
    changes: dict[GraspField, Any] = {}
    force = demand.force if demand.force is not None else grasp.force * demand.force_scale
    speed = demand.speed if demand.speed is not None else grasp.speed * demand.speed_scale
    if demand.force is not None or demand.force_scale != 1.0:
        changes["force"] = min(MAX_FORCE, max(MIN_FORCE, force))
    if demand.speed is not None or demand.speed_scale != 1.0:
        changes["speed"] = min(FASTEST, max(SLOWEST, speed))
    if demand.aperture is not None:
        changes["aperture"] = demand.aperture
    if demand.yaw is not None and abs(math.remainder(demand.yaw - grasp.yaw, math.pi)) > 1e-6:
        changes["yaw"] = demand.yaw
    return changes


def _places(grasp: Grasp, demand: Demand) -> dict[GraspField, Any]:
    """What the demand said about where and how the hand closes."""
    said: dict[GraspField, Any] = {}
    place = demand.candidate or demand.region or (f"not {demand.not_region}" if demand.not_region else None)
    if place is not None:
        said["position"] = place
    if demand.type is not None:
        said["type"] = grasp.type
    if demand.approach is not None:
        tilt = math.acos(max(-1.0, min(1.0, -grasp.approach[2])))
        said["approach"] = approach_class(tilt)
    return said
