"""What if: a change of the last grasp, simulated from the saved moment before it, with both endings side by side."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, cast, get_args

from pydantic import ValidationError

from agent import events, phrases
from agent.attempt import Attempt
from agent.chat.events import Outcome, WhatIf
from agent.chat.explain import shown
from agent.context import AgentContext
from agent.simulate import Rerun, replan, rerun, told
from kb.errors import BadInputError
from kb.experience import ApproachClass
from kb.grasp import GraspField
from kb.sensing import Plan
from kb.vocabulary import REGIONS, GraspType
from tools.planning.demand import Demand, impose

CHANGES = ("force", "aperture", "yaw", "speed", "type", "approach", "region", "candidate", "force_scale", "speed_scale")
"""What may be changed. "candidate" is a name, or "other" for the next best one."""
CHOICES: dict[str, tuple[str, ...]] = {
    "type": get_args(GraspType),
    "approach": get_args(ApproachClass),
    "region": REGIONS,
}


def whatif(attempt: Attempt, changes: dict[str, Any], context: AgentContext, folder: Path | None) -> WhatIf:
    """Simulates the attempt with changes.

    Args:
        attempt: The attempt, with its saved moment.
        changes: Fields of `CHANGES` -> values (SI units).
        context: The agent's.
        folder: Where the picture goes, or None.

    Raises:
        BadInputError: a change that is none, or that the hand cannot do.
    """
    demand = _demand(attempt, changes)
    words = _words(attempt.plan, demand)
    context.emit(
        events.Thought(text=f"I simulate attempt {attempt.number + 1} from the saved moment before it, with {words}.")
    )
    if demand.where:
        outcome = replan(context, attempt, (demand,))
        if outcome.plan is None:
            return WhatIf(
                text=f"With {words} there is no grasp to simulate: {outcome.reason}.",
                attempt=attempt.number, changes=changes, real=_real(attempt),
            )  # fmt: skip
        plan = outcome.plan
    else:
        plan = impose(attempt.plan, (demand,))
        if plan.grasp == attempt.plan.grasp and not attempt.sensing.grip_raised:
            return WhatIf(
                text=f"That is what I did: it {phrases.ended(attempt)}.",
                attempt=attempt.number, changes=changes, real=_real(attempt),
            )  # fmt: skip
    pictures = folder is not None
    run = rerun(context, attempt, plan, pictures=pictures)
    file = None
    if folder is not None and run.sensing.stopped_by != "stop":
        file = _picture(folder, attempt, run, rerun(context, attempt, attempt.plan, pictures=True), words)
    text = told(run, words, attempt)
    if demand.where:
        text += f" It would have been a {plan.grasp.type} grasp of the {plan.region} with {plan.grasp.force:.1f} N."
    return WhatIf(
        text=text, attempt=attempt.number, changes=changes, real=_real(attempt), simulated=_outcome(run),
        pictures=None if file is None else str(file),
    )  # fmt: skip


def check_changes(changes: dict[str, Any]) -> None:
    """Refuses what cannot be changed.

    Raises:
        BadInputError: an unknown field or value, or none at all.
    """
    unknown = [name for name in changes if name not in CHANGES]
    if unknown or not changes:
        what = f'"{unknown[0]}" cannot be changed' if unknown else "it needs a change"
        raise BadInputError(what, where="whatif", choices=tuple(f"{name}=" for name in CHANGES[:8]))
    for name, choices in CHOICES.items():
        if name in changes and changes[name] not in choices:
            raise BadInputError(f'"{changes[name]}" is no {name}', where="whatif", choices=choices)
    given = {name: value for name, value in changes.items() if name != "candidate"}
    try:
        Demand(words="what if", **given)
    except ValidationError as error:
        first = error.errors()[0]
        limits = {"force": "1 to 70 N", "aperture": "0 to 80 mm", "speed": "0.1 to 1"}
        name = str(first["loc"][0])
        choices = (limits[name],) if name in limits else ()
        raise BadInputError(f"{name} {given.get(name)} is not possible", where="whatif", choices=choices) from error


def _demand(attempt: Attempt, changes: dict[str, Any]) -> Demand:
    check_changes(changes)
    given = dict(changes)
    if given.get("candidate") == "other":
        if not attempt.plan.alternatives:
            raise BadInputError("there was no other feasible candidate", where="whatif")
        given["candidate"] = attempt.plan.alternatives[0][2]
    return Demand(words=" ".join(f"{name}={value}" for name, value in given.items()), **given)


def _words(plan: Plan, demand: Demand) -> str:
    """The changes in words, with what they replace."""
    said: list[str] = []
    for name, value in demand.model_dump(exclude={"words"}, exclude_defaults=True).items():
        if name in ("force_scale", "speed_scale"):
            field = name.removesuffix("_scale")
            now = getattr(plan.grasp, field)
            said.append(f"{field} {shown(field, now * value)} instead of {shown(field, now)}")
        elif name in ("force", "aperture", "yaw", "speed"):
            said.append(
                f"{name} {shown(name, value)} instead of {shown(name, getattr(plan.grasp, cast(GraspField, name)))}"
            )
        elif name == "approach":
            tilt = math.degrees(math.acos(max(-1.0, min(1.0, -plan.grasp.approach[2]))))
            said.append(f"approach {value} instead of {tilt:.0f} deg off vertical")
        else:
            now = {"type": plan.grasp.type, "region": plan.region, "candidate": plan.candidate}.get(name, "")
            said.append(f"{name} {value}" + (f" instead of {now}" if now else ""))
    return ", ".join(said)


def _real(attempt: Attempt) -> Outcome:
    return Outcome(
        claimed=attempt.claimed, failure=attempt.failure if not attempt.claimed else None, reasons=attempt.reasons,
        load_kg=attempt.sensing.load_end, held_s=attempt.sensing.held_s, peak_force_n=attempt.sensing.closing_force_peak,
    )  # fmt: skip


def _outcome(run: Rerun) -> Outcome:
    return Outcome(
        claimed=run.diagnosis.claimed, failure=None if run.diagnosis.claimed else run.diagnosis.failure,
        reasons=run.diagnosis.reasons, load_kg=run.sensing.load_end, held_s=run.sensing.held_s,
        peak_force_n=run.sensing.closing_force_peak,
    )  # fmt: skip


def _picture(folder: Path, attempt: Attempt, run: Rerun, real: Rerun, words: str) -> Path | None:
    """Both endings side by side as a PNG; None where they cannot be written (a full disk must not cost the answer)."""
    from agent.chat.side_by_side import side_by_side

    number = len(list(folder.glob("whatif-*.png"))) + 1
    file = folder / f"whatif-{number}.png"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        side_by_side(
            file,
            (f"attempt {attempt.number + 1}, as it was", real.views),
            (f"simulated: {words}", run.views),
        )
    except OSError:
        return None
    return file
