"""The slash commands: what there is, and which one is meant."""

from __future__ import annotations

import difflib

from kb.errors import BadInputError

COMMANDS: dict[str, str] = {
    "/help": "what can be said, and these commands",
    "/scene [NAME|FILE] [SEED]": "another scene (what was said and learnt stays), or what is seen now",
    "/approve [on|off]": "ask before every motion or not; alone: let the waiting motion happen",
    "/reject": "do not do the motion that waits",
    "/edit FIELD=VALUE ...": "do it with other numbers: force [N], aperture [mm], yaw [deg], standoff [mm], speed; "
    "of a placing x and y [mm] from the robot's base",
    "/why [ATTEMPT]": "why a grasp was chosen: every number with its source, and what was rejected",
    "/whatif CHANGE ...": "simulate the last grasp otherwise: force=4 type=pinch yaw=30 approach=side aperture=60 "
    "region=rim candidate=other attempt=2",
    "/compare [FIRST SECOND]": "two attempts side by side (the last two)",
    "/memory [forget [CATEGORY]]": "what the robot remembers, of this conversation and for good",
    "/remember": "keep what worked last for every later conversation",
    "/report": "what was done so far",
    "/undo": "put it back",
    "/stop": "stop the robot; nothing moves until /release",
    "/release": "let the robot move again",
    "/resume": "go on with the turn that was cut off",
    "/history [MANY]": "the saved steps of this conversation, the latest first",
    "/back STEP": "go back to a saved step; what follows is a branch of its own, and both stay",
    "/sessions [delete NAME | export NAME FILE | import FILE [NAME]]": "the conversations that are kept",
    "/save FILE": "write the results of this conversation as JSON",
    "/quit": "leave (so does Ctrl-D)",
}
"""Slash command with its arguments -> what it does."""
NAMES: tuple[str, ...] = tuple(name.split()[0] for name in COMMANDS)


ALSO: dict[str, str] = {
    "/fork": "/back", "/branch": "/back", "/goto": "/back", "/steps": "/history", "/exit": "/quit", "/bye": "/quit",
    "/forget": "/memory", "/recall": "/memory", "/yes": "/approve", "/no": "/reject", "/continue": "/resume", "/go": "/resume",
    "/status": "/report", "/summary": "/report", "/threads": "/sessions", "/load": "/scene", "/abort": "/stop", "/halt": "/stop",
    "/diff": "/compare", "/explain": "/why", "/simulate": "/whatif", "/export": "/sessions", "/import": "/sessions",
}  # fmt: skip
"""Names that a person may try -> the command that they want. They are suggested, not done."""


def command_of(line: str) -> tuple[str, str]:
    """The command that a line means, and the rest of the line. A beginning that fits one command only is enough.

    Raises:
        BadInputError: no such command; the nearest is named.
    """
    name, _, rest = line.partition(" ")
    name = name.lower()
    if name in NAMES:
        return name, rest.strip()
    fits = [command for command in NAMES if command.startswith(name)] if len(name) > 1 else []
    if len(fits) == 1:
        return fits[0], rest.strip()
    also = [ALSO[name]] if name in ALSO else []
    near = fits or also or difflib.get_close_matches(name, NAMES, n=2, cutoff=0.5)
    shown = name if len(name) < 40 else name[:37] + "..."
    meant = f"; did you mean {' or '.join(near)}?" if near else ""
    raise BadInputError(f'there is no command "{shown}"{meant}', choices=() if near else NAMES)
