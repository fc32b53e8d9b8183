"""Consoles: colour only on a terminal (and never with NO_COLOR), plain lines in a pipe."""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console

PIPE_WIDTH = 10_000
"""Width in a pipe: lines are never folded there, so that programs can read them."""


def make_console(*, stderr: bool = False) -> Console:
    """A console for standard output or standard error. rich itself respects NO_COLOR and TERM=dumb."""
    from rich.console import Console

    stream = sys.stderr if stderr else sys.stdout
    terminal = stream.isatty()
    return Console(
        file=stream,
        highlight=False,
        emoji=False,
        soft_wrap=True,
        force_terminal=terminal and "NO_COLOR" not in os.environ,
        width=None if terminal else PIPE_WIDTH,
    )
