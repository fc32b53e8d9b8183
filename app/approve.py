"""Asks a person before a motion."""

from __future__ import annotations

import sys
from typing import Any

from kb.errors import BadInputError, EnvironmentFaultError

ANSWERS = {"y": "approve", "yes": "approve", "approve": "approve", "n": "reject", "no": "reject", "reject": "reject"}


def refuse_without_person() -> None:
    """Approval needs somebody who can answer.

    Raises:
        EnvironmentFaultError: standard input is closed.
    """
    if sys.stdin is None or sys.stdin.closed:
        raise EnvironmentFaultError("--approve needs somebody to ask", mend="run it in a terminal, or leave it out")


EDITABLE = ("force", "aperture", "yaw", "standoff", "speed")
"""Numbers of a grasp that may be changed; of a placing these are x and y."""


def ask(proposal: dict[str, Any]) -> dict[str, Any]:
    """Shows the proposed motion on standard error and waits for a decision; the end of the input rejects.

    Args:
        proposal: The interrupt's payload: plan, thought and clearance as plain data.

    Returns:
        A decision as plain data: approve, reject, or edit with the changed grasp or place.
    """
    grasp, point = dict(proposal["plan"]["grasp"]), proposal.get("point")
    place = proposal.get("motion") == "place"
    numbers: dict[str, Any] = dict(zip(("x", "y"), point, strict=True)) if point else {} if place else grasp
    fields = ("x", "y") if point else () if place else EDITABLE
    before = dict(numbers)
    _show(proposal, fields)
    while True:
        print("approve> ", end="", file=sys.stderr, flush=True)
        line = sys.stdin.readline()
        if not line:
            print("(no answer: rejected)", file=sys.stderr)
            return {"verdict": "reject"}
        word = line.strip().lower()
        if word in ANSWERS:
            return _decision(ANSWERS[word], numbers if numbers != before else None, place=place)
        try:
            field, value = edit(word, fields)
            changed = {**numbers, field: value}
            check_place(changed) if place else check(changed)
            numbers = changed
            print(f"{field} = {value:g}; y to approve the edited motion", file=sys.stderr)
        except BadInputError as error:
            print(str(error), file=sys.stderr)


def _show(proposal: dict[str, Any], fields: tuple[str, ...]) -> None:
    """What would be done, and what can be answered."""
    if proposal.get("motion") == "place":
        print(f"{proposal['thought']}", file=sys.stderr)
    what = f"may I {proposal['words']}?" if proposal.get("motion") == "place" else "approve this motion?"
    change = f", or FIELD=VALUE ({', '.join(fields)})" if fields else ""
    print(f"{what} [y]es, [n]o{change}", file=sys.stderr)


def _decision(verdict: str, changed: dict[str, Any] | None, *, place: bool) -> dict[str, Any]:
    if verdict != "approve" or changed is None:
        return {"verdict": verdict}
    return (
        {"verdict": "edit", "point": (changed["x"], changed["y"])} if place else {"verdict": "edit", "grasp": changed}
    )


def edit(word: str, fields: tuple[str, ...] = EDITABLE) -> tuple[str, float]:
    """The field and value of "force=12".

    Raises:
        BadInputError: not of that form, or a field that cannot be edited so.
    """
    field, equals, text = word.partition("=")
    field = field.strip()
    if not equals or field not in fields:
        raise BadInputError(f'"{word[:60]}" is no answer', choices=("y", "n", *(f"{name}=VALUE" for name in fields)))
    try:
        return field, float(text)
    except ValueError as error:
        raise BadInputError(f'"{text.strip()}" is not a number', where=field) from error


def check(grasp: dict[str, Any]) -> None:
    """Raises BadInputError if the edited grasp is outside what the hand can do."""
    from pydantic import ValidationError

    from kb.grasp import Grasp

    try:
        Grasp.model_validate(grasp)
    except ValidationError as error:
        first = error.errors()[0]
        raise BadInputError(str(first["msg"]), where=str(first["loc"][0])) from error


def check_place(point: dict[str, float]) -> None:
    """Raises BadInputError if the edited place [m] is not on the table."""
    from agent.approval import PLACE_LIMITS

    for name, (low, high) in PLACE_LIMITS.items():
        if not low <= point[name] <= high:
            raise BadInputError(f"{point[name]:g} m is off the table", where=name, choices=(f"{low:g} to {high:g}",))
