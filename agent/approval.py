"""What a person is asked before a motion, and what they may decide."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError

from agent.state import State
from kb.base import Finite, Noun, Vec2
from kb.errors import BadInputError
from kb.grasp import Grasp, GraspField, Provenance
from kb.sensing import Plan

Verb = Literal["approve", "reject", "edit", "steer"]
PLACE_LIMITS: dict[str, tuple[float, float]] = {"x": (0.30, 0.75), "y": (-0.35, 0.35)}
"""Where a person may have a thing put down, from the robot's base: x away from it, y to its left [m]."""


class Decision(Noun):
    """A person's word about the proposed motion."""

    verdict: Verb
    grasp: Grasp | None = None
    """The edited grasp, for "edit" of a grasp."""
    point: tuple[Annotated[float, Field(ge=0.30, le=0.75)], Annotated[float, Field(ge=-0.35, le=0.35)]] | None = None
    """Where it should be put down instead [m], for "edit" of a placing; limits as `PLACE_LIMITS`."""
    words: str = ""
    """How it should be done instead, for "steer"."""


class Proposal(Noun):
    """What the person sees."""

    instruction: str
    goal: int
    thought: str
    plan: Plan
    """The grasp; for a placing the one with which the thing is held."""
    clearance: Finite = 0.0
    motion: Literal["grasp", "place"] = "grasp"
    words: str = ""
    """What is to be put where, for a placing."""
    point: Vec2 | None = None
    """The place that was found [m], for a placing onto the table; None where there is nothing to choose."""

    @property
    def question(self) -> str:
        """What the person is asked."""
        return f"May I {self.words}?" if self.motion == "place" else "May I do this?"


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


def edited(proposed: Proposal, changes: Mapping[str, Any]) -> Decision:
    """The decision to move with other numbers: fields of `kb.grasp.Grasp` for a grasp, x and y [m] for a placing.

    Raises:
        BadInputError: a field that there is not, or a value outside what the hand or the table allows.
    """
    place = proposed.motion == "place"
    known = (*PLACE_LIMITS,) if place and proposed.point is not None else () if place else (*Grasp.model_fields,)
    unknown = [name for name in changes if name not in known]
    if unknown:
        what = f"of this motion {unknown[0]!r} cannot be changed"
        raise BadInputError(what, where="edit", choices=known or ("yes", "no", "another place in words"))
    try:
        if place:
            assert proposed.point is not None
            x, y = (float(changes.get(name, now)) for name, now in zip(PLACE_LIMITS, proposed.point, strict=True))
            for name, value in (("x", x), ("y", y)):
                low, high = PLACE_LIMITS[name]
                if not low <= value <= high:
                    limits = f"{low * 1000:.0f} to {high * 1000:.0f} mm"
                    raise BadInputError(f"{value * 1000:.0f} mm is off the table", where=name, choices=(limits,))
            return Decision(verdict="edit", point=(x, y))
        return Decision(verdict="edit", grasp=Grasp.model_validate({**proposed.plan.grasp.model_dump(), **changes}))
    except ValidationError as error:
        first = error.errors()[0]
        raise BadInputError(str(first["msg"]), where=str(first["loc"][0])) from error


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
    own = plan.grasp.force if "force" in changed and plan.own_force is None else plan.own_force
    update = {"grasp": decision.grasp, "provenance": provenance, "joints": (), "own_force": own}
    return plan.model_copy(update=update)
