"""What a reply that is still being made says so far, in words a person can read; the reply itself is JSON."""

from __future__ import annotations

import json
import re

KEYS: dict[str, str] = {
    "understand": "action|thing|place|refusal|question",
    "perceive": "category",
    "think": "thought|question",
    "reflect": "thought",
    "answer": "text",
}
"""Role -> keys of its reply whose texts say something."""
LONGEST = 600
"""More of a reply is not shown while it is made [characters]."""


def words_so_far(role: str, text: str) -> str:
    """The words in the beginning of a reply.

    Args:
        role: what was asked for, as in `agent.brain.Exchange`.
        text: the reply so far, which may end anywhere.
    """
    begun = text.lstrip()
    if not begun.startswith(("{", "`")):
        return begun.rstrip()[:LONGEST]  # no JSON: whatever it is, it is the model's words
    values = re.finditer(rf'"(?:{KEYS.get(role, "text")})"\s*:\s*"((?:[^"\\]|\\.)*)', begun[: 40 * LONGEST], re.DOTALL)
    said = (_plain(value[1]).strip() for value in values)
    return " ".join(filter(None, said))[:LONGEST]


def _plain(value: str) -> str:
    """The inside of a JSON string, of which the last escape may be cut off."""
    whole = re.sub(r"\\u[0-9a-fA-F]{0,3}$", "", value)
    try:
        return str(json.loads(f'"{whole}"', strict=False))
    except ValueError:
        return whole
