"""The arguments of /whatif and /edit: "force=4 yaw=30 aperture=60", or free wording ("by the rim", "with 4 N")."""

from __future__ import annotations

import math
import re
from typing import Any

from kb.errors import BadInputError

TEXTS = ("type", "approach", "region", "candidate")
NUMBERS: dict[str, tuple[tuple[str, float], ...]] = {
    "force": (("n", 1.0), ("", 1.0)),
    "aperture": (("mm", 1e-3), ("cm", 1e-2), ("m", 1.0), ("", 1e-3)),
    "standoff": (("mm", 1e-3), ("cm", 1e-2), ("m", 1.0), ("", 1e-3)),
    "yaw": (("deg", math.pi / 180), ("rad", 1.0), ("°", math.pi / 180), ("", math.pi / 180)),
    "speed": (("", 1.0),),
    "x": (("mm", 1e-3), ("cm", 1e-2), ("m", 1.0), ("", 1e-3)),
    "y": (("mm", 1e-3), ("cm", 1e-2), ("m", 1.0), ("", 1e-3)),
    "attempt": (("", 1.0),),
}
"""Field -> units and their factors to SI; without a unit the last one counts. Lengths are in mm, angles in degrees."""
_PAIR = re.compile(r"([a-z_]+)\s*=\s*(\S+)(?:\s+(n|mm|cm|deg|rad)\b)?", re.IGNORECASE)


def changes_of(text: str, *, where: str) -> dict[str, Any]:
    """The changes in SI units.

    Raises:
        BadInputError: nothing that can be changed, or a value that is none.
    """
    found: dict[str, Any] = {}
    rest = text
    for match in _PAIR.finditer(text):
        found[match[1].lower()] = _value(match[1].lower(), match[2] + (match[3] or ""), where)
        rest = rest.replace(match[0], "", 1)
    rest = rest.strip(" ,;")
    if rest:
        found = _in_words(rest, where) | found
    if not found:
        raise BadInputError("it needs a change", where=where, choices=("force=4", "yaw=30", "type=pinch", "by the rim"))
    return found


def _names(where: str) -> tuple[str, ...]:
    """What may be named there."""
    others = ("x", "y") if where == "/whatif" else ("attempt",)
    return tuple(name for name in (*NUMBERS, *TEXTS) if name not in others)


def _value(name: str, text: str, where: str) -> Any:
    if name in TEXTS:
        return text.lower() if name != "candidate" else text
    if name not in NUMBERS:
        raise BadInputError(f'"{name}" cannot be changed', where=where, choices=_names(where))
    for unit, factor in NUMBERS[name]:
        if text.lower().endswith(unit):
            number = text[: len(text) - len(unit)].strip()
            try:
                value = float(number) * factor
            except ValueError:
                continue
            if not math.isfinite(value):
                break
            return int(value) - 1 if name == "attempt" else value
    raise BadInputError(
        f'"{text}" is not a number', where=f"{where} {name}", choices=("force in N, aperture in mm, yaw in deg",)
    )


def _in_words(text: str, where: str) -> dict[str, Any]:
    """Free wording; a bare number is a force."""
    from agent.chat.hear import changes_of as plain_changes
    from agent.chat.read_demand import plain, read_demand

    number = re.fullmatch(r"(\d+(?:\.\d+)?)\s*(?:n|newtons?)?", text.lower())
    if number is not None:
        return {"force": float(number[1])}
    if "other candidate" in text or text in ("other", "another candidate", "another"):
        return {"candidate": "other"}
    rest, demand = read_demand(plain(text))
    if demand is None or rest.strip(" ,."):
        shown = text if len(text) < 60 else text[:57] + "..."
        raise BadInputError(
            f'"{shown}" is no change', where=where, choices=("force=4", "yaw=30", "type=pinch", "by the rim")
        )
    return plain_changes(demand)
