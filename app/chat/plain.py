"""A conversation without a terminal that can be drawn on: one command a line, plain output, an exit code."""

from __future__ import annotations

import sys
from collections.abc import Iterator

from app.chat.talk import Talk
from app.exit_codes import ACHIEVED, INTERRUPTED
from app.garbage import Garbage
from app.interrupts import StopOnInterrupt

PROMPT = "you> "


def converse_plainly(talk: Talk, *, interactive: bool) -> int:
    """Hears line after line until the input ends or the person leaves.

    Args:
        talk: What hears them.
        interactive: A person types on a terminal that cannot be drawn on; else the lines come from a pipe or a file.

    Returns:
        0; from a pipe the worst exit code of its lines, where a question that the next line answers does not count; 130
        after Ctrl-C or SIGTERM.
    """
    worst, open_question = ACHIEVED, ACHIEVED
    garbage = Garbage()
    for line in _lines(interactive):
        with StopOnInterrupt(talk.conversation.stop, talk.printer.say) as guard:
            stay = talk.hear(line)
        garbage.collect()
        if guard.pressed and (not interactive or guard.terminated):
            return INTERRUPTED
        if not line.strip():
            continue
        open_question = talk.code if talk.asked else ACHIEVED
        worst = max(worst, ACHIEVED if talk.asked else talk.code)
        if not stay:
            break
    return ACHIEVED if interactive else max(worst, open_question)


def _lines(interactive: bool) -> Iterator[str]:
    """What was typed or piped in; in a pipe each line is shown, so that the transcript can be read."""
    presses = 0
    while True:
        try:
            if interactive:
                line = input(PROMPT)
            else:
                line = sys.stdin.readline()
                if not line:
                    return
                print(PROMPT + _shown(line), flush=True)
            presses = 0
            yield line.rstrip("\n")
        except EOFError:
            return
        except KeyboardInterrupt:
            presses += 1
            if presses == 2 or not interactive:
                raise
            print("\nCtrl-C again or /quit leaves", file=sys.stderr)


def _shown(line: str) -> str:
    from agent.chat.heard import inert

    text = inert(line.rstrip("\n"))
    return text if len(text) <= 500 else f"{text[:500]}... ({len(text)} characters)"
