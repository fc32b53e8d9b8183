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


def ask(proposal: dict[str, Any]) -> dict[str, Any]:
    """Shows the proposed motion on standard error and waits for a decision; the end of the input rejects.

    Args:
        proposal: The interrupt's payload: plan, thought and clearance as plain data.

    Returns:
        A decision as plain data: approve, reject, or edit with the changed grasp.
    """
    grasp = dict(proposal["plan"]["grasp"])
    print("approve this motion? [y]es, [n]o, or FIELD=VALUE (force, aperture, yaw, standoff, speed)", file=sys.stderr)
    while True:
        print("approve> ", end="", file=sys.stderr, flush=True)
        line = sys.stdin.readline()
        if not line:
            print("(no answer: rejected)", file=sys.stderr)
            return {"verdict": "reject"}
        word = line.strip().lower()
        if word in ANSWERS:
            verdict = ANSWERS[word]
            edited = verdict == "approve" and grasp != proposal["plan"]["grasp"]
            return {"verdict": "edit", "grasp": grasp} if edited else {"verdict": verdict}
        try:
            field, value = edit(word)
            changed = {**grasp, field: value}
            check(changed)
            grasp = changed
            print(f"{field} = {value:g}; y to approve the edited motion", file=sys.stderr)
        except BadInputError as error:
            print(str(error), file=sys.stderr)


EDITABLE = ("force", "aperture", "yaw", "standoff", "speed")


def edit(word: str) -> tuple[str, float]:
    """The field and value of "force=12".

    Raises:
        BadInputError: not of that form, or a field that cannot be edited so.
    """
    field, equals, text = word.partition("=")
    field = field.strip()
    if not equals or field not in EDITABLE:
        raise BadInputError(f'"{word}" is no answer', choices=("y", "n", *(f"{name}=VALUE" for name in EDITABLE)))
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
