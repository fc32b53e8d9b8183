"""A conversation in a process of its own that may kill itself (not a test): `killed_chat.py THREADS KILL_AT`.

KILL_AT: number of the step at whose telling the process dies by SIGKILL, inside the graph's own thread, or "never". A
process that finds the conversation cut off goes on with it, then says what was not said yet. Prints what is there at the end.
"""

from __future__ import annotations

import hashlib
import json
import os
import queue
import signal
import sys
from typing import Any

import agent.conversation
from agent.chat import Conversation
from agent.events import BaseStep

LINES = ("pick up the cube", "where is it?", "do that again but gentler", "put it on the left")
"""What the person says; each motion is approved."""


def die_at(step: int) -> None:
    """Lets the graph's thread die when it tells the step of that number, before its node has ended."""

    class Told(queue.SimpleQueue[Any]):
        count = 0

        def put(self, item: Any, block: bool = True, timeout: float | None = None) -> None:
            if isinstance(item, BaseStep):
                if Told.count == step:
                    os.kill(os.getpid(), signal.SIGKILL)
                Told.count += 1
            super().put(item, block, timeout)

    agent.conversation.queue.SimpleQueue = Told  # type: ignore[misc]


def settle(talk: Conversation) -> None:
    """Goes on with what was cut off, and approves whatever waits."""
    if talk.unfinished is not None:
        list(talk.resume())
    while talk.pending is not None:
        list(talk.approve())


def main(threads: str, kill_at: str) -> None:
    """Talks (or goes on talking) in thread "t"."""
    if kill_at != "never":
        die_at(int(kill_at))
    with Conversation.open("single_cube", 10_001, perception="oracle", thread="t", threads=threads, asks=True) as talk:
        settle(talk)
        said = [text for who, text in talk.messages if who == "person"]
        for line in LINES[len(said) :]:
            list(talk.say(line))
            settle(talk)
        state = talk.state
        told = {
            "messages": talk.messages,
            "memory": [item.model_dump(mode="json") for item in talk.memory],
            "attempts": [(a.number, a.claimed, a.plan.grasp.model_dump(mode="json")) for a in state.attempts],
            "world": hashlib.sha256(talk.agent.opened.physics_of(state.world)).hexdigest(),
            "held": None if state.held is None else state.held.category,
        }
        print(json.dumps(told))


if __name__ == "__main__":
    main(*sys.argv[1:])
