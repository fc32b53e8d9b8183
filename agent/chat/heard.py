"""What was typed or pasted, made inert: escape sequences and control characters are taken out before anybody reads it."""

from __future__ import annotations

import re
import unicodedata

_ESCAPES = re.compile(
    r"\x1b\[[0-?]*[ -/]*[@-~]|\x1b\][^\x07\x1b]*(?:\x07|\x1b\\)?|\x1b[PX^_][^\x1b]*(?:\x1b\\)?|\x1b[@-Z\\-_]|\x9b[0-?]*[ -/]*[@-~]"
)
"""CSI, OSC, string and two-character sequences of ECMA-48."""


def heard(text: str) -> str:
    """The text without escape sequences, control and direction-changing characters; line ends become spaces."""
    plain = _ESCAPES.sub("", text)
    return "".join(" " if c in "\r\n\t\v\f" else c for c in plain if c in "\r\n\t\v\f" or not _hidden(c))


def inert(text: str) -> str:
    """Text for a person that cannot steer a terminal; line ends stay."""
    return "".join(c for c in _ESCAPES.sub("", text) if c == "\n" or not _hidden(c))


def _hidden(char: str) -> bool:
    """Control (Cc), format (Cf: direction marks, zero-width), surrogate (Cs) and private (Co) characters."""
    return unicodedata.category(char) in ("Cc", "Cf", "Cs", "Co")
