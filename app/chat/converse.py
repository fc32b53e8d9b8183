"""`ragvlm chat`: opens the conversation, tells where it stands, and lets the person talk."""

from __future__ import annotations

import datetime
import os
import sys
from typing import TYPE_CHECKING

from app.chat.printing import ChatPrinter
from app.chat.talk import Talk
from app.console import make_console
from app.exit_codes import INTERRUPTED
from app.open_conversation import open_conversation
from kb.errors import EnvironmentFaultError

if TYPE_CHECKING:
    from agent.chat import Conversation
    from app.options import RunOptions


def chat(options: RunOptions) -> int:
    """Talks until the person leaves; returns the exit code.

    On a terminal the conversation is kept under a name of its own, in a pipe only with `--thread`.

    Raises:
        BadInputError: the scene or another choice cannot be used.
        EnvironmentFaultError: the machine cannot do it, or another process holds the thread.
    """
    person = sys.stdin.isatty() and sys.stdout.isatty()
    drawable = person and os.environ.get("TERM", "dumb") not in ("dumb", "unknown", "")
    console = make_console()
    printer = ChatPrinter(console)
    conversation = _open(options, printer, person=person)
    try:
        _greet(conversation, printer, told=options.thread is not None)
        if not drawable:
            from app.chat.plain import converse_plainly

            return converse_plainly(Talk(conversation, console), interactive=person)
        from app.chat.terminal import Terminal

        return Terminal(Talk(conversation, _live_console())).run()
    except KeyboardInterrupt:
        return INTERRUPTED
    finally:
        conversation.close()


def _open(options: RunOptions, printer: ChatPrinter, *, person: bool) -> Conversation:
    if options.thread is not None or not person:
        return open_conversation(options, options.thread)
    name = f"chat-{datetime.datetime.now():%Y%m%d-%H%M%S}"
    try:
        return open_conversation(options, name)
    except EnvironmentFaultError as error:
        if "session" not in str(error) and "threads" not in str(error) and "memory in" not in str(error):
            raise
        printer.say(f"this conversation is not kept: {error}", "yellow")
        return open_conversation(options, None)


def _greet(conversation: Conversation, printer: ChatPrinter, *, told: bool) -> None:
    """Where the conversation stands: new, taken up again, cut off, or waiting for approval."""
    printer.say(f"{conversation.place}. Say what the robot is to do; /help helps.")
    if not conversation.messages:
        printer.say(f"for example: {first_words(conversation)}", "dim")
    thread = conversation.agent.thread
    if thread is not None and not told:
        printer.say(f"kept as {thread}; take it up again with: ragvlm chat --thread {thread}", "dim")
    for who, text in conversation.messages[-4:]:
        first = text.splitlines()[0] if text else ""
        printer.say(f"  {'you' if who == 'person' else 'robot'}: {first[:160]}", "dim")
    if conversation.asks:
        printer.say("I ask before every motion; /approve off ends that", "dim")
    pending, unfinished = conversation.pending, conversation.unfinished
    if pending is not None:
        grasp = pending.plan.grasp
        what = f"{grasp.type} grasp of the {pending.plan.region} with {grasp.force:.1f} N"
        what = pending.words if pending.motion == "place" else what
        printer.say(f'a motion waits for your word: "{pending.instruction}", {what}: yes, no, or how else', "yellow")
    elif unfinished is not None:
        printer.say(f'"{unfinished}" was cut off; /resume goes on with it', "yellow")


def first_words(conversation: Conversation) -> str:
    """What a person could say first in this scene."""
    from sim.scene_file import load_scene

    task = load_scene(conversation.agent.context.scene).task
    asked = task.instructions[0] if task and task.instructions else "pick it up"
    return f'"what do you see", "{asked}", then "why?", "put it back"'


def _live_console():
    """A console that writes to whatever standard output is at the moment: above the prompt, while there is one."""
    from rich.console import Console

    return Console(highlight=False, emoji=False, soft_wrap=True, force_terminal="NO_COLOR" not in os.environ)
