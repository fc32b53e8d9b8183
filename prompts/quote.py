"""Foreign text and numbers as data inside a prompt: JSON that can neither close its frame nor look like an instruction."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import cast

LONGEST = 240
"""Characters of one string that come from outside: names and notes are shorter, floods are cut."""


def quoted(value: object) -> str:
    """The value as one line of ASCII JSON; angle brackets are escaped, so that no text can end the frame `</data>`.

    Args:
        value: plain data (numbers, texts, lists, dictionaries).
    """
    text = json.dumps(_plain(value), ensure_ascii=True, separators=(", ", ": "), allow_nan=False)
    return text.replace("<", "\\u003c").replace(">", "\\u003e")


def _plain(value: object) -> object:
    """Long texts cut, numbers rounded to what measuring can tell, what is not finite said in words."""
    if isinstance(value, str):
        return value if len(value) <= LONGEST else value[: LONGEST - 3] + "..."
    if isinstance(value, float):
        return round(value, 4) if math.isfinite(value) else str(value)
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in cast("Mapping[object, object]", value).items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in cast("list[object]", value)]
    return value
