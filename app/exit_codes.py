"""Exit codes of `ragvlm`, and how an exception becomes one line for the person who typed the command."""

from __future__ import annotations

import os
import tempfile
import traceback
from pathlib import Path

ACHIEVED = 0
"""Every goal was achieved."""
NOT_ACHIEVED = 1
"""A goal failed, was refused, was not understood or names something that is not there."""
USAGE = 2
"""Bad usage or bad input."""
ENVIRONMENT = 3
"""The environment cannot do it; the line says the mend."""
DEFECT = 70
"""An error of the program itself (EX_SOFTWARE of sysexits.h): not a promise, but never confused with one."""
INTERRUPTED = 130
"""Interrupted from the keyboard; what was done is saved."""


def code_of_fault(error: Exception) -> tuple[int, str]:
    """Exit code and the one line for an exception that left a command."""
    from kb.errors import RagVlmError

    if isinstance(error, RagVlmError):
        return error.exit_code, " ".join(str(error).split())
    if isinstance(error, PermissionError | FileNotFoundError | IsADirectoryError | NotADirectoryError):
        return USAGE, f"{error.filename}: {error.strerror}"
    if isinstance(error, OSError) and error.errno is not None:
        return ENVIRONMENT, f"{error.filename or 'system'}: {error.strerror}; free the resource or choose another place"
    if os.environ.get("RAGVLM_DEBUG"):
        traceback.print_exception(error)
    log = write_log(error)
    what = " ".join(str(error).split())[:200]
    return DEFECT, f"internal error ({type(error).__name__}: {what}); the traceback is in {log}, or use --debug"


def write_log(error: Exception) -> Path:
    """Appends the traceback to the log of internal errors and returns where that is."""
    folder = Path(os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state") / "ragvlm"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        log = folder / "errors.log"
        with log.open("a", encoding="utf-8") as stream:
            traceback.print_exception(error, file=stream)
    except OSError:
        handle, name = tempfile.mkstemp(prefix="ragvlm-", suffix=".log", text=True)
        log = Path(name)
        with os.fdopen(handle, "w", encoding="utf-8") as stream:
            traceback.print_exception(error, file=stream)
    return log
