"""The one error tree of the project.

A failed grasp is a value, not an exception. Exceptions are for bad input (the caller can mend the call), for an
environment that cannot do the job (the user can mend the machine) and for bugs (ordinary Python exceptions).
"""

from __future__ import annotations

from collections.abc import Iterable


class RagVlmError(Exception):
    """Root of every error that the project raises on purpose."""

    exit_code = 1
    """Exit code of the command line for this error."""


class BadInputError(RagVlmError):
    """The caller gave something unusable: says what, where, and the valid choices, in one line."""

    exit_code = 2

    def __init__(self, what: str, *, where: str | None = None, choices: Iterable[str] = ()) -> None:
        self.what = what
        self.where = where
        self.choices = tuple(choices)
        message = what if where is None else f"{where}: {what}"
        if self.choices:
            message += f" (valid: {', '.join(self.choices)})"
        super().__init__(" ".join(message.split()))


class EnvironmentFaultError(RagVlmError):
    """The machine cannot do it (model missing, port taken, folder read-only): says what, and the mend."""

    exit_code = 3

    def __init__(self, what: str, *, mend: str) -> None:
        self.what = what
        self.mend = mend
        super().__init__(" ".join(f"{what}; {mend}".split()))
