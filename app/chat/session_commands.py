"""/sessions: the conversations that are kept; deleted, written to one file, and read from one."""

from __future__ import annotations

import shlex
from collections.abc import Callable
from pathlib import Path

from agent.chat.portable import export_session, import_session
from agent.chat.sessions import delete_session, list_sessions
from app.files import refuse_unwritable_file
from kb.errors import BadInputError

CHOICES = ("/sessions", "/sessions delete NAME", "/sessions export NAME FILE", "/sessions import FILE [NAME]")


def sessions_command(
    rest: str, say: Callable[[str], None], threads: Path | None = None, here: str | None = None
) -> None:
    """Does what the words after /sessions say.

    Args:
        rest: The words.
        say: Prints a line.
        threads: File that keeps threads (default: the user's).
        here: Name of the session that is open.

    Raises:
        BadInputError: words that are no such command, or a session that does not exist or is open.
        EnvironmentFaultError: a file that cannot be used, or a session that another process holds.
    """
    try:
        words = shlex.split(rest)
    except ValueError as error:
        raise BadInputError(str(error).lower(), where="/sessions", choices=CHOICES) from error
    if not words:
        _list(say, threads, here)
    elif words[0] == "delete" and len(words) == 2:
        if words[1] == here:
            raise BadInputError("this session is open; leave it first", where="/sessions delete")
        delete_session(words[1], threads)
        say(f"session {words[1]} is gone")
    elif words[0] == "export" and len(words) == 3:
        file = Path(words[2]).expanduser()
        refuse_unwritable_file(file, where="/sessions export")
        size = export_session(words[1], file, threads)
        say(f"session {words[1]} in {file} ({size / 1e6:.1f} MB)")
    elif words[0] == "import" and len(words) in (2, 3):
        name = import_session(Path(words[1]).expanduser(), words[2] if len(words) == 3 else None, threads)
        say(f"session {name} is here; take it up with: ragvlm chat --thread {name}")
    else:
        raise BadInputError(f'"{rest[:60]}" is no such command', where="/sessions", choices=CHOICES)


def _list(say: Callable[[str], None], threads: Path | None, here: str | None) -> None:
    found = list_sessions(threads)
    if not found:
        say("no conversation is kept yet; ragvlm chat --thread NAME keeps one")
    for info in found:
        mark = "*" if info.thread == here else " "
        place = f"{info.scene}, seed {info.seed}" if info.scene else ""
        say(f"{mark} {info.thread:<28} {info.updated[:16]:<17} {info.turns:>3} turns  {place:<32} {info.last[:50]}")
