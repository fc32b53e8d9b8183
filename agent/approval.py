"""What a person is asked before a motion, and what they may decide."""

from __future__ import annotations

import math
from typing import Any, Literal

from agent.state import State
from kb.base import Finite, Noun
from kb.errors import BadInputError
from kb.grasp import Grasp, GraspField, Provenance
from kb.sensing import Plan

Verb = Literal["approve", "reject", "edit", "steer"]


class Decision(Noun):
    """A person's word about the proposed motion."""

    verdict: Verb
    grasp: Grasp | None = None
    """The edited grasp, for "edit"."""
    words: str = ""
    """How it should be done instead, for "steer"."""


class Proposal(Noun):
    """What the person sees."""

    instruction: str
    goal: int
    thought: str
    plan: Plan
    clearance: Finite = 0.0


def proposal(state: State) -> dict[str, Any]:
    """The interrupt's payload: plain data, so that any face can show it."""
    assert state.plan is not None
    return Proposal(
        instruction=state.instruction,
        goal=state.agenda[-1],
        thought=state.thought,
        plan=state.plan,
        clearance=state.plan.clearance,
    ).model_dump(mode="json")


def apply_decision(plan: Plan, decision: Decision) -> Plan:
    """The plan to execute: as proposed, or with the person's edit and its provenance.

    Raises:
        BadInputError: "edit" without a grasp, or with an approach that is not a direction.
    """
    if decision.verdict != "edit":
        return plan
    if decision.grasp is None:
        raise BadInputError("an edit needs the edited grasp", where="approval")
    if math.hypot(*decision.grasp.approach) < 1e-6:
        raise BadInputError("the approach must be a direction", where="approval")
    fields: tuple[GraspField, ...] = (
        "position", "approach", "yaw", "aperture", "force", "type", "standoff", "speed",
    )  # fmt: skip
    changed: list[GraspField] = [f for f in fields if getattr(plan.grasp, f) != getattr(decision.grasp, f)]
    if not changed:
        return plan
    provenance = dict(plan.provenance)
    for field in changed:
        said = Provenance(source="correction", id="person", value=getattr(decision.grasp, field))
        provenance[field] = (*provenance.get(field, ()), said)
    return plan.model_copy(update={"grasp": decision.grasp, "provenance": provenance, "joints": ()})
